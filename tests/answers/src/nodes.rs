//! The other end of a master's table.

use shapebot_drive::cia402::{State, controlword};
use shapebot_drive::legs::LegsState;
use shapebot_drive::{
    DriveTable, Entry, Frame, MAX_NODES, NodeTable, Object, SdoStep, Signal, Source,
};

/// NMT state "operational" in a heartbeat.
const OPERATIONAL: u8 = 5;

/// NMT command that resets a node.
const RESET: u8 = 0x81;

/// All nodes of a drive, as obliging as can be: each SDO is answered with what is expected, each
/// controlword obeyed, legs move at once.
#[derive(Clone, Copy, Debug)]
pub struct Nodes<'a> {
    table: &'a DriveTable<'a>,
    drives: [State; MAX_NODES],
    legs: LegsState,
    /// Event-driven PDOs are due.
    legs_moved: bool,
    sequence: u8,
}

impl<'a> Nodes<'a> {
    /// Switched on, legs down.
    #[must_use]
    pub const fn new(table: &'a DriveTable<'a>) -> Self {
        let drives = [State::SwitchOnDisabled; MAX_NODES];
        Self { table, drives, legs: LegsState::DOWN, legs_moved: true, sequence: 0 }
    }

    /// Takes a frame of the master; gives the answer if there is one, on the same bus.
    pub fn hear(&mut self, bus: usize, frame: &Frame) -> Option<Frame> {
        let id = frame.standard_id()?;
        let table = self.table;
        for (index, node) in table.nodes.iter().enumerate() {
            if usize::from(node.bus) != bus {
                continue;
            }
            if id == 0 && frame.exactly::<2>() == Some([RESET, node.id.raw()]) {
                if let Some(state) = self.drives.get_mut(index) {
                    *state = State::SwitchOnDisabled;
                }
                return Some(Frame::new(node.id.heartbeat(), &[0]));
            }
            if id == node.id.sdo_request() {
                return confirm(node, frame);
            }
        }
        let command = |command: &&shapebot_drive::CommandTable<'_>| {
            command.cob_id == id && usize::from(command.bus) == bus
        };
        let mut rest = frame.bytes();
        for field in table.commands.iter().find(command)?.fields {
            let (own, after) = rest.split_at_checked(field.kind.bytes())?;
            rest = after;
            self.obey(field.source, field.kind.decode(own));
        }
        None
    }

    fn obey(&mut self, source: Source, value: i64) {
        match source {
            Source::Controlword { node } => {
                if let Some(state) = self.drives.get_mut(usize::from(node)) {
                    *state = follow(*state, value as u16);
                }
            }
            Source::Legs => {
                let legs = if value == 0 { LegsState::DOWN } else { LegsState::UP };
                // A start command also comes before the node may send: repeated frames repeat the answer.
                self.legs_moved = true;
                self.legs = legs;
            }
            Source::Zero | Source::Mode { .. } | Source::Torque { .. } => {}
        }
    }

    /// A heartbeat of each node, with its bus.
    pub fn heartbeats(&self) -> impl Iterator<Item = (usize, Frame)> + 'a {
        self.table.nodes.iter().map(heartbeat)
    }

    /// All transmit PDOs of a cycle, with their buses. `value` gives what drives and sensors measure,
    /// in counts, by the index of the node.
    pub fn sample(
        &mut self,
        mut value: impl FnMut(usize, &Entry) -> i64,
        mut send: impl FnMut(usize, Frame),
    ) {
        self.sequence = self.sequence.wrapping_add(1);
        let table = self.table;
        for (index, node) in table.nodes.iter().enumerate() {
            for pdo in node.transmit.iter().filter(|pdo| pdo.is_synchronous() || self.legs_moved) {
                let (mut bytes, mut used) = ([0; 8], 0);
                for entry in pdo.entries() {
                    let raw = self.own(index, node, entry).unwrap_or_else(|| value(index, entry));
                    let encoded = entry.kind.encode(raw);
                    let part = encoded.iter().take(entry.kind.bytes());
                    for (to, from) in bytes.iter_mut().skip(used).zip(part) {
                        *to = *from;
                    }
                    used += entry.kind.bytes();
                }
                let frame = Frame::new(pdo.cob_id, bytes.get(..used).unwrap_or(&bytes));
                send(usize::from(node.bus), frame);
            }
        }
        self.legs_moved = false;
    }

    /// What a node says of itself.
    fn own(&self, index: usize, node: &NodeTable<'_>, entry: &Entry) -> Option<i64> {
        Some(match entry.signal {
            Signal::Statusword => self.drives.get(index)?.bits().into(),
            Signal::ModeDisplay => node.motor?.mode.into(),
            Signal::ErrorRegister | Signal::Health | Signal::Gap => 0,
            Signal::Sequence => self.sequence.into(),
            Signal::LegsState => self.legs.0.into(),
            _ => return None,
        })
    }
}

/// A node's heartbeat with its bus.
fn heartbeat(node: &NodeTable<'_>) -> (usize, Frame) {
    (usize::from(node.bus), Frame::new(node.id.heartbeat(), &[OPERATIONAL]))
}

/// The answer to an SDO request: written, or the value that the table expects.
fn confirm(node: &NodeTable<'_>, frame: &Frame) -> Option<Frame> {
    let [command, low, high, sub, ..] = frame.exactly::<8>()?;
    let asked = Object { index: u16::from_le_bytes([low, high]), sub };
    let (answer, [a, b, c, d]) = match command {
        0x40 => {
            let expected = node.setup.iter().find_map(|step| match *step {
                SdoStep::Expect { object, kind, value, .. } if object == asked => {
                    Some((kind.bytes(), value))
                }
                _ => None,
            });
            let (bytes, value) = expected?;
            // An expedited answer of 4, 2 or 1 bytes.
            let size = [0x4F, 0x4B, 0x47, 0x43].get(bytes.checked_sub(1)?).copied()?;
            (size, value.to_le_bytes())
        }
        0x80 => return None,
        _ => (0x60, [0; 4]),
    };
    Some(Frame::new(node.id.sdo_response(), &[answer, low, high, sub, a, b, c, d]))
}

/// The state of a drive after a controlword.
fn follow(state: State, word: u16) -> State {
    match (state, word & 0x8F) {
        (State::Fault, word) if word & controlword::FAULT_RESET != 0 => State::SwitchOnDisabled,
        (State::Fault, _) => State::Fault,
        (_, controlword::SHUTDOWN) => State::ReadyToSwitchOn,
        (State::ReadyToSwitchOn | State::OperationEnabled, controlword::SWITCH_ON) => {
            State::SwitchedOn
        }
        (State::SwitchedOn, controlword::ENABLE_OPERATION) => State::OperationEnabled,
        (_, controlword::DISABLE_VOLTAGE) => State::SwitchOnDisabled,
        _ => state,
    }
}
