//! Telemetry as pages of eight bytes, both ways.

use super::{MAX_GAINS, NO_NODE, Operator, Refusal, Tuned};
use crate::TELEMETRY_CYCLES;
use crate::master::Master;

/// A page of telemetry; byte 0 is its number, numbers are little-endian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Page {
    /// Page 0: state, last sequence taken, last refusal, first fault (0: none) and its node (0xFF: none),
    /// state of the legs, and whether the robot can balance.
    Status {
        /// Number of the [`State`](crate::safety::State).
        state: u8,
        /// Last sequence taken.
        sequence: u8,
        /// Number of the [`Refusal`].
        refusal: u8,
        /// Number of the first [`Fault`](crate::Fault).
        fault: u8,
        /// Its node.
        node: u8,
        /// Byte of the legs, 0xFF if unknown.
        legs: u8,
        /// 1 if the robot can balance.
        balance: u8,
    },
    /// Page 1: all faults, a bit each, and cycles modulo 65536.
    Faults {
        /// Bits by the numbers of faults.
        bits: u32,
        /// Cycles.
        cycles: u16,
    },
    /// Page 2: lean of the first two coordinates of lean and heading, 0.1 mrad.
    Lean {
        /// Lean and heading, 0.1 mrad.
        angles: [i16; 3],
    },
    /// Pages 3 to 5: forces of three axes each, 10 mN·m or 10 mN, as applied.
    Forces {
        /// 0 to 2.
        group: u8,
        /// Forces, 10 mN·m or 10 mN.
        forces: [i16; 3],
    },
    /// Pages 6 to 9: positions of two coordinates each, 0.1 mrad or 0.1 mm, as 24-bit numbers.
    Positions {
        /// 0 to 3.
        group: u8,
        /// Positions, 0.1 mrad or 0.1 mm.
        positions: [i32; 2],
    },
    /// Page 10: missed inputs, worst lateness of SYNC in µs, malformed and unknown frames.
    Health {
        /// Missed inputs.
        missed: u16,
        /// Worst lateness, µs.
        worst_us: u16,
        /// Malformed and unknown frames.
        strange: u16,
    },
    /// Page 11: bytes of an upload that were received, and whether it is whole.
    Upload {
        /// Bytes.
        received: u32,
        /// 1 if it is whole and sound.
        complete: u8,
    },
    /// Page 12: gains as percentages of the designed ones, by their numbers, and whether silence of the
    /// operator is a fault.
    Tuned {
        /// Percentages; 100 also where there is no such gain.
        percent: [u8; MAX_GAINS],
        /// 1 if the watch is armed.
        watch: u8,
    },
}

/// Number of pages.
const PAGES: u8 = 13;

/// Pages between two of the status.
const STATUS_EVERY: u8 = 3;

fn count(value: u32) -> u16 {
    u16::try_from(value).unwrap_or(u16::MAX)
}

/// A number of so many counts, saturated; not a number is zero.
fn fixed(value: f64, scale: f64) -> i16 {
    (value * scale) as i16
}

impl Page {
    /// As bytes.
    #[must_use]
    pub fn encode(self) -> [u8; 8] {
        let three = |page: u8, [a, b, c]: [i16; 3]| {
            let ([a, d], [b, e], [c, f]) = (a.to_le_bytes(), b.to_le_bytes(), c.to_le_bytes());
            [page, 0, a, d, b, e, c, f]
        };
        match self {
            Self::Status { state, sequence, refusal, fault, node, legs, balance } => {
                [0, state, sequence, refusal, fault, node, legs, balance]
            }
            Self::Faults { bits, cycles } => {
                let ([a, b, c, d], [e, f]) = (bits.to_le_bytes(), cycles.to_le_bytes());
                [1, 0, a, b, c, d, e, f]
            }
            Self::Lean { angles } => three(2, angles),
            Self::Forces { group, forces } => three(3_u8.saturating_add(group.min(2)), forces),
            Self::Positions { group, positions: [x, y] } => {
                let ([a, b, c, _], [d, e, f, _]) = (x.to_le_bytes(), y.to_le_bytes());
                [6_u8.saturating_add(group.min(3)), 0, a, b, c, d, e, f]
            }
            Self::Health { missed, worst_us, strange } => {
                let ([a, b], [c, d]) = (missed.to_le_bytes(), worst_us.to_le_bytes());
                let [e, f] = strange.to_le_bytes();
                [10, 0, a, b, c, d, e, f]
            }
            Self::Upload { received, complete } => {
                let [a, b, c, d] = received.to_le_bytes();
                [11, 0, a, b, c, d, complete, 0]
            }
            Self::Tuned { percent: [a, b, c, d], watch } => [12, 0, a, b, c, d, watch, 0],
        }
    }

    /// From bytes; `None` unless they are a page.
    #[must_use]
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let &[page, one, a, b, c, d, e, f] = bytes else { return None };
        let three = || [[a, b], [c, d], [e, f]].map(i16::from_le_bytes);
        // Sign of the 24th bit.
        let wide = |bytes: [u8; 3]| {
            let [low, middle, high] = bytes;
            i32::from_le_bytes([0, low, middle, high]) >> 8
        };
        Some(match page {
            0 => Self::Status {
                state: one,
                sequence: a,
                refusal: b,
                fault: c,
                node: d,
                legs: e,
                balance: f,
            },
            1 => Self::Faults {
                bits: u32::from_le_bytes([a, b, c, d]),
                cycles: u16::from_le_bytes([e, f]),
            },
            2 => Self::Lean { angles: three() },
            3..=5 => Self::Forces { group: page.saturating_sub(3), forces: three() },
            6..=9 => Self::Positions {
                group: page.saturating_sub(6),
                positions: [wide([a, b, c]), wide([d, e, f])],
            },
            10 => Self::Health {
                missed: u16::from_le_bytes([a, b]),
                worst_us: u16::from_le_bytes([c, d]),
                strange: u16::from_le_bytes([e, f]),
            },
            11 => Self::Upload { received: u32::from_le_bytes([a, b, c, d]), complete: e },
            12 => Self::Tuned { percent: [a, b, c, d], watch: e },
            _ => return None,
        })
    }
}

impl Operator<'_> {
    /// The page of telemetry that is due, once each [`TELEMETRY_CYCLES`] cycles; every third is the
    /// status.
    pub fn telemetry(&mut self, master: &Master<'_>, tuned: &Tuned) -> Option<[u8; 8]> {
        let cycles = master.counters().cycles;
        if cycles < self.due {
            return None;
        }
        self.due = cycles.saturating_add(TELEMETRY_CYCLES);
        let turn = self.page;
        self.page = turn.wrapping_add(1);
        let page = if turn.checked_rem(STATUS_EVERY) == Some(0) {
            0
        } else {
            // Of three turns two are left for the other pages.
            let others = u16::from(turn).saturating_mul(2).checked_div(3).unwrap_or(0);
            let other = others.checked_rem(u16::from(PAGES - 1)).unwrap_or(0);
            u8::try_from(other).unwrap_or(0).saturating_add(1)
        };
        Some(self.page(page, master, tuned).encode())
    }

    fn page(&self, page: u8, master: &Master<'_>, tuned: &Tuned) -> Page {
        match page {
            1 => Page::Faults {
                bits: master.faults().bits(),
                cycles: master.counters().cycles as u16,
            },
            2 => {
                let m = master.measurement();
                let lean = |at: usize| {
                    let index = master.table().safety.lean.get(at);
                    index.map_or(0, |index| fixed(m.position(usize::from(*index)), 1e4))
                };
                Page::Lean { angles: [lean(0), lean(1), fixed(m.heading.into(), 1e4)] }
            }
            3..=5 => {
                let group = page.saturating_sub(3);
                let applied = master.applied();
                let first = usize::from(group).saturating_mul(3);
                let force = |at: usize| {
                    let value = applied.get(first.saturating_add(at)).copied().unwrap_or(0.0);
                    fixed(value.into(), 100.0)
                };
                Page::Forces { group, forces: [force(0), force(1), force(2)] }
            }
            6..=9 => {
                let group = page.saturating_sub(6);
                let first = usize::from(group).saturating_mul(2);
                let position = |at: usize| {
                    let value = master.measurement().position(first.saturating_add(at)) * 1e4;
                    (value as i32).clamp(-0x80_0000, 0x7F_FFFF)
                };
                Page::Positions { group, positions: [position(0), position(1)] }
            }
            10 => {
                let counters = master.counters();
                Page::Health {
                    missed: count(counters.missed),
                    worst_us: count(master.jitter().worst_us()),
                    strange: count(counters.malformed.saturating_add(counters.unknown)),
                }
            }
            11 => {
                let (received, _) = self.plans.progress();
                let complete = u8::from(self.plans.pending().is_some());
                Page::Upload { received: u32::try_from(received).unwrap_or(u32::MAX), complete }
            }
            12 => Page::Tuned {
                // The cast saturates.
                percent: tuned.factors.map(|factor| libm::roundf(factor * 100.0) as u8),
                watch: u8::from(tuned.watch),
            },
            _ => self.status(master),
        }
    }

    fn status(&self, master: &Master<'_>) -> Page {
        let first = master.faults().first();
        Page::Status {
            state: master.state() as u8,
            sequence: self.sequence.unwrap_or(0),
            refusal: self.refusal as u8,
            fault: first.map_or(0, |record| record.fault as u8),
            node: first.and_then(|record| record.node).unwrap_or(NO_NODE),
            legs: master.legs().map_or(0xFF, |legs| legs.0),
            balance: u8::from(!master.faults().prevents_balance()),
        }
    }
}

const _: () = assert!(Refusal::Plan as u8 == 8);
