//! A CAN controller on a bus in virtual time: queues and error counters.

use std::collections::{BTreeMap, VecDeque};

use super::Limits;
use crate::bits::arbitration;
use crate::{BusError, ErrorState, Frame, Health, Received};

/// A frame that waits for the bus.
#[derive(Clone, Debug)]
pub(super) struct Pending {
    pub(super) frame: Frame,
    /// Earliest start, ns.
    pub(super) release: u64,
    /// Tries so far that ended in an error.
    pub(super) errors: u32,
    /// It was delivered, and is on its way once more.
    repeated: bool,
}

/// Place in a controller's transmit queue: by arbitration, then in the order of sending.
pub(super) type Ticket = (u64, u64);

/// Occurrences of eleven recessive bits that a controller waits for after bus-off.
const RECOVERY_SEQUENCES: u64 = 128;

#[derive(Clone, Debug)]
pub(super) struct Endpoint {
    pub(super) name: String,
    waiting: BTreeMap<Ticket, Pending>,
    tickets: u64,
    received: VecDeque<Received>,
    /// A frame that is handed over after the next one.
    pub(super) held: Option<Received>,
    transmit_errors: u32,
    receive_errors: u32,
    bus_off: bool,
    recovery: u64,
    /// End of the pause of an error-passive sender, ns.
    pub(super) suspended_until: u64,
    overruns: u64,
    limits: Limits,
}

impl Endpoint {
    pub(super) fn new(name: &str, limits: Limits) -> Self {
        Self {
            name: name.to_owned(),
            waiting: BTreeMap::new(),
            tickets: 0,
            received: VecDeque::new(),
            held: None,
            transmit_errors: 0,
            receive_errors: 0,
            bus_off: false,
            recovery: 0,
            suspended_until: 0,
            overruns: 0,
            limits,
        }
    }

    pub(super) fn health(&self) -> Health {
        let passive = self.transmit_errors >= 128 || self.receive_errors >= 128;
        let state = match (self.bus_off, passive) {
            (true, _) => ErrorState::BusOff,
            (false, true) => ErrorState::Passive,
            (false, false) => ErrorState::Active,
        };
        Health {
            state,
            transmit_errors: self.transmit_errors,
            receive_errors: self.receive_errors,
            overruns: self.overruns,
        }
    }

    pub(super) const fn is_off(&self) -> bool {
        self.bus_off
    }

    pub(super) fn queue(&mut self, frame: Frame, release: u64) -> Result<(), BusError> {
        if self.bus_off {
            return Err(BusError::BusOff);
        }
        if self.waiting.len() >= self.limits.transmit {
            return Err(BusError::QueueFull { waiting: self.waiting.len() });
        }
        let ticket = (arbitration(&frame), self.tickets);
        self.tickets += 1;
        self.waiting.insert(ticket, Pending { frame, release, errors: 0, repeated: false });
        Ok(())
    }

    /// Earliest time at which this controller could start a frame, ns.
    pub(super) fn earliest(&self) -> Option<u64> {
        let release = self.waiting.values().map(|pending| pending.release).min()?;
        Some(release.max(self.suspended_until))
    }

    /// The frame that this controller puts forward at `start`.
    pub(super) fn candidate(&self, start: u64) -> Option<(Ticket, Frame)> {
        if self.bus_off || self.suspended_until > start {
            return None;
        }
        let mut ready = self.waiting.iter().filter(|(_, pending)| pending.release <= start);
        ready.next().map(|(ticket, pending)| (*ticket, pending.frame))
    }

    pub(super) fn sent(&mut self, ticket: Ticket) {
        self.waiting.remove(&ticket);
        self.transmit_errors = self.transmit_errors.saturating_sub(1);
    }

    /// Whether a frame is still to be repeated: true once.
    pub(super) fn repeat(&mut self, ticket: Ticket) -> bool {
        let pending = self.waiting.get_mut(&ticket);
        pending.is_some_and(|pending| !std::mem::replace(&mut pending.repeated, true))
    }

    /// Counts an error as sender; true if the controller went bus-off by it.
    ///
    /// An error-passive sender that only misses the acknowledgement does not count (ISO 11898-1,
    /// exception 1), so a node alone on a bus stays error-passive.
    pub(super) fn failed(&mut self, ticket: Ticket, unacknowledged: bool) -> bool {
        if let Some(pending) = self.waiting.get_mut(&ticket) {
            pending.errors = pending.errors.saturating_add(1);
        }
        if !(unacknowledged && self.transmit_errors >= 128) {
            self.transmit_errors += 8;
        }
        if self.transmit_errors < 256 {
            return false;
        }
        self.switch_off();
        true
    }

    pub(super) fn switch_off(&mut self) {
        self.bus_off = true;
        self.recovery = 0;
        self.waiting.clear();
    }

    pub(super) fn receive_failed(&mut self) {
        self.receive_errors = (self.receive_errors + 1).min(255);
    }

    /// Counts a frame that was received without error.
    pub(super) const fn receive_succeeded(&mut self) {
        // Above 127 the counter goes to a value between 119 and 127.
        let errors = self.receive_errors;
        self.receive_errors = if errors > 127 { 127 } else { errors.saturating_sub(1) };
    }

    pub(super) fn deliver(&mut self, received: Received) {
        self.store(received);
        if let Some(held) = self.held.take() {
            self.store(Received { time: received.time, ..held });
        }
    }

    fn store(&mut self, received: Received) {
        if self.received.len() >= self.limits.receive {
            self.overruns += 1;
        } else {
            self.received.push_back(received);
        }
    }

    pub(super) fn take(&mut self) -> Option<Received> {
        self.received.pop_front()
    }

    /// Whether frames wait to be taken by [`Endpoint::take`].
    pub(super) fn has_received(&self) -> bool {
        !self.received.is_empty()
    }

    /// Counts sequences of eleven recessive bits after bus-off; true when the controller comes back.
    pub(super) fn recover(&mut self, sequences: u64) -> bool {
        if !self.bus_off || !self.limits.recover {
            return false;
        }
        self.recovery = self.recovery.saturating_add(sequences);
        if self.recovery < RECOVERY_SEQUENCES {
            return false;
        }
        self.restart();
        true
    }

    /// Sequences of eleven recessive bits that are left to wait for; `None` if this controller is not
    /// about to recover.
    pub(super) const fn to_recover(&self) -> Option<u64> {
        if self.bus_off && self.limits.recover {
            Some(RECOVERY_SEQUENCES.saturating_sub(self.recovery))
        } else {
            None
        }
    }

    pub(super) const fn restart(&mut self) {
        self.bus_off = false;
        self.transmit_errors = 0;
        self.receive_errors = 0;
    }

    pub(super) fn waiting(&self) -> usize {
        self.waiting.len()
    }
}
