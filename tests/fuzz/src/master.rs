//! The CANopen master, on frames, times, requests and forces in any order.

use shapebot_answers::{Nodes, ballbot3d::DRIVE};
use shapebot_drive::safety::{REQUESTS, Request, State};
use shapebot_drive::{Command, DriveTable, Fault, Frame, Master, Source, extended};

/// Frames that a call may send: set-up, heartbeats and SYNCs, and twice what goes out in a cycle.
const MOST_FRAMES: usize = 2 * (DRIVE.nodes.len() + DRIVE.buses.len() + DRIVE.commands.len());

/// Cycles in which nodes that answer bring the robot from power-up to balancing.
const PATIENCE: usize = 1000;

/// Takes a choice of where to begin, then orders until the bytes end.
///
/// # Panics
///
/// If a torque goes out that the state forbids or that is above a drive's limit, or if a call sends
/// more than a bounded number of frames.
pub fn check(bytes: &[u8]) {
    let Some((choice, mut orders)) = bytes.split_first() else { return };
    let mut bench = Bench::new(&DRIVE);
    if choice & 1 == 1 {
        bench.stand();
        assert_eq!(bench.master.state(), State::StationKeeping, "{:?}", bench.master.faults());
    }
    while let Some(order) = take::<1>(&mut orders) {
        bench.obey(order[0], &mut orders);
    }
}

/// The next bytes; those that are missing are zero. `None` at the end.
fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    if bytes.is_empty() {
        return None;
    }
    let (own, rest) = bytes.split_at(N.min(bytes.len()));
    *bytes = rest;
    let mut taken = [0; N];
    taken[..own.len()].copy_from_slice(own);
    Some(taken)
}

struct Bench<'a> {
    table: &'a DriveTable<'a>,
    master: Master<'a>,
    nodes: Nodes<'a>,
    now: u64,
    sent: Vec<(usize, Frame)>,
}

impl<'a> Bench<'a> {
    fn new(table: &'a DriveTable<'a>) -> Self {
        let (master, nodes) = (Master::new(table), Nodes::new(table));
        Self { table, master, nodes, now: 0, sent: Vec::new() }
    }

    fn obey(&mut self, order: u8, rest: &mut &[u8]) {
        match order % 8 {
            0 | 1 => {
                let [bus, low, high, len] = take(rest).unwrap_or_default();
                let data: [u8; 8] = take(rest).unwrap_or_default();
                self.receive(bus, u16::from_le_bytes([low, high]), &data[..usize::from(len % 9)]);
            }
            2 => {
                let delay = u16::from_le_bytes(take(rest).unwrap_or_default());
                self.now += u64::from(delay);
                self.poll();
            }
            3 => self.now += u64::from(u32::from_le_bytes(take(rest).unwrap_or_default())),
            4 => {
                let [which] = take(rest).unwrap_or_default();
                self.master.request(REQUESTS[usize::from(which) % REQUESTS.len()], self.now);
            }
            5 => {
                let force = f32::from_le_bytes(take(rest).unwrap_or_default());
                let count = i64::from(i16::from_le_bytes(take(rest).unwrap_or_default()));
                self.cycle(force, count);
            }
            6 => {
                let force = f32::from_le_bytes(take(rest).unwrap_or_default());
                self.command(force);
            }
            _ => {
                let [which] = take(rest).unwrap_or_default();
                match which % 4 {
                    0 => self.master.report(Fault::Bus, self.now),
                    1 => self.master.plan(which & 4 != 0, which & 8 != 0),
                    2 => self.master.aim(f32::from_le_bytes(take(rest).unwrap_or_default())),
                    _ => {
                        let _ = self.master.measure(self.now);
                    }
                }
            }
        }
    }

    /// A frame that a node or somebody else sends. Odd buses are not only those that there are.
    fn receive(&mut self, bus: u8, id: u16, bytes: &[u8]) {
        let frame = if id & 0x8000 == 0 {
            Frame::new(id, bytes)
        } else {
            let id = extended(id.into()).expect("29 bits");
            Frame::checked(id, bytes).expect("at most eight bytes")
        };
        self.master.receive(usize::from(bus % 4), &frame, self.now);
    }

    /// A whole cycle with nodes that answer, all of which measure `count`.
    fn cycle(&mut self, force: f32, count: i64) {
        self.now += u64::from(self.table.timing.period_us);
        self.poll();
        let mut inbox = Vec::new();
        for (bus, frame) in std::mem::take(&mut self.sent) {
            inbox.extend(self.nodes.hear(bus, &frame).map(|answer| (bus, answer)));
        }
        self.nodes.sample(|_, _| count, |bus, frame| inbox.push((bus, frame)));
        inbox.extend(self.nodes.heartbeats());
        for (bus, frame) in inbox {
            self.master.receive(bus, &frame, self.now);
        }
        self.poll();
        self.command(force);
    }

    /// From power-up to holding a position, as nodes and operator want it.
    fn stand(&mut self) {
        for _ in 0..PATIENCE {
            self.cycle(0.0, 0);
            let request = match self.master.state() {
                State::LegsDown => Request::Start,
                State::Balancing => Request::KeepStation,
                State::StationKeeping => return,
                _ => continue,
            };
            self.master.request(request, self.now);
        }
    }

    fn poll(&mut self) {
        let (before, from) = (self.master.state(), self.sent.len());
        let sent = &mut self.sent;
        self.master.poll(self.now, &mut |bus, frame| sent.push((bus, frame)));
        self.judge(before, from);
        // Nobody hears frames of many polls in one cycle.
        let excess = self.sent.len().saturating_sub(4 * MOST_FRAMES);
        self.sent.drain(..excess);
    }

    fn command(&mut self, force: f32) {
        let _ = self.master.measure(self.now);
        let (before, from) = (self.master.state(), self.sent.len());
        let command = Command::new(&[force, -force, force]);
        let sent = &mut self.sent;
        self.master.command(&command, self.now, &mut |bus, frame| sent.push((bus, frame)));
        self.judge(before, from);
        // The state is final before torques are.
        let torque =
            self.table.axes.iter().enumerate().any(|(at, _)| self.master.torque_counts(at) != 0);
        assert!(!torque || self.master.state().permits_torque(), "torque is left over");
    }

    /// What went out in a call that began in the state `before`.
    fn judge(&self, before: State, from: usize) {
        let sent = &self.sent[from..];
        assert!(sent.len() <= MOST_FRAMES, "{} frames in a call", sent.len());
        for (bus, frame) in sent {
            for (torque, limit) in torques(self.table, *bus, frame) {
                assert!(torque.abs() <= limit, "{torque} counts of {limit}");
                assert!(torque == 0 || before.permits_torque(), "{torque} counts in {before:?}");
            }
        }
    }
}

/// Torques in a frame of the master and their limits, counts.
fn torques(table: &DriveTable<'_>, bus: usize, frame: &Frame) -> Vec<(i64, i64)> {
    let is_it = |command: &&shapebot_drive::CommandTable<'_>| {
        Some(command.cob_id) == frame.standard_id() && usize::from(command.bus) == bus
    };
    let (mut found, mut rest) = (Vec::new(), frame.bytes());
    for field in table.commands.iter().find(is_it).map_or(&[][..], |command| command.fields) {
        let (own, after) = rest.split_at(field.kind.bytes());
        rest = after;
        if let Source::Torque { axis, .. } = field.source {
            let drives = table.axes[usize::from(axis)].drives.iter();
            let limits = drives.filter_map(|drive| table.nodes[usize::from(*drive)].motor);
            let limit = limits.map(|motor| i64::from(motor.torque_limit)).min();
            found.push((field.kind.decode(own), limit.expect("a drive with a motor")));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{Bench, DRIVE, check};
    use shapebot_drive::safety::State;

    #[test]
    fn nodes_that_answer_bring_the_robot_to_stand_and_forces_reach_the_drives() {
        let mut bench = Bench::new(&DRIVE);
        bench.stand();
        assert_eq!(bench.master.state(), State::StationKeeping);
        bench.sent.clear();
        for _ in 0..20 {
            bench.cycle(10.0, 0);
        }
        assert!(bench.master.torque_counts(0) > 0 && bench.master.torque_counts(1) < 0);
    }

    #[test]
    fn orders_of_all_kinds_are_obeyed() {
        let orders: Vec<u8> =
            (0..2000_u32).map(|at| (at.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        for begin in [0, 1] {
            check(&[&[begin], &orders[..]].concat());
        }
    }
}
