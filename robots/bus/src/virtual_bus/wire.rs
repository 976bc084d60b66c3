//! What goes on between start of frame and end of frame.

use super::endpoint::Ticket;
use super::faults::{Effect, Stage};
use super::{EndpointId, EventKind, LATE_LIMIT, VirtualBus};
use crate::bits::{
    ERROR_FRAME_BITS, INTERMISSION_BITS, arbitration, first_difference, frame_bits, stuff_bits,
};
use crate::{ErrorState, Frame, Received};

/// Bits that an error-passive sender waits after a frame before it may send again.
const SUSPEND_BITS: u64 = 8;

/// Recessive bits of ACK delimiter, end of frame and intermission: one sequence for recovery.
const SEQUENCE_BITS: u64 = 11;

/// How a transmission ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    Delivered,
    /// Delivered, and to be sent once more.
    Repeated,
    Error,
    /// No other controller was there to acknowledge.
    Unacknowledged,
}

/// A frame on the wire.
#[derive(Clone, Debug)]
pub(super) struct Transmission {
    /// The controllers that send it: more than one if they send the same identifier at once.
    senders: Vec<(EndpointId, Ticket)>,
    frame: Frame,
    start: u64,
    /// End of frame, or of the error frame, ns.
    pub(super) end: u64,
    outcome: Outcome,
}

impl VirtualBus {
    /// When the next frame can start, ns, while none is on the wire.
    pub(super) fn next_start(&self) -> Option<u64> {
        let ready = self.endpoints.iter().filter(|endpoint| !endpoint.is_off());
        let earliest = ready.filter_map(super::Endpoint::earliest).min()?;
        Some(earliest.max(self.idle_at).max(self.now))
    }

    /// Arbitration at `start`, ns: decides who sends and how it will end.
    pub(super) fn begin(&mut self, start: u64) {
        self.count_recessive(start);
        let ids = (0..self.endpoints.len()).map(EndpointId);
        let contenders: Vec<_> = ids
            .zip(&self.endpoints)
            .filter_map(|(id, endpoint)| endpoint.candidate(start).map(|(t, f)| (id, t, f)))
            .collect();
        let Some(best) = contenders.iter().map(|(_, _, frame)| arbitration(frame)).min() else {
            return;
        };
        let winners: Vec<_> =
            contenders.into_iter().filter(|(_, _, frame)| arbitration(frame) == best).collect();
        let Some(&(first, _, frame)) = winners.first() else { return };
        let others = winners.iter().skip(1);
        let difference = others.filter_map(|(_, _, other)| first_difference(&frame, other)).min();
        let senders: Vec<_> = winners.iter().map(|(id, ticket, _)| (*id, *ticket)).collect();
        let (outcome, bits) = self.outcome(&frame, first, senders.len(), difference);
        let end = start + u64::from(bits) * self.bit_ns;
        self.current = Some(Transmission { senders, frame, start, end, outcome });
    }

    /// How a frame ends and how many bits it takes up to there.
    fn outcome(
        &mut self,
        frame: &Frame,
        from: EndpointId,
        senders: usize,
        difference: Option<u32>,
    ) -> (Outcome, u32) {
        let whole = frame_bits(frame);
        if let Some(bit) = difference {
            return (Outcome::Error, bit + 1 + ERROR_FRAME_BITS);
        }
        let present = self.endpoints.iter().filter(|endpoint| !endpoint.is_off()).count();
        if present <= senders {
            // The ACK slot is the second of the ten bits after the CRC.
            return (Outcome::Unacknowledged, whole - 8 + ERROR_FRAME_BITS);
        }
        let now = self.now();
        let effects = self.faults.effects(Stage::Wire, frame, from, now);
        if effects.contains(&Effect::Corrupt) {
            // Anywhere after arbitration: a change before would be another identifier.
            let first = if frame.standard_id().is_some() { 15 } else { 35 } + stuff_bits(frame) / 4;
            let span = u64::from(whole.saturating_sub(first + 1));
            let bit = first + u32::try_from(self.faults.random.below(span)).unwrap_or(0);
            return (Outcome::Error, bit + 1 + ERROR_FRAME_BITS);
        }
        if effects.contains(&Effect::Duplicate) {
            return (Outcome::Repeated, whole);
        }
        (Outcome::Delivered, whole)
    }

    /// Counts, delivers and reports what a transmission came to.
    pub(super) fn finish(&mut self, transmission: Transmission) {
        let Transmission { senders, frame, start, end, outcome } = transmission;
        self.idle_at = end + u64::from(INTERMISSION_BITS) * self.bit_ns;
        self.busy += self.idle_at - start;
        self.counted_to = self.idle_at;
        match outcome {
            Outcome::Delivered | Outcome::Repeated => self.succeed(&senders, frame, outcome),
            Outcome::Error => self.fail(&senders, frame, false),
            Outcome::Unacknowledged => self.fail(&senders, frame, true),
        }
        self.recover(1);
        let pause = self.idle_at + SUSPEND_BITS * self.bit_ns;
        for (id, _) in &senders {
            if let Some(sender) = self.endpoints.get_mut(id.0)
                && sender.health().state == ErrorState::Passive
            {
                sender.suspended_until = pause;
            }
        }
    }

    fn succeed(&mut self, senders: &[(EndpointId, Ticket)], frame: Frame, outcome: Outcome) {
        for (id, ticket) in senders {
            if let Some(endpoint) = self.endpoints.get_mut(id.0)
                && !(outcome == Outcome::Repeated && endpoint.repeat(*ticket))
            {
                endpoint.sent(*ticket);
            }
        }
        let Some(&(from, _)) = senders.first() else { return };
        self.report(EventKind::Frame { from, frame });
        let is_sender = |id: EndpointId| senders.iter().any(|(sender, _)| *sender == id);
        for index in 0..self.endpoints.len() {
            let id = EndpointId(index);
            let off = self.endpoints.get(index).is_none_or(super::Endpoint::is_off);
            if !off && !is_sender(id) {
                self.hand_over(from, id, frame);
            }
        }
    }

    /// Gives a frame to a receiver, or what injected faults make of it.
    fn hand_over(&mut self, from: EndpointId, to: EndpointId, frame: Frame) {
        let time = self.now();
        let mut received = Received { frame, time };
        let (mut delay, mut hold) = (0, false);
        for effect in self.faults.effects(Stage::Receiver(to), &frame, from, time) {
            match effect {
                Effect::Drop => return,
                Effect::Delay(by) => delay += by.saturating_mul(1000),
                Effect::Reorder => hold = true,
                Effect::Alter(mask) => received.frame = altered(&received.frame, mask),
                Effect::Duplicate | Effect::Corrupt | Effect::Jitter(_) => {}
            }
        }
        if delay > 0 && self.late.len() < LATE_LIMIT {
            self.deliveries += 1;
            self.late.insert((self.now + delay, self.deliveries), (to, received));
            return;
        }
        if let Some(endpoint) = self.endpoints.get_mut(to.0) {
            endpoint.receive_succeeded();
            if hold && endpoint.held.is_none() {
                endpoint.held = Some(received);
            } else {
                endpoint.deliver(received);
            }
        }
    }

    fn fail(&mut self, senders: &[(EndpointId, Ticket)], frame: Frame, unacknowledged: bool) {
        let Some(&(from, _)) = senders.first() else { return };
        self.report(EventKind::Error { from, frame });
        let mut off = Vec::new();
        for (index, endpoint) in self.endpoints.iter_mut().enumerate() {
            let id = EndpointId(index);
            match senders.iter().find(|(sender, _)| *sender == id) {
                Some((_, ticket)) if endpoint.failed(*ticket, unacknowledged) => off.push(id),
                Some(_) => {}
                None => endpoint.receive_failed(),
            }
        }
        for id in off {
            self.report(EventKind::BusOff(id));
        }
    }

    /// Counts the idle bits up to `time`, ns, for controllers that recover from bus-off.
    pub(super) fn count_recessive(&mut self, time: u64) {
        let sequences = time.saturating_sub(self.counted_to) / (SEQUENCE_BITS * self.bit_ns);
        if sequences > 0 {
            self.counted_to += sequences * SEQUENCE_BITS * self.bit_ns;
            self.recover(sequences);
        }
    }

    /// When a controller will be back if the bus stays idle, ns.
    pub(super) fn next_recovery(&self) -> Option<u64> {
        let fewest = self.endpoints.iter().filter_map(super::Endpoint::to_recover).min()?;
        Some(self.counted_to + fewest * SEQUENCE_BITS * self.bit_ns)
    }

    fn recover(&mut self, sequences: u64) {
        for index in 0..self.endpoints.len() {
            if self.endpoints.get_mut(index).is_some_and(|endpoint| endpoint.recover(sequences)) {
                self.report(EventKind::Recovered(EndpointId(index)));
            }
        }
    }
}

/// A frame with its data changed by a mask.
fn altered(frame: &Frame, mask: [u8; 8]) -> Frame {
    let bytes: Vec<u8> = frame.bytes().iter().zip(mask).map(|(byte, bits)| byte ^ bits).collect();
    if frame.is_remote() { *frame } else { Frame::checked(frame.id(), &bytes).unwrap_or(*frame) }
}
