//! Boot: NMT, boot-up messages, SDO set-up, heartbeats.

use super::node::{NodeState, Phase, Verdict, request};
use super::{Master, Send, node_bit};
use crate::fault::Fault;
use crate::frame::Frame;
use crate::id;
use crate::sdo;
use crate::table::NodeTable;

/// NMT commands (CiA 301).
mod nmt {
    pub(super) const START: u8 = 0x01;
    pub(super) const RESET_NODE: u8 = 0x81;
    /// State in heartbeats: boot-up.
    pub(super) const BOOT_UP: u8 = 0x00;
    /// State in heartbeats: operational.
    pub(super) const OPERATIONAL: u8 = 0x05;
}

impl<'a> Master<'a> {
    /// One step of each node's set-up at most.
    pub(super) fn boot(&mut self, now: u64, out: Send<'_>) {
        if self.settled {
            return;
        }
        let table = self.table;
        let mut settled = true;
        for (index, node) in table.nodes.iter().enumerate() {
            let waits = |state: &&NodeState| !matches!(state.phase, Phase::Running | Phase::Failed);
            let Some(state) = self.nodes.get(index).filter(waits).copied() else { continue };
            let (phase, fault) = self.boot_step(node, &state, now, out);
            if let Some(state) = self.nodes.get_mut(index) {
                if phase == Phase::Running && state.phase != Phase::Running {
                    *state = NodeState::started(now, node);
                    self.heartbeats_due = 0;
                    if state.expected != 0 {
                        self.awaited |= node_bit(index);
                    }
                }
                state.phase = phase;
                settled &= matches!(phase, Phase::Running | Phase::Failed);
            }
            if let Some((fault, detail)) = fault {
                self.raise(fault, Some(index), now, detail);
            }
        }
        self.settled = settled;
    }

    fn boot_step(
        &self,
        node: &NodeTable<'a>,
        state: &NodeState,
        now: u64,
        out: Send<'_>,
    ) -> (Phase, Option<(Fault, u32)>) {
        let timing = &self.table.timing;
        let bus = usize::from(node.bus);
        match state.phase {
            Phase::New => {
                out(bus, Frame::new(id::NMT, &[nmt::RESET_NODE, node.id.raw()]));
                (Phase::Booting(now.saturating_add(timing.boot_timeout_us.into())), None)
            }
            Phase::Booting(until) if now > until => (Phase::Failed, Some((Fault::NoBoot, 0))),
            Phase::Next(step) => match node.setup.get(usize::from(step)) {
                Some(asked) => {
                    out(bus, request(node, asked));
                    let due = now.saturating_add(timing.sdo_timeout_us.into());
                    (Phase::Asked { step, due, tries: 0 }, None)
                }
                None => {
                    out(bus, Frame::new(id::NMT, &[nmt::START, node.id.raw()]));
                    (Phase::Running, None)
                }
            },
            Phase::Asked { step, due, tries } if now > due => {
                let Some(asked) = node.setup.get(usize::from(step)) else {
                    return (Phase::Failed, None);
                };
                if tries >= timing.sdo_retries {
                    let (crate::SdoStep::Write { object, .. }
                    | crate::SdoStep::Expect { object, .. }) = *asked;
                    out(bus, sdo::abort(node.id, object, sdo::TIMED_OUT));
                    return (Phase::Failed, Some((Fault::Setup, sdo::TIMED_OUT)));
                }
                out(bus, request(node, asked));
                let due = now.saturating_add(timing.sdo_timeout_us.into());
                (Phase::Asked { step, due, tries: tries.saturating_add(1) }, None)
            }
            phase => (phase, None),
        }
    }

    /// An SDO answer of a node.
    pub(super) fn sdo_answer(&mut self, index: usize, frame: &Frame, now: u64) {
        let (Some(node), Some(state)) = (self.table.nodes.get(index), self.nodes.get_mut(index))
        else {
            return;
        };
        let Some(answer) = sdo::answer(frame) else {
            self.counters.malformed = self.counters.malformed.saturating_add(1);
            return;
        };
        match (state.verdict(node, answer), state.phase) {
            (Verdict::Done, Phase::Asked { step, .. }) => {
                state.phase = Phase::Next(step.saturating_add(1));
            }
            (Verdict::Failed(detail), Phase::Asked { step, .. }) => {
                state.phase = Phase::Failed;
                self.failed_step = Some((index as u8, step));
                self.raise(Fault::Setup, Some(index), now, detail);
            }
            _ => self.counters.unexpected = self.counters.unexpected.saturating_add(1),
        }
    }

    /// A heartbeat or boot-up message of a node.
    pub(super) fn heartbeat(&mut self, index: usize, frame: &Frame, now: u64) {
        let Some([state_byte]) = frame.exactly::<1>() else {
            self.counters.malformed = self.counters.malformed.saturating_add(1);
            return;
        };
        let Some(state) = self.nodes.get_mut(index) else { return };
        match (state_byte, state.phase) {
            (nmt::BOOT_UP, Phase::Booting(_)) => state.phase = Phase::Next(0),
            // It was reset behind our back: also while it is set up, which then begins again.
            (nmt::BOOT_UP, Phase::Next(_) | Phase::Asked { .. }) => state.phase = Phase::Next(0),
            (nmt::BOOT_UP, Phase::Running) => {
                state.phase = Phase::Failed;
                self.awaited &= !node_bit(index);
                self.raise(Fault::Reboot, Some(index), now, 0);
            }
            (nmt::OPERATIONAL, Phase::Running) => {
                state.heard = now;
                state.operational = true;
            }
            // The heartbeat of before the start command may still be on its way.
            (other, Phase::Running) if state.operational => {
                state.phase = Phase::Failed;
                self.awaited &= !node_bit(index);
                self.raise(Fault::NotOperational, Some(index), now, other.into());
            }
            _ => {}
        }
    }

    /// Heartbeats that stopped; the master's own.
    pub(super) fn heartbeats(&mut self, now: u64, out: Send<'_>) {
        let table = self.table;
        if now > self.heartbeats_due {
            self.check_heartbeats(now);
        }
        if now >= self.next_heartbeat {
            let period = u64::from(table.timing.heartbeat_us).max(1);
            self.next_heartbeat = now.saturating_add(period);
            let frame = Frame::new(table.operator.master.heartbeat(), &[nmt::OPERATIONAL]);
            for bus in 0..table.buses.len() {
                out(bus, frame);
            }
        }
    }

    /// Nodes that were silent for too long; and until when none can be.
    fn check_heartbeats(&mut self, now: u64) {
        let mut left = u32::MAX;
        for (node, table) in self.nodes.iter().zip(self.table.nodes) {
            if node.is_running() {
                left = left.min(table.heartbeat_timeout_us.saturating_sub(node.silence(now)));
            }
        }
        if left == 0 {
            self.drop_silent(now);
        }
        self.heartbeats_due = now.saturating_add(left.into());
    }

    /// Each once, until it is heard or set up again.
    #[cold]
    fn drop_silent(&mut self, now: u64) {
        for (index, table) in self.table.nodes.iter().enumerate() {
            let Some(node) = self.nodes.get_mut(index) else { break };
            let silent = node.silence(now);
            if node.is_running() && silent > table.heartbeat_timeout_us {
                node.phase = Phase::Failed;
                self.awaited &= !node_bit(index);
                self.raise(Fault::Heartbeat, Some(index), now, silent);
            }
        }
    }

    /// Resets nodes that are not running, and the faults of drives that are.
    pub(super) fn begin_reset(&mut self) {
        self.settled = false;
        for state in &mut self.nodes {
            if state.is_running() {
                state.reset_cycles = RESET_CYCLES;
                state.missed = 0;
                state.stale = 0;
            } else {
                *state = NodeState::NEW;
            }
        }
    }
}

/// Cycles for which a fault reset is repeated.
const RESET_CYCLES: u8 = 50;
