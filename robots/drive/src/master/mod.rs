//! The master: all of a drive's buses, from boot to torque.

mod boot;
mod cycle;
mod inputs;
mod lookup;
mod node;
mod outputs;
mod readings;
mod transition;

use crate::fault::{Fault, Faults};
use crate::frame::Frame;
use crate::id::Function;
use crate::jitter::Jitter;
use crate::legs::LegsState;
use crate::safety::{Request, State};
use crate::table::{
    DriveTable, Field, MAX_AXES, MAX_COMMANDS, MAX_COORDINATES, MAX_ENTRIES, MAX_NODES, Role,
    Signal,
};
use crate::yaw::{HeadingHold, Rotation};
use inputs::AxisState;
pub use inputs::Measurement;
use lookup::Inputs;
use node::NodeState;
pub use outputs::{Command, Outputs, Writer};
pub use readings::{Count, Reader, Readings};

/// Where frames go: index of the bus, frame.
pub(crate) type Send<'s> = &'s mut dyn FnMut(usize, Frame);

/// What happened on the buses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// SYNCs.
    pub cycles: u32,
    /// Frames received.
    pub received: u32,
    /// Frames with an identifier that is nobody's.
    pub unknown: u32,
    /// Frames with a wrong length, an extended identifier, or remote requests.
    pub malformed: u32,
    /// SDO answers that were not asked for.
    pub unexpected: u32,
    /// Inputs that came twice in a cycle.
    pub duplicate: u32,
    /// Cycles of a node without its inputs.
    pub missed: u32,
    /// Times that as many were missed in a row as is a warning.
    pub warnings: u32,
    /// Cycles without a torque command of the controller.
    pub silent: u32,
    /// Cycles that were left out because SYNC was more than a period late.
    pub skipped: u32,
    /// Torques that were clamped or slewed.
    pub limited: u32,
}

/// CANopen master of a robot: frames and time go in, frames come out.
///
/// The caller passes each received frame to [`Self::receive`], calls [`Self::poll`] after that and at
/// [`Self::next_wake`], and once a cycle, when [`Self::inputs_due`] says so, takes
/// [`Self::measure`], runs its controller and gives the torques to [`Self::command`]. They act at the
/// next SYNC.
///
/// Time is microseconds of a clock that does not go backwards. Nothing that is received can make it
/// panic, wait or take more than a bounded number of steps.
#[derive(Clone, Debug)]
pub struct Master<'a> {
    table: &'a DriveTable<'a>,
    nodes: [NodeState; MAX_NODES],
    /// Whose inputs are whose.
    inputs: Inputs<'a>,
    /// Index of the legs.
    legs: Option<u8>,
    /// Commands that are sent when their content changes, a bit each.
    events: u32,
    /// Bytes of each command.
    lengths: [u8; MAX_COMMANDS],
    /// Smallest torque limit of each axis' drives, counts.
    torque_limit: [i32; MAX_AXES],
    /// Running nodes of which an input of this cycle is missing yet, a bit each.
    awaited: u16,
    /// Nodes that were running at the last SYNC and send each cycle, a bit each.
    synchronised: u16,
    /// A node may have missed inputs in the cycle before.
    missing: bool,
    /// Coordinates that sensors measure, from the first on.
    sensed: [Option<Sensed>; MAX_COORDINATES],
    /// No node is being set up.
    settled: bool,
    /// Until then no running node can have been silent for too long, µs.
    heartbeats_due: u64,
    state: State,
    entered: u64,
    faults: Faults,
    /// A fault was raised since the last step.
    raised: bool,
    failed_step: Option<(u8, u16)>,
    request: Option<Request>,
    plan_ready: bool,
    finished: bool,
    /// When SYNC is due.
    next_sync: u64,
    last_sync: u64,
    started: bool,
    next_heartbeat: u64,
    jitter: Jitter,
    counters: Counters,
    /// Inputs of this cycle were taken.
    taken: bool,
    /// The controller gave torques in this cycle.
    commanded: bool,
    silent: u8,
    measurement: Measurement,
    rotation: Rotation,
    axes: [AxisState; MAX_AXES],
    heading: Option<HeadingHold>,
    target: f32,
    /// Forces of the axes as applied, in the drive unit's frame, N·m or N.
    applied: [f32; MAX_AXES],
    /// The same as counts of each drive's torque object.
    counts: [i32; MAX_AXES],
    sent: [Option<[u8; 8]>; MAX_COMMANDS],
    /// State and cycle in which frames outside of the cycle were last looked at.
    events_seen: (State, u32),
    /// Frames outside of the cycle that may still be sent in it.
    event_budget: u8,
    /// Positions in the drive unit's plane, integrated in the body's frame, in small parts.
    plane: [i64; 2],
}

const _: () = assert!(MAX_ENTRIES == 8 && MAX_COORDINATES <= 16 && MAX_NODES <= 16);

/// A coordinate that a sensor measures.
#[derive(Clone, Copy, Debug)]
struct Sensed {
    coordinate: u8,
    node: u8,
    /// Its PDO, as a bit of those received.
    pdo: u8,
}

impl<'a> Master<'a> {
    /// A master that has not sent anything yet. The first [`Self::poll`] resets all nodes.
    #[must_use]
    pub fn new(table: &'a DriveTable<'a>) -> Self {
        Self {
            table,
            nodes: [NodeState::NEW; MAX_NODES],
            inputs: Inputs::of(table),
            legs: legs_of(table),
            events: events_of(table),
            lengths: core::array::from_fn(|at| length_of(table, at)),
            torque_limit: core::array::from_fn(|at| torque_limit_of(table, at)),
            awaited: 0,
            synchronised: 0,
            missing: false,
            sensed: sensed_of(table),
            settled: false,
            heartbeats_due: 0,
            state: State::Off,
            entered: 0,
            faults: Faults::default(),
            raised: false,
            failed_step: None,
            request: None,
            plan_ready: false,
            finished: false,
            next_sync: 0,
            last_sync: 0,
            started: false,
            next_heartbeat: 0,
            jitter: Jitter::default(),
            counters: Counters::default(),
            taken: false,
            commanded: false,
            silent: 0,
            measurement: Measurement::default(),
            rotation: Rotation::IDENTITY,
            axes: [AxisState::NEW; MAX_AXES],
            heading: None,
            target: 0.0,
            applied: [0.0; MAX_AXES],
            counts: [0; MAX_AXES],
            sent: [None; MAX_COMMANDS],
            events_seen: (State::Off, 0),
            event_budget: 1,
            plane: [0; 2],
        }
    }

    /// Takes a frame that was received on a bus. A fault acts at once, all else at the next
    /// [`Self::poll`].
    pub fn receive(&mut self, bus: usize, frame: &Frame, now: u64) {
        self.take(bus, frame, now);
        if self.raised {
            self.step(now);
        }
    }

    fn take(&mut self, bus: usize, frame: &Frame, now: u64) {
        self.counters.received = self.counters.received.saturating_add(1);
        let Some(id) = frame.standard_id().filter(|_| !frame.is_remote()) else {
            self.counters.malformed = self.counters.malformed.saturating_add(1);
            return;
        };
        if let Some(input) = self.inputs.find(bus, id) {
            self.input(&input, frame, now);
            return;
        }
        let node = |id| self.node_index(bus, id);
        match Function::of(id) {
            Function::SdoResponse(id) if let Some(index) = node(id) => {
                self.sdo_answer(index, frame, now)
            }
            Function::Heartbeat(id) if let Some(index) = node(id) => {
                self.heartbeat(index, frame, now)
            }
            Function::Emergency(id) if let Some(index) = node(id) => {
                self.emergency(index, frame, now)
            }
            _ if self.is_operators(bus, id) => {}
            _ if self.is_ours(bus, id) => self.raise(Fault::ForeignMaster, None, now, id.into()),
            _ => self.counters.unknown = self.counters.unknown.saturating_add(1),
        }
    }

    /// Sends what is due. Call it after each received frame and at [`Self::next_wake`].
    pub fn poll(&mut self, now: u64, out: &mut dyn FnMut(usize, Frame)) {
        if !self.started {
            self.started = true;
            self.next_sync = now;
            self.next_heartbeat = now;
        }
        self.boot(now, out);
        self.heartbeats(now, out);
        if now >= self.next_sync {
            self.begin_cycle(now, out);
        }
        self.step(now);
        // What they hold depends on these, and on what is sent with the torques.
        if self.events_seen != (self.state, self.counters.cycles) {
            self.send_events(out);
        }
    }

    /// When [`Self::poll`] has something to do at the latest, µs.
    #[must_use]
    pub fn next_wake(&self) -> u64 {
        let sdo = self.nodes.iter().filter_map(|node| match node.phase {
            node::Phase::Asked { due, .. } | node::Phase::Booting(due) => {
                Some(due.saturating_add(1))
            }
            _ => None,
        });
        let window = u64::from(self.table.timing.input_window_us);
        let inputs = (!self.taken).then(|| self.last_sync.saturating_add(window));
        sdo.chain(inputs).chain([self.next_heartbeat]).fold(self.next_sync, u64::min)
    }

    /// Asks for something. Whether the state changed: what it does not allow is ignored.
    pub fn request(&mut self, request: Request, now: u64) -> bool {
        let before = self.state;
        if request == Request::EmergencyStop {
            self.raise(Fault::EmergencyStop, None, now, 0);
        }
        self.request = Some(request);
        self.step(now);
        self.state != before
    }

    /// Reports a fault that the master cannot see: the bus is off, the process ends, the operator's link
    /// is gone. [`Fault::BusErrors`] is none where drives are not to be enabled.
    pub fn report(&mut self, fault: Fault, now: u64) {
        if fault == Fault::BusErrors && !self.state.enables_drives() {
            return;
        }
        self.raise(fault, None, now, 0);
        self.step(now);
    }

    /// Says whether there is a plan that begins where the robot is, and whether the one that is followed
    /// is finished.
    pub fn plan(&mut self, ready: bool, finished: bool) {
        self.plan_ready = ready;
        self.finished = finished;
    }

    /// The heading, rad, that [`State::Yawing`] turns to; one that is not finite is ignored.
    pub fn aim(&mut self, heading: f32) {
        if heading.is_finite() {
            self.target = heading;
        }
    }

    /// The tables.
    #[must_use]
    pub const fn table(&self) -> &'a DriveTable<'a> {
        self.table
    }

    /// State of the safety logic.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// Faults since the last reset.
    #[must_use]
    pub const fn faults(&self) -> &Faults {
        &self.faults
    }

    /// Node and step at which a set-up failed.
    #[must_use]
    pub const fn failed_step(&self) -> Option<(u8, u16)> {
        self.failed_step
    }

    /// What happened on the buses.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    /// How late SYNC was.
    #[must_use]
    pub const fn jitter(&self) -> &Jitter {
        &self.jitter
    }

    /// Statusword of a drive, by the index of its node.
    #[must_use]
    pub fn statusword(&self, node: usize) -> u16 {
        self.nodes.get(node).map_or(0, |state| state.statusword)
    }

    /// Measured torque of a drive's motor, N·m, if it is mapped.
    #[must_use]
    pub fn motor_torque(&self, node: usize) -> f32 {
        self.nodes.get(node).map_or(0.0, |state| state.torque)
    }

    /// The inputs of the last cycle: see [`Self::measure`].
    #[must_use]
    pub const fn measurement(&self) -> &Measurement {
        &self.measurement
    }

    /// Counts of the torque object that each drive of an axis was last sent, before its sign.
    #[must_use]
    pub fn torque_counts(&self, axis: usize) -> i32 {
        self.counts.get(axis).copied().unwrap_or(0)
    }

    /// State of the legs; `None` while unknown, and for a robot without.
    #[must_use]
    pub fn legs(&self) -> Option<LegsState> {
        self.legs.and_then(|index| self.nodes.get(usize::from(index))?.legs)
    }

    /// Whether a node is set up and alive.
    #[must_use]
    pub fn is_alive(&self, node: usize) -> bool {
        self.nodes.get(node).is_some_and(NodeState::is_running)
    }
}

fn legs_of(table: &DriveTable<'_>) -> Option<u8> {
    (0..).zip(table.nodes).find(|(_, node)| node.role == Role::Legs).map(|(index, _)| index)
}

fn events_of(table: &DriveTable<'_>) -> u32 {
    let events = table.commands.iter().zip(0..32).filter(|(command, _)| !command.cyclic);
    events.fold(0, |mask, (_, bit)| mask | 1 << bit)
}

fn length_of(table: &DriveTable<'_>, command: usize) -> u8 {
    let fields = table.commands.get(command).map_or(&[][..], |command| command.fields);
    let bytes = |sum: usize, field: &Field| sum.saturating_add(field.kind.bytes());
    fields.iter().fold(0, bytes).min(8) as u8
}

fn torque_limit_of(table: &DriveTable<'_>, axis: usize) -> i32 {
    let drives = table.axes.get(axis).map_or(&[][..], |axis| axis.drives);
    let limits = drives
        .iter()
        .filter_map(|drive| Some(table.nodes.get(usize::from(*drive))?.motor?.torque_limit));
    limits.min().unwrap_or(0).max(0)
}

/// Where sensors measure coordinates.
fn sensed_of(table: &DriveTable<'_>) -> [Option<Sensed>; MAX_COORDINATES] {
    let mut found = [None; MAX_COORDINATES];
    let mut places = found.iter_mut();
    for (node, index) in table.nodes.iter().zip(0..) {
        for (pdo, at) in node.transmit.iter().zip(0..8) {
            for entry in pdo.entries() {
                if let Signal::Coordinate(coordinate) = entry.signal
                    && let Some(place) = places.next()
                {
                    *place = Some(Sensed { coordinate, node: index, pdo: 1 << at });
                }
            }
        }
    }
    found
}

/// A bit for a node.
const fn node_bit(index: usize) -> u16 {
    1 << (index & 15)
}
