//! What a log of a drive's buses says, by the tables that are generated from the drive's description.

use shapebot_bus::candump::{self, Entry};
use shapebot_bus::{Bus as _, Frame, Replay};
use shapebot_drive::cia402;
use shapebot_drive::id::{Function, SYNC};
use shapebot_drive::legs::LegsState;
use shapebot_drive::{DriveTable, NodeTable, Pdo, Signal, Source};
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// Frames between two SYNCs.
#[derive(Clone, Debug, Default)]
struct Cycle {
    at: u64,
    /// Identifiers of synchronous TPDOs and cyclic RPDOs, as they came.
    pdos: Vec<u16>,
}

/// A log, taken apart.
#[derive(Clone, Debug, Default)]
pub(crate) struct Traffic {
    pub(crate) frames: usize,
    /// What the tables do not have, or what does not decode.
    pub(crate) strange: Vec<String>,
    /// Emergency frames other than "no error", up to the last SYNC: then the master is gone.
    pub(crate) emergencies: Vec<String>,
    /// NMT "start" commands.
    pub(crate) starts: usize,
    /// Answers to SDO requests by node-ID, and those among them that abort.
    pub(crate) answers: BTreeMap<u8, usize>,
    pub(crate) aborts: usize,
    /// States of the drives that were told, all drives together.
    pub(crate) enabled: usize,
    /// Torque commands that are not zero, and those beyond the drive's limit.
    pub(crate) torques: usize,
    pub(crate) beyond: usize,
    /// What operators sent.
    pub(crate) orders: usize,
    /// First and last position by node-ID, in the drive's counts.
    pub(crate) positions: BTreeMap<u8, [i64; 2]>,
    /// Whether the legs said that they are up, and what they said last.
    pub(crate) rose: bool,
    pub(crate) legs: Option<LegsState>,
    /// Cycles from the first to the last in which all inputs came.
    pub(crate) cycles: usize,
    /// Those with every input and every command once.
    pub(crate) complete: usize,
    /// Those of the complete ones in which all inputs came before the first command.
    pub(crate) ordered: usize,
    /// Time from SYNC to SYNC in these cycles, µs, sorted.
    pub(crate) periods: Vec<u64>,
    /// From the first SYNC of these cycles to the last, µs.
    pub(crate) span: u64,
}

impl Traffic {
    /// What candump recorded.
    pub(crate) fn read(log: &Path, table: &DriveTable<'_>) -> Self {
        let file = std::fs::File::open(log).expect("candump's log");
        let entries = candump::read(log, std::io::BufReader::new(file)).expect("a log");
        Self::of(entries, table)
    }

    pub(crate) fn of(entries: Vec<Entry>, table: &DriveTable<'_>) -> Self {
        let mut traffic = Self { frames: entries.len(), ..Self::default() };
        let mut cycles: Vec<Cycle> = Vec::new();
        let mut emergencies = 0;
        let mut log = Replay::new(entries);
        while let Ok(Some(received)) = log.receive(u64::MAX) {
            let cyclic = traffic.note(&received.frame, table);
            match received.frame.standard_id() {
                Some(SYNC) => {
                    emergencies = traffic.emergencies.len();
                    cycles.push(Cycle { at: received.time, pdos: Vec::new() });
                }
                Some(id) if cyclic => {
                    if let Some(cycle) = cycles.last_mut() {
                        cycle.pdos.push(id);
                    }
                }
                _ => {}
            }
        }
        traffic.emergencies.truncate(emergencies);
        traffic.judge(&cycles, table);
        traffic
    }

    /// Asserts what no scheduling may change.
    pub(crate) fn check(&self, table: &DriveTable<'_>) {
        assert!(self.strange.is_empty(), "{:?}", self.strange);
        assert!(self.emergencies.is_empty(), "{:?}", self.emergencies);
        // Each node is set up, each step answered, and started.
        for node in table.nodes {
            let answers = self.answers.get(&node.id.raw()).copied().unwrap_or(0);
            assert!(answers >= node.setup.len(), "{}: {answers} answers", node.name);
        }
        assert_eq!(self.aborts, 0);
        assert!(self.starts > 0 && self.enabled > 1000, "{}", self.enabled);
        // It balances: torque is given, within limits, the legs are up, and down again at the end.
        assert!(self.torques > 1000 && self.beyond == 0, "{} {}", self.torques, self.beyond);
        assert!(self.rose && self.legs.is_some_and(LegsState::is_down));
        // It stands, moves for three seconds, and stands.
        assert!(self.cycles > 3000, "{} cycles", self.cycles);
    }

    /// Whether SYNC keeps its period, µs, but for what is skipped when the computer stalls, and whether
    /// nearly all cycles are whole, inputs before commands.
    pub(crate) fn keeps_time(&self, period: u32) -> bool {
        let near = |value: f64, part: f64| (value / f64::from(period) - 1.0).abs() < part;
        let most = self.cycles / 20;
        self.complete >= self.cycles - most
            && self.ordered >= self.complete - most
            && near(self.mean_period(), 0.05)
            && near(self.median_period() as f64, 0.05)
    }

    /// Time from SYNC to SYNC on the average, µs.
    pub(crate) fn mean_period(&self) -> f64 {
        self.span as f64 / self.periods.len().max(1) as f64
    }

    pub(crate) fn median_period(&self) -> u64 {
        self.periods.get(self.periods.len() / 2).copied().unwrap_or(0)
    }

    /// Notes a frame; true if it is of the cycle.
    fn note(&mut self, frame: &Frame, table: &DriveTable<'_>) -> bool {
        let id = frame.standard_id().unwrap_or(u16::MAX);
        let bytes = frame.bytes();
        let sent = table.nodes.iter().flat_map(|node| node.transmit.iter().map(move |p| (node, p)));
        if let Some((node, pdo)) = sent.into_iter().find(|(_, pdo)| pdo.cob_id == id) {
            self.input(node, pdo, bytes);
            return pdo.is_synchronous();
        }
        if let Some(command) = table.commands.iter().find(|command| command.cob_id == id) {
            let fields = command.fields;
            let sizes: usize = fields.iter().map(|field| field.kind.bytes()).sum();
            if sizes != bytes.len() {
                self.strange.push(format!("{id:03X} of {} bytes", bytes.len()));
            }
            let mut rest = bytes;
            for field in fields {
                let value = field.kind.decode(rest);
                rest = rest.get(field.kind.bytes()..).unwrap_or(&[]);
                if let Source::Torque { axis, .. } = field.source {
                    self.torque(value, axis, table);
                }
            }
            return command.cyclic;
        }
        match Function::of(id) {
            Function::Nmt => self.starts += usize::from(bytes.first() == Some(&1)),
            Function::SdoResponse(node) => {
                *self.answers.entry(node.raw()).or_default() += 1;
                self.aborts += usize::from(bytes.first() == Some(&0x80));
            }
            Function::Emergency(_) if bytes.get(..2) != Some(&[0, 0]) => {
                self.emergencies.push(format!("{id:03X}#{bytes:02X?}"));
            }
            Function::Other if id == table.operator.command => self.orders += 1,
            Function::Other if id != table.operator.telemetry => {
                self.strange.push(format!("{id:03X}"));
            }
            _ => {}
        }
        false
    }

    fn input(&mut self, node: &NodeTable<'_>, pdo: &Pdo, bytes: &[u8]) {
        if bytes.len() != pdo.bytes() {
            self.strange.push(format!("{} sends {} bytes", node.name, bytes.len()));
        }
        let mut rest = bytes;
        for entry in pdo.entries() {
            let value = entry.kind.decode(rest);
            rest = rest.get(entry.kind.bytes()..).unwrap_or(&[]);
            match entry.signal {
                Signal::Statusword => match cia402::State::of(u16::try_from(value).unwrap_or(0)) {
                    Some(cia402::State::OperationEnabled) => self.enabled += 1,
                    Some(_) => {}
                    None => self.strange.push(format!("{}: statusword {value:#x}", node.name)),
                },
                Signal::Position => {
                    self.positions.entry(node.id.raw()).or_insert([value; 2])[1] = value;
                }
                Signal::LegsState => {
                    let state = LegsState(u8::try_from(value).unwrap_or(u8::MAX));
                    self.rose |= state.is_up();
                    self.legs = Some(state);
                }
                _ => {}
            }
        }
    }

    fn torque(&mut self, value: i64, axis: u8, table: &DriveTable<'_>) {
        let drives = table.axes.get(usize::from(axis)).map_or(&[][..], |axis| axis.drives);
        let motors = drives.iter().filter_map(|drive| table.nodes.get(usize::from(*drive))?.motor);
        let limit = motors.map(|motor| i64::from(motor.torque_limit)).min().unwrap_or(0);
        self.torques += usize::from(value != 0);
        self.beyond += usize::from(value.abs() > limit);
    }

    fn judge(&mut self, cycles: &[Cycle], table: &DriveTable<'_>) {
        let inputs = table.nodes.iter().flat_map(|node| node.transmit);
        let inputs: Vec<u16> = inputs.filter(|p| p.is_synchronous()).map(|p| p.cob_id).collect();
        let commands = table.commands.iter().filter(|command| command.cyclic);
        let commands: Vec<u16> = commands.map(|command| command.cob_id).collect();
        let once = |cycle: &Cycle, id: &u16| cycle.pdos.iter().filter(|p| *p == id).count() == 1;
        let all_inputs = |cycle: &Cycle| inputs.iter().all(|id| once(cycle, id));
        let first = cycles.iter().position(all_inputs).unwrap_or(0);
        let last = cycles.iter().rposition(all_inputs).unwrap_or(0);
        let used = cycles.get(first..=last).unwrap_or(&[]);
        self.cycles = used.len();
        for cycle in used {
            if all_inputs(cycle) && commands.iter().all(|id| once(cycle, id)) {
                self.complete += 1;
                let last_input = cycle.pdos.iter().rposition(|id| inputs.contains(id));
                let first_command = cycle.pdos.iter().position(|id| commands.contains(id));
                self.ordered += usize::from(first_command > last_input);
            }
        }
        let times = used.windows(2).filter_map(|pair| match pair {
            [one, next] => Some(next.at.saturating_sub(one.at)),
            _ => None,
        });
        self.periods = times.collect();
        self.span = self.periods.iter().sum();
        self.periods.sort_unstable();
    }
}

impl fmt::Display for Traffic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { frames, cycles, complete, ordered, .. } = self;
        let worst = self.periods.last().copied().unwrap_or(0);
        let part = |percent| self.periods.get(self.periods.len() * percent / 100).unwrap_or(&0);
        write!(
            f,
            "{frames} frames; {cycles} cycles, {complete} with all inputs and commands, {ordered} of \
             them in order; SYNC to SYNC {:.1} us on the average, median {}, 1 % below {} us, 1 % above \
             {} us, at most {worst} us; {} emergencies",
            self.mean_period(),
            self.median_period(),
            part(1),
            part(99),
            self.emergencies.len(),
        )
    }
}
