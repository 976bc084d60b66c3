//! What the master knows of a node.

use crate::cia402;
use crate::legs::LegsState;
use crate::sdo::{self, Answer};
use crate::table::{NodeTable, Pdo, Role, SdoStep};

/// Set-up of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    /// To be reset.
    New,
    /// Reset, its boot-up message is awaited until this time.
    Booting(u64),
    /// Between two steps of the set-up.
    Next(u16),
    /// A step is asked, and answered at the latest at this time.
    Asked { step: u16, due: u64, tries: u8 },
    /// Operational.
    Running,
    /// Given up until a reset.
    Failed,
}

/// What an answer means for the set-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Not the answer to our question.
    Unrelated,
    /// Go on.
    Done,
    /// The set-up fails; the code or the value found.
    Failed(u32),
}

/// What the master knows of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeState {
    pub(super) phase: Phase,
    /// When its last heartbeat came, µs.
    pub(super) heard: u64,
    /// Whether it was heard to be operational.
    pub(super) operational: bool,
    /// Whether a transmit PDO came since it was started.
    pub(super) reported: bool,
    /// Transmit PDOs of this cycle, a bit each.
    pub(super) received: u8,
    /// Cycles in a row in which one was missing.
    pub(super) missed: u8,
    pub(super) statusword: u16,
    /// State of a drive by its statusword; nonsense counts as a fault.
    pub(super) drive_state: cia402::State,
    pub(super) mode: i8,
    /// The mode that it is to be in.
    wanted_mode: Option<i8>,
    /// The mode is that one.
    pub(super) is_in_mode: bool,
    pub(super) error_register: u8,
    is_drive: bool,
    /// It is a drive of which no state of the master has to complain.
    pub(super) is_sound_drive: bool,
    /// PDOs that come each cycle, a bit each.
    pub(super) expected: u8,
    /// Fault reset is under way: cycles for which bit 7 may stay set.
    pub(super) reset_cycles: u8,
    pub(super) controlword: u16,
    /// Position object as it came, extended to 32 bits.
    pub(super) counts: Option<u32>,
    /// What the object went, counts, across its wraps.
    pub(super) travel: i64,
    /// The same when drives were enabled.
    pub(super) origin: i64,
    /// A count in the coordinate's unit, with its sign.
    pub(super) unit: f32,
    /// Rate by the drive.
    pub(super) velocity: Option<f32>,
    pub(super) torque: f32,
    /// Counter of a sensor's samples.
    pub(super) sequence: Option<u8>,
    /// Cycles in a row with the same sample.
    pub(super) stale: u8,
    pub(super) health: u8,
    pub(super) legs: Option<LegsState>,
}

impl NodeState {
    pub(super) const NEW: Self = Self {
        phase: Phase::New,
        heard: 0,
        operational: false,
        reported: false,
        received: 0,
        missed: 0,
        statusword: 0,
        drive_state: cia402::State::NotReady,
        mode: 0,
        wanted_mode: None,
        is_in_mode: false,
        error_register: 0,
        is_drive: false,
        is_sound_drive: false,
        expected: 0,
        reset_cycles: 0,
        controlword: 0,
        counts: None,
        travel: 0,
        origin: 0,
        unit: 0.0,
        velocity: None,
        torque: 0.0,
        sequence: None,
        stale: 0,
        health: 0,
        legs: None,
    };

    /// A way of another drive in this one's counts; `None` unless they are of one size.
    pub(super) fn own_counts(&self, other: &Self, way: i64) -> Option<i64> {
        if other.unit == self.unit {
            Some(way)
        } else {
            (other.unit == -self.unit).then(|| way.wrapping_neg())
        }
    }

    /// How far apart two drives are since they were enabled, in the coordinate's unit.
    pub(super) fn apart(&self, other: &Self) -> f32 {
        let [own, others] = [self, other].map(|node| node.travel.wrapping_sub(node.origin));
        let apart = match self.own_counts(other, others) {
            Some(others) => single(own.wrapping_sub(others)) * self.unit,
            None => single(own) * self.unit - single(others) * other.unit,
        };
        libm::fabsf(apart)
    }

    pub(super) const fn is_running(&self) -> bool {
        matches!(self.phase, Phase::Running)
    }

    /// Since its last heartbeat, µs.
    pub(super) fn silence(&self, now: u64) -> u32 {
        u32::try_from(now.saturating_sub(self.heard)).unwrap_or(u32::MAX)
    }

    /// Whether there may be something to complain of: the state of the master decides.
    pub(super) fn is_suspect(&self) -> bool {
        let faulty = self.legs.is_some_and(LegsState::is_faulty);
        let unsound = self.is_drive != self.is_sound_drive;
        self.is_running() && (unsound || self.health | self.stale != 0 || faulty)
    }

    pub(super) fn set_statusword(&mut self, word: u16) {
        if word != self.statusword {
            self.statusword = word;
            self.drive_state = cia402::State::of(word).unwrap_or(cia402::State::Fault);
            self.judge_drive();
        }
    }

    pub(super) fn set_mode(&mut self, mode: i8) {
        if mode != self.mode {
            self.mode = mode;
            self.is_in_mode = self.wanted_mode.is_none_or(|wanted| wanted == mode);
            self.judge_drive();
        }
    }

    pub(super) fn set_error_register(&mut self, register: u8) {
        if register != self.error_register {
            self.error_register = register;
            self.judge_drive();
        }
    }

    #[cold]
    fn judge_drive(&mut self) {
        self.is_sound_drive = self.is_drive
            && self.drive_state == cia402::State::OperationEnabled
            && self.error_register & 1 == 0
            && self.is_in_mode;
    }

    /// Whether a drive is alive, enabled and in its mode.
    #[inline(always)]
    pub(super) fn obeys(&self, missed_fault: u8) -> bool {
        self.is_running()
            && self.missed < missed_fault
            && self.drive_state == cia402::State::OperationEnabled
            && self.is_in_mode
    }

    /// Whether a node is set up, alive and sound, and a drive can be enabled or is.
    pub(super) fn is_ready(&self, table: &NodeTable<'_>) -> bool {
        let heard = self.is_running() && self.missed == 0 && self.reported;
        let sound = match table.role {
            Role::Drive => {
                let ready = matches!(
                    self.drive_state,
                    cia402::State::ReadyToSwitchOn
                        | cia402::State::SwitchedOn
                        | cia402::State::OperationEnabled
                );
                ready && self.is_in_mode
            }
            Role::Imu => self.sequence.is_some() && self.stale == 0 && self.health == 0,
            Role::Encoder => self.health == 0,
            Role::Legs => self.legs.is_some_and(|legs| !legs.is_faulty()),
        };
        heard && sound
    }

    /// A node that was just started.
    pub(super) fn started(now: u64, table: &NodeTable<'_>) -> Self {
        let wanted_mode = table.motor.as_ref().map(|motor| motor.mode);
        Self {
            heard: now,
            wanted_mode,
            is_in_mode: wanted_mode.is_none_or(|wanted| wanted == Self::NEW.mode),
            is_drive: table.role == Role::Drive,
            expected: synchronous(table.transmit),
            ..Self::NEW
        }
    }

    /// What an SDO answer means for the step that was asked.
    pub(super) fn verdict(&self, table: &NodeTable<'_>, answer: Answer) -> Verdict {
        let Phase::Asked { step, .. } = self.phase else {
            return Verdict::Unrelated;
        };
        let Some(step) = table.setup.get(usize::from(step)) else {
            return Verdict::Unrelated;
        };
        judge(step, answer)
    }
}

/// The PDOs that come each cycle, a bit each.
fn synchronous(pdos: &[Pdo]) -> u8 {
    let bits = pdos.iter().zip(0..8).filter(|(pdo, _)| pdo.transmission == 1);
    bits.fold(0, |mask, (_, bit)| mask | 1 << bit)
}

/// In single precision, by the instruction for 32 bits: exactly rounded for numbers of that size, within
/// one unit in the last place beyond.
pub(super) fn single(value: i64) -> f32 {
    shapebot_dynamics::Ordered::from_i64(value)
}

fn judge(step: &SdoStep, answer: Answer) -> Verdict {
    match (*step, answer) {
        (SdoStep::Write { object, .. }, Answer::Written(found)) if found == object => Verdict::Done,
        (
            SdoStep::Expect { object, kind, mask, value },
            Answer::Read { object: found, bytes, value: read },
        ) if found == object => {
            let length = bytes.is_none_or(|bytes| usize::from(bytes) == kind.bytes());
            let width = match kind.bytes() {
                1 => 0xFF,
                2 => 0xFFFF,
                _ => u32::MAX,
            };
            let differs = (read ^ value) & mask & width != 0;
            if length && !differs { Verdict::Done } else { Verdict::Failed(read) }
        }
        (
            SdoStep::Write { object, .. } | SdoStep::Expect { object, .. },
            Answer::Aborted { object: found, code },
        ) if found == object => Verdict::Failed(code),
        _ => Verdict::Unrelated,
    }
}

/// The request of a step.
pub(super) fn request(table: &NodeTable<'_>, step: &SdoStep) -> crate::Frame {
    match *step {
        SdoStep::Write { object, kind, value } => sdo::download(table.id, object, kind, value),
        SdoStep::Expect { object, .. } => sdo::upload(table.id, object),
    }
}
