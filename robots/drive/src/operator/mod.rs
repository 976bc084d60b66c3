//! Operator protocol: commands to the master and telemetry of it, on the bus or over a byte stream.
//!
//! **Commands** are frames of eight bytes on [`OperatorTable::command`](crate::OperatorTable):
//!
//! ```text
//! byte 0   opcode            1   sequence       2 to 5   argument, little-endian
//! bytes 6, 7   CRC-16 (CCITT) of bytes 0 to 5, followed by the drive's fingerprint as four bytes
//! ```
//!
//! | opcode | command | argument |
//! | --- | --- | --- |
//! | 0x00 | hello: begins a session, its sequence is the first | fingerprint |
//! | 0x01 to 0x04 | start, stop, e-stop, reset | 0 |
//! | 0x05 to 0x08 | balance, keep station, track, yaw | 0 |
//! | 0x09 | heading to turn to | f32, rad |
//! | 0x10 | plan: begins an upload | length, bytes |
//! | 0x11 | plan: is complete | CRC-32 of the file |
//! | 0x12 | plan: forget the upload | 0 |
//! | 0x13 | watch: silence is a fault from now on, or no more | 1 or 0 |
//! | 0x40 to 0x7F | gain 0 to 63 | f32, within the robot's bounds |
//! | 0x80 to 0xFF | plan: seven bytes of the file; the low seven bits count them | (no CRC: the file has its own) |
//!
//! A command is taken if its checksum is right and its sequence is one to sixteen ahead of the last one
//! taken. Stop and e-stop are taken with any sequence, and without a session.
//!
//! **Watch.** An operator who gives single commands may come and go. One who wants the robot to come down
//! if the link breaks arms the watch: from then on the robot has to hear a command of the session every
//! half second ([`Commanded::watch`]), and lowers its legs if it does not. Repeating the order with the sequence of
//! the last command that was taken is enough, and is neither a command nor refused: it leaves sequence and
//! refusal to who gives commands.
//!
//! **Telemetry** is one frame of eight bytes each [`TELEMETRY_CYCLES`](crate::TELEMETRY_CYCLES) cycles,
//! page after page: see [`Page`].
//!
//! **Over a byte stream** the same eight bytes go in records: see [`stream`].
//!
//! **What this does not protect against.** There is no secret: somebody who can listen can compute the
//! checksum and the next sequence, and command the robot. What is refused is corruption, commands for
//! another drive, and commands recorded earlier. Stop and e-stop can be replayed by anybody. A flood
//! of commands costs the sender's share of the bus, each a bounded number of steps.

pub mod command;
mod plan;
pub mod stream;
mod telemetry;

use crate::id::NodeId;
use crate::safety::Request;
pub use command::Order;
pub use plan::{PlanError, PlanStore};
pub use telemetry::Page;

/// Why a command was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum Refusal {
    /// It was not.
    #[default]
    None = 0,
    /// It has not eight bytes.
    Length = 1,
    /// Its checksum is wrong: corrupt, or for another drive.
    Checksum = 2,
    /// No such opcode.
    Opcode = 3,
    /// No session was begun.
    NoSession = 4,
    /// Its sequence is not ahead of the last one.
    Sequence = 5,
    /// The state does not allow it.
    State = 6,
    /// A gain that does not exist, or a value outside its bounds.
    Bounds = 7,
    /// The plan does not fit, is not complete, or is corrupt.
    Plan = 8,
}

/// Most gains that an operator may set.
pub const MAX_GAINS: usize = 4;

/// What an operator set, for telemetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuned {
    /// Gains as factors of the designed ones, by their numbers.
    pub factors: [f32; MAX_GAINS],
    /// Whether silence of the operator is a fault while the robot balances.
    pub watch: bool,
}

impl Default for Tuned {
    fn default() -> Self {
        Self { factors: [1.0; MAX_GAINS], watch: false }
    }
}

/// Who carries out what an operator orders.
pub trait Commanded {
    /// Asks for something: false if the state does not allow it.
    fn request(&mut self, request: Request, now: u64) -> bool;

    /// The heading to turn to, rad.
    fn aim(&mut self, heading: f32);

    /// Sets a gain: false if there is none of this number, or if the value is out of its bounds.
    fn set_gain(&mut self, index: u8, value: f32) -> bool;

    /// Whether silence of the operator is a fault while the robot balances: see [`Self::heard`].
    fn watch(&mut self, on: bool, now: u64);

    /// A command of the session was taken.
    fn heard(&mut self, now: u64);
}

/// Sequences ahead of the last one that are taken.
const AHEAD: u8 = 16;

/// The operator's end in the robot.
#[derive(Debug)]
pub struct Operator<'b> {
    fingerprint: u32,
    /// Last sequence taken; `None` before hello.
    sequence: Option<u8>,
    refusal: Refusal,
    plans: PlanStore<'b>,
    page: u8,
    due: u32,
}

impl<'b> Operator<'b> {
    /// For a drive with this fingerprint.
    #[must_use]
    pub const fn new(fingerprint: u32, plans: PlanStore<'b>) -> Self {
        Self { fingerprint, sequence: None, refusal: Refusal::None, plans, page: 0, due: 0 }
    }

    /// The plans that were uploaded.
    #[must_use]
    pub const fn plans(&mut self) -> &mut PlanStore<'b> {
        &mut self.plans
    }

    /// Why the last command was refused.
    #[must_use]
    pub const fn refusal(&self) -> Refusal {
        self.refusal
    }

    /// Last sequence that was taken.
    #[must_use]
    pub const fn sequence(&self) -> Option<u8> {
        self.sequence
    }

    /// Takes the bytes of a command frame, and carries the command out. A plan that was received whole
    /// waits in [`Self::plans`].
    ///
    /// # Errors
    ///
    /// Why it is refused; telemetry tells it too.
    pub fn receive(
        &mut self,
        bytes: &[u8],
        robot: &mut impl Commanded,
        now: u64,
    ) -> Result<(), Refusal> {
        if let Some(kept) = self.keep_watch(bytes, robot, now) {
            return kept;
        }
        let taken = self.take(bytes, robot, now);
        self.refusal = taken.err().unwrap_or_default();
        taken
    }

    /// An order to watch that is not ahead: a sign of life if it knows the last sequence. `None` for all
    /// else.
    fn keep_watch(
        &mut self,
        bytes: &[u8],
        robot: &mut impl Commanded,
        now: u64,
    ) -> Option<Result<(), Refusal>> {
        let (Ok((Order::Watch(true), sequence)), Some(last)) =
            (command::decode(bytes, self.fingerprint), self.sequence)
        else {
            return None;
        };
        if sequence == last {
            robot.watch(true, now);
            return Some(Ok(()));
        }
        ahead(last, sequence).err().map(Err)
    }

    fn take(&mut self, bytes: &[u8], robot: &mut impl Commanded, now: u64) -> Result<(), Refusal> {
        if let Some((index, data)) = command::chunk(bytes) {
            self.sequence.ok_or(Refusal::NoSession)?;
            self.plans.chunk(index, data).map_err(|_| Refusal::Plan)?;
            robot.heard(now);
            return Ok(());
        }
        let (order, sequence) = command::decode(bytes, self.fingerprint)?;
        if self.sequenced(order, sequence)? {
            robot.heard(now);
        }
        let taken = |taken: bool, refusal| if taken { Ok(()) } else { Err(refusal) };
        match order {
            Order::Hello => Ok(()),
            Order::Ask(request) => {
                let changed = robot.request(request, now);
                let always = matches!(request, Request::EmergencyStop);
                taken(changed || always, Refusal::State)
            }
            Order::Heading(heading) if heading.is_finite() => {
                robot.aim(heading);
                Ok(())
            }
            Order::Heading(_) => Err(Refusal::Bounds),
            Order::Gain(index, value) => taken(robot.set_gain(index, value), Refusal::Bounds),
            Order::Watch(on) => {
                robot.watch(on, now);
                Ok(())
            }
            Order::PlanBegin(length) => self.plans.begin(length).map_err(|_| Refusal::Plan),
            Order::PlanEnd(checksum) => self.plans.end(checksum).map_err(|_| Refusal::Plan),
            Order::PlanForget => {
                self.plans.forget();
                Ok(())
            }
        }
    }

    /// Takes a sequence that is ahead. Stopping needs none, and anybody can replay it: false.
    fn sequenced(&mut self, order: Order, sequence: u8) -> Result<bool, Refusal> {
        match order {
            Order::Hello => {
                // A recorded hello must not reopen an old sequence: within a session it goes on.
                if let Some(last) = self.sequence {
                    ahead(last, sequence)?;
                }
            }
            Order::Ask(Request::Stop | Request::EmergencyStop) => return Ok(false),
            _ => ahead(self.sequence.ok_or(Refusal::NoSession)?, sequence)?,
        }
        self.sequence = Some(sequence);
        Ok(true)
    }
}

fn ahead(last: u8, sequence: u8) -> Result<(), Refusal> {
    let by = sequence.wrapping_sub(last);
    if (1..=AHEAD).contains(&by) { Ok(()) } else { Err(Refusal::Sequence) }
}

/// Node-ID in telemetry for "no node".
const NO_NODE: u8 = 0xFF;

const _: () = assert!(NodeId::clamped(255).raw() < NO_NODE);
