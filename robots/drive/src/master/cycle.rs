//! The cycle: SYNC, and what was missing since the last.

use super::node::NodeState;
use super::{Master, Send, node_bit};
use crate::cia402;
use crate::fault::Fault;
use crate::frame::Frame;
use crate::id::SYNC;
use crate::safety::State;
use crate::table::{NodeTable, Role};

impl Master<'_> {
    /// Ends the cycle before and begins the next with SYNC.
    pub(super) fn begin_cycle(&mut self, now: u64, out: Send<'_>) {
        let timing = &self.table.timing;
        let late = now.saturating_sub(self.next_sync);
        let period = u64::from(timing.period_us).max(1);
        let late_us = u32::try_from(late).unwrap_or(u32::MAX);
        self.jitter.add(late_us);
        if late_us > timing.jitter_limit_us && self.state != State::Off {
            self.raise(Fault::SyncJitter, None, now, late_us);
        }
        if self.counters.cycles > 0 {
            self.end_cycle(now, out);
        }
        for bus in 0..self.table.buses.len() {
            out(bus, Frame::new(SYNC, &[]));
        }
        self.counters.cycles = self.counters.cycles.saturating_add(1);
        self.last_sync = now;
        self.next_sync = self.next_sync.saturating_add(period);
        if self.next_sync <= now {
            let skipped = u32::try_from(late.checked_div(period).unwrap_or(0)).unwrap_or(u32::MAX);
            self.counters.skipped = self.counters.skipped.saturating_add(skipped);
            self.next_sync = now.saturating_add(period);
        }
        let (mut awaited, mut bit) = (0, node_bit(0));
        for node in self.nodes.iter_mut().take(self.table.nodes.len()) {
            node.received = 0;
            if node.is_running() && node.expected != 0 {
                awaited |= bit;
            }
            bit <<= 1;
        }
        self.awaited = awaited;
        self.synchronised = awaited;
        self.taken = false;
        self.commanded = false;
        self.event_budget = 1;
    }

    /// Missing inputs, a silent controller.
    fn end_cycle(&mut self, now: u64, out: Send<'_>) {
        self.take_inputs(now);
        self.count_missed(now);
        if self.commanded {
            self.silent = 0;
        } else {
            self.counters.silent = self.counters.silent.saturating_add(1);
            self.silent = self.silent.saturating_add(1);
            if self.silent >= self.table.safety.silent_fault && self.state.permits_torque() {
                self.raise(Fault::ControllerSilent, None, now, self.silent.into());
            }
            self.step(now);
            // The torques of before, or zero if the state forbids them.
            self.send_cyclic(out);
        }
    }

    fn count_missed(&mut self, now: u64) {
        let (warning, limit) = (self.table.timing.missed_warning, self.table.timing.missed_fault);
        let late = self.awaited & self.synchronised;
        if late == 0 && !self.missing {
            return;
        }
        self.missing = late != 0;
        for index in 0..self.table.nodes.len() {
            let Some(state) = self.nodes.get_mut(index) else { continue };
            if late & node_bit(index) == 0 {
                state.missed = 0;
                continue;
            }
            state.missed = state.missed.saturating_add(1);
            let missed = state.missed;
            self.counters.missed = self.counters.missed.saturating_add(1);
            if missed == warning {
                self.counters.warnings = self.counters.warnings.saturating_add(1);
            }
            if missed == limit && self.state != State::Off {
                self.raise(Fault::MissedInputs, Some(index), now, missed.into());
            }
        }
    }

    /// Statusword and mode of each drive, sensors, legs.
    pub(super) fn check_nodes(&mut self, now: u64) {
        if matches!(self.state, State::Off | State::FaultDown) {
            return;
        }
        let mut suspects = 0;
        let mut bit = node_bit(0);
        for node in self.nodes.iter().take(self.table.nodes.len()) {
            suspects |= if node.is_suspect() { bit } else { 0 };
            bit <<= 1;
        }
        while suspects != 0 {
            let index = suspects.trailing_zeros() as usize;
            suspects &= suspects.wrapping_sub(1);
            let (Some(table), Some(node)) = (self.table.nodes.get(index), self.nodes.get(index))
            else {
                break;
            };
            let [first, second] = self.complaints(table, node);
            for (fault, detail) in first.into_iter().chain(second) {
                self.raise(fault, Some(index), now, detail);
            }
        }
        self.check_pairs(now);
        self.check_lean(now);
    }

    /// What is wrong with a running node.
    fn complaints(&self, table: &NodeTable<'_>, node: &NodeState) -> [Option<(Fault, u32)>; 2] {
        match table.role {
            Role::Drive if node.received != 0 => {
                let state = node.drive_state;
                let word = u32::from(node.statusword);
                let enabled = state == cia402::State::OperationEnabled;
                let power = if state.is_fault() || node.error_register & 1 != 0 {
                    Some((Fault::DriveFault, word))
                } else {
                    (self.state.permits_torque() && !enabled).then_some((Fault::NotEnabled, word))
                };
                let mode = node.mode as u8 as u32;
                [power, (!node.is_in_mode).then_some((Fault::WrongMode, mode))]
            }
            Role::Drive => [None; 2],
            Role::Imu | Role::Encoder => {
                let (health, stale) = (node.health, node.stale);
                let limit = self.table.safety.stale_fault;
                [
                    (health != 0).then_some((Fault::SensorUnhealthy, health.into())),
                    (stale >= limit).then_some((Fault::SensorStale, stale.into())),
                ]
            }
            Role::Legs => {
                let faulty = node.legs.filter(|legs| legs.is_faulty());
                [faulty.map(|legs| (Fault::Legs, legs.0.into())), None]
            }
        }
    }

    /// Drives of one axis go the same way.
    fn check_pairs(&mut self, now: u64) {
        if !self.state.permits_torque() {
            return;
        }
        for axis in self.table.axes {
            let [lead, others @ ..] = axis.drives else { continue };
            if others.is_empty() {
                continue;
            }
            let Some(lead) = self.nodes.get(usize::from(*lead)) else { continue };
            let apart = |drive: &&u8| {
                let node = self.nodes.get(usize::from(**drive));
                node.is_some_and(|node| lead.apart(node) > axis.pair_tolerance)
            };
            if let Some(drive) = others.iter().find(apart) {
                self.raise(Fault::PairDisagrees, Some(usize::from(*drive)), now, 0);
            }
        }
    }

    fn check_lean(&mut self, now: u64) {
        if !self.state.permits_torque() {
            return;
        }
        let limit = self.table.safety.lean_limit;
        for lean in self.table.safety.lean {
            let value: f32 = self.measurement.way(usize::from(*lean), 0);
            if libm::fabsf(value) > limit {
                self.raise(Fault::Lean, None, now, (*lean).into());
            }
        }
    }

    /// An emergency message of a node; error code zero says that an error is gone.
    pub(super) fn emergency(&mut self, index: usize, frame: &Frame, now: u64) {
        let Some([low, high, register, ..]) = frame.exactly::<8>() else {
            self.counters.malformed = self.counters.malformed.saturating_add(1);
            return;
        };
        let code = u16::from_le_bytes([low, high]);
        if code != 0 && !matches!(self.state, State::Off | State::FaultDown) {
            let detail = u32::from(register) << 16 | u32::from(code);
            self.raise(Fault::Emergency, Some(index), now, detail);
        }
    }
}
