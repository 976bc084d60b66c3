//! Orders that are waited for.

use crate::{Error, Link, Telemetry};
use shapebot_drive::crc::crc32;
use shapebot_drive::operator::command::{CHUNK, encode, encode_chunk};
use shapebot_drive::operator::{Order, Refusal};
use shapebot_drive::safety::Request;
use std::time::{Duration, Instant};

/// How long a command may take to be confirmed.
const PATIENCE: Duration = Duration::from_millis(1500);

/// How often a command is tried that another operator's command comes before.
const RETRIES: u32 = 5;

/// Parts of a plan between two looks at the telemetry, where the link itself holds back who sends too fast.
const PARTS: u32 = 64;

/// How long such a look takes.
const BREATH: Duration = Duration::from_millis(1);

/// An operator of a robot.
#[derive(Debug)]
pub struct Client<L> {
    link: L,
    fingerprint: u32,
    /// The last sequence used.
    sequence: Option<u8>,
    telemetry: Telemetry,
}

impl<L: Link> Client<L> {
    /// For the drive with this fingerprint.
    pub fn new(link: L, fingerprint: u32) -> Self {
        Self { link, fingerprint, sequence: None, telemetry: Telemetry::default() }
    }

    /// What the robot said last.
    pub const fn telemetry(&self) -> &Telemetry {
        &self.telemetry
    }

    /// Takes telemetry for a while; whether any came.
    ///
    /// # Errors
    ///
    /// Of the link.
    pub fn listen(&mut self, time: Duration) -> Result<bool, Error> {
        let (end, before) = (Instant::now() + time, self.telemetry.pages);
        loop {
            let rest = end.saturating_duration_since(Instant::now());
            match self.link.receive(rest)? {
                Some(bytes) => self.telemetry.take(&bytes),
                None => return Ok(self.telemetry.pages > before),
            };
        }
    }

    /// Gives an order and waits until the robot has taken it. The first order begins a session.
    ///
    /// Stop and emergency stop are sent at once, three times, without a session.
    ///
    /// # Errors
    ///
    /// [`Error::Refused`], [`Error::Silent`], [`Error::NotTaken`]; those of the link.
    pub fn order(&mut self, order: Order) -> Result<(), Error> {
        if let Order::Ask(Request::Stop | Request::EmergencyStop) = order {
            for _ in 0..3 {
                self.link.send(&encode(order, 0, self.fingerprint))?;
            }
            return Ok(());
        }
        for _ in 0..RETRIES {
            if self.sequence.is_none() {
                self.begin()?;
            }
            match self.sequenced(order) {
                // Another operator was faster: ahead of that one's command.
                Err(Error::Refused(Refusal::Sequence)) => self.sequence = None,
                done => return done,
            }
        }
        Err(Error::Refused(Refusal::Sequence))
    }

    /// Repeats [`Order::Watch`] without waiting, with the sequence of the last command that the robot tells
    /// of: other operators may have given it.
    ///
    /// # Errors
    ///
    /// Those of the link.
    pub fn keep_watch(&mut self) -> Result<(), Error> {
        let Some(status) = self.telemetry.status else { return Ok(()) };
        self.link.send(&encode(Order::Watch(true), status.sequence, self.fingerprint))
    }

    /// Sends a plan file, to be followed at the next `track`.
    ///
    /// # Errors
    ///
    /// Those of [`Self::order`].
    pub fn upload(&mut self, file: &[u8], progress: &mut dyn FnMut(usize)) -> Result<(), Error> {
        let length = u32::try_from(file.len()).map_err(|_| Error::Refused(Refusal::Plan))?;
        self.order(Order::PlanBegin(length))?;
        for (index, part) in (0_u32..).zip(file.chunks(CHUNK)) {
            self.link.send(&encode_chunk(index, part))?;
            let pace = self.link.pace();
            if !pace.is_zero() {
                self.listen(pace)?;
            } else if index.is_multiple_of(PARTS) {
                self.listen(BREATH)?;
            }
            progress((index as usize + 1) * CHUNK);
        }
        self.order(Order::PlanEnd(crc32(file)))
    }

    /// Begins a session ahead of the last one, whose sequence the robot tells.
    fn begin(&mut self) -> Result<(), Error> {
        let last = self.next_status()?.sequence;
        self.sequence = Some(last);
        self.sequenced(Order::Hello)
    }

    fn sequenced(&mut self, order: Order) -> Result<(), Error> {
        let sequence = self.sequence.unwrap_or_default().wrapping_add(1);
        self.sequence = Some(sequence);
        self.link.send(&encode(order, sequence, self.fingerprint))?;
        let end = Instant::now() + PATIENCE;
        // What is on its way was said before the command came.
        let mut last = self.next_status()?;
        while last.sequence != sequence {
            if Instant::now() >= end {
                return Err(refused(last.refusal).unwrap_or(Error::NotTaken(millis(PATIENCE))));
            }
            last = self.next_status()?;
        }
        refused(last.refusal).map_or(Ok(()), Err)
    }

    fn next_status(&mut self) -> Result<crate::Status, Error> {
        self.telemetry.status = None;
        let end = Instant::now() + PATIENCE;
        loop {
            let rest = end.saturating_duration_since(Instant::now());
            let Some(bytes) = self.link.receive(rest)? else {
                return Err(Error::Silent(millis(PATIENCE)));
            };
            self.telemetry.take(&bytes);
            if let Some(status) = self.telemetry.status {
                return Ok(status);
            }
        }
    }
}

fn millis(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

fn refused(number: u8) -> Option<Error> {
    let all = [
        Refusal::Length,
        Refusal::Checksum,
        Refusal::Opcode,
        Refusal::NoSession,
        Refusal::Sequence,
        Refusal::State,
        Refusal::Bounds,
        Refusal::Plan,
    ];
    all.into_iter().find(|refusal| *refusal as u8 == number).map(Error::Refused)
}
