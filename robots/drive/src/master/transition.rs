//! From fault to fault and from state to state.

use super::Master;
use super::node::NodeState;
use crate::fault::{Fault, FaultRecord};
use crate::legs::LegsState;
use crate::safety::{Inputs, State};
use crate::table::Role;

impl Master<'_> {
    pub(super) fn raise(&mut self, fault: Fault, node: Option<usize>, now: u64, detail: u32) {
        let node = node.and_then(|node| u8::try_from(node).ok());
        self.faults.add(FaultRecord { fault, node, at_us: now, detail });
        self.raised = true;
        if fault.prevents_balance() && node.is_none_or(|node| self.is_essential(node)) {
            self.faults.prevent_balance();
        }
    }

    /// Whether the robot falls without this node: a sensor of lean, or a drive that balances.
    pub(super) fn is_essential(&self, node: u8) -> bool {
        let Some(table) = self.table.nodes.get(usize::from(node)) else { return true };
        match (table.role, table.motor) {
            (Role::Imu, _) => true,
            (_, Some(motor)) => {
                self.table.axes.get(usize::from(motor.axis)).is_none_or(|axis| axis.balances)
            }
            _ => false,
        }
    }

    /// One step of the safety logic.
    pub(super) fn step(&mut self, now: u64) {
        self.raised = false;
        if self.request.is_none() && !self.faults.any() && !self.finished && self.state.lasts() {
            return;
        }
        let inputs = self.safety_inputs(now);
        let next = self.state.next(&inputs);
        self.request = None;
        if next == self.state {
            return;
        }
        if next == State::Off {
            self.faults.clear();
            self.failed_step = None;
            self.begin_reset();
        }
        if next == State::FaultLowering && !self.faults.any() {
            self.raise(Fault::Deadline, None, now, self.state as u32);
        }
        if next == State::FaultDown && !self.faults.any() {
            self.raise(
                if inputs.late { Fault::Deadline } else { Fault::NotEnabled },
                None,
                now,
                self.state as u32,
            );
        }
        if next == State::Enabling {
            self.begin_enabling();
        }
        if !next.permits_torque() {
            self.zero();
        }
        self.state = next;
        self.entered = now;
        self.finished = false;
    }

    pub(super) fn safety_inputs(&self, now: u64) -> Inputs {
        let all = |test: &dyn Fn(usize, &NodeState) -> bool| {
            (0..)
                .zip(&self.nodes)
                .take(self.table.nodes.len())
                .all(|(index, node)| test(index, node))
        };
        // What a state does not look at is not computed: this is done several times in a cycle.
        let starts = matches!(self.state, State::Off | State::LegsDown);
        let enables = self.state == State::Enabling;
        let is_ready = |index: usize, node: &NodeState| {
            let table = self.table.nodes.get(index);
            table.is_some_and(|table| node.is_ready(table))
        };
        let is_enabled = |index: usize, node: &NodeState| {
            let table = self.table.nodes.get(index);
            table.is_none_or(|table| {
                table.role != Role::Drive
                    || node.drive_state == crate::cia402::State::OperationEnabled && node.is_in_mode
            })
        };
        let legs = self.legs();
        let absent = self.legs.is_none();
        Inputs {
            request: self.request,
            ready: starts && all(&is_ready),
            enabled: enables && all(&is_enabled),
            fault: self.faults.any(),
            can_balance: !self.faults.prevents_balance(),
            upright: (starts || enables) && self.is_upright(),
            legs_down: absent || legs.is_some_and(LegsState::is_down),
            legs_up: absent || legs.is_some_and(LegsState::is_up),
            late: self
                .deadline()
                .is_some_and(|limit| now.saturating_sub(self.entered) > limit.into()),
            finished: self.finished || self.state == State::Yawing && self.has_turned(),
            plan_ready: self.plan_ready,
        }
    }

    /// How long the state may last, µs.
    pub(super) fn deadline(&self) -> Option<u32> {
        let safety = &self.table.safety;
        match self.state {
            State::Enabling => Some(self.table.timing.enable_timeout_us),
            State::Rising => Some(safety.rise_timeout_us),
            State::LegsLowering => Some(safety.lower_timeout_us),
            State::FaultLowering => Some(safety.fault_deadline_us),
            _ => None,
        }
    }
}
