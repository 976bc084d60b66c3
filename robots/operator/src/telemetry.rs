//! The last of each page.

use shapebot_drive::operator::{MAX_GAINS, Page};

/// Page 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status {
    /// Number of the [`State`](shapebot_drive::safety::State).
    pub state: u8,
    /// Last sequence taken.
    pub sequence: u8,
    /// Number of the [`Refusal`](shapebot_drive::operator::Refusal).
    pub refusal: u8,
    /// Number of the first [`Fault`](shapebot_drive::Fault), with its node unless that is 0xFF.
    pub fault: Option<(u8, u8)>,
    /// Byte of the legs, if known.
    pub legs: Option<u8>,
    /// Whether the robot can balance.
    pub balance: bool,
}

/// Page 10.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Health {
    /// Missed inputs.
    pub missed: u16,
    /// Worst lateness of SYNC, µs.
    pub worst_us: u16,
    /// Malformed and unknown frames.
    pub strange: u16,
}

/// Page 11.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Upload {
    /// Bytes received.
    pub received: u32,
    /// Whether the plan is whole and sound.
    pub complete: bool,
}

/// Page 12.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tuning {
    /// Gains as percentages of the designed ones, by their numbers.
    pub percent: [u8; MAX_GAINS],
    /// Whether silence of the operator is a fault.
    pub watch: bool,
}

/// What a robot said last; SI units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Telemetry {
    /// Pages taken.
    pub pages: u64,
    /// State, first fault, last command.
    pub status: Option<Status>,
    /// All faults as bits by their numbers, and cycles modulo 65536.
    pub faults: Option<(u32, u16)>,
    /// Lean of two coordinates and heading, rad.
    pub lean: Option<[f64; 3]>,
    /// Applied forces by axis, N·m or N.
    pub forces: [Option<f64>; 9],
    /// Positions by coordinate, rad or m.
    pub positions: [Option<f64>; 8],
    /// Of the buses.
    pub health: Option<Health>,
    /// Of a plan.
    pub upload: Option<Upload>,
    /// Of what an operator set.
    pub tuning: Option<Tuning>,
}

impl Telemetry {
    /// Takes eight bytes; whether they are a page.
    pub fn take(&mut self, bytes: &[u8; 8]) -> bool {
        let Some(page) = Page::decode(bytes) else { return false };
        self.pages += 1;
        match page {
            Page::Status { state, sequence, refusal, fault, node, legs, balance } => {
                self.status = Some(Status {
                    state,
                    sequence,
                    refusal,
                    fault: (fault != 0).then_some((fault, node)),
                    legs: (legs != 0xFF).then_some(legs),
                    balance: balance != 0,
                });
            }
            Page::Faults { bits, cycles } => self.faults = Some((bits, cycles)),
            Page::Lean { angles } => self.lean = Some(angles.map(|angle| f64::from(angle) * 1e-4)),
            Page::Forces { group, forces } => {
                put(&mut self.forces, group, forces.map(|force| f64::from(force) * 0.01));
            }
            Page::Positions { group, positions } => {
                put(&mut self.positions, group, positions.map(|place| f64::from(place) * 1e-4));
            }
            Page::Health { missed, worst_us, strange } => {
                self.health = Some(Health { missed, worst_us, strange });
            }
            Page::Upload { received, complete } => {
                self.upload = Some(Upload { received, complete: complete != 0 });
            }
            Page::Tuned { percent, watch } => {
                self.tuning = Some(Tuning { percent, watch: watch != 0 });
            }
        }
        true
    }
}

fn put<const L: usize>(to: &mut [Option<f64>], group: u8, values: [f64; L]) {
    let places = to.iter_mut().skip(usize::from(group) * L);
    for (place, value) in places.zip(values) {
        *place = Some(value);
    }
}
