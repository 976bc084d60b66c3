//! Outputs: torques, controlwords, legs.

use super::node::NodeState;
use super::{Master, Send};
use crate::cia402::{self, Goal};
use crate::fault::Fault;
use crate::frame::Frame;
use crate::legs::LegsCommand;
use crate::table::{AxisTable, CommandTable, MAX_AXES, Role, Source, YawTable};
use crate::yaw::HeadingHold;

/// What the controller wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    forces: [f32; MAX_AXES],
}

impl Command {
    /// Generalised forces, N·m or N, in the order of the model's actuators, in the body's frame. Forces
    /// that are missing are zero.
    #[must_use]
    pub fn new(forces: &[f32]) -> Self {
        let mut own = [0.0; MAX_AXES];
        for (to, from) in own.iter_mut().zip(forces) {
            *to = *from;
        }
        Self { forces: own }
    }

    fn of(&self, axis: &AxisTable<'_>) -> f32 {
        axis.force.and_then(|force| self.forces.get(usize::from(force))).copied().unwrap_or(0.0)
    }
}

impl Master<'_> {
    /// Takes the controller's forces and sends them; drives apply them at the next SYNC.
    ///
    /// One number for each axis goes to all of its drives (Eq. 13). Where the state forbids torque, or a
    /// force is not finite, all are zero.
    pub fn command(&mut self, command: &Command, now: u64, out: &mut dyn FnMut(usize, Frame)) {
        if self.counters.cycles == 0 || self.commanded {
            return;
        }
        self.commanded = true;
        let mut forces = [0.0; MAX_AXES];
        for (to, axis) in forces.iter_mut().zip(self.table.axes) {
            *to = command.of(axis);
        }
        if let Some(yaw) = &self.table.yaw {
            self.turn(yaw, &mut forces);
        }
        if self.state.permits_torque() && !forces.iter().all(|force| force.is_finite()) {
            self.raise(Fault::NotFinite, None, now, 0);
        }
        self.step(now);
        if self.state.permits_torque() && !self.faults.has(Fault::NotFinite) {
            self.apply(&forces);
        } else {
            self.zero();
        }
        self.send_cyclic(out);
        self.send_events(out);
    }

    /// Forces that were last sent, N·m or N, by actuator, after limits and in the body's frame.
    #[must_use]
    pub fn applied(&self) -> [f32; MAX_AXES] {
        let mut axes = self.applied;
        if let Some(yaw) = &self.table.yaw {
            let [x, y] = yaw.plane.map(usize::from);
            if let (Some(&fx), Some(&fy)) = (axes.get(x), axes.get(y)) {
                let [bx, by] = self.rotation.into_body([fx, fy]);
                for (at, force) in [(x, bx), (y, by)] {
                    if let Some(place) = axes.get_mut(at) {
                        *place = force;
                    }
                }
            }
        }
        let mut forces = [0.0; MAX_AXES];
        for (axis, force) in self.table.axes.iter().zip(axes) {
            if let Some(place) = axis.force.and_then(|at| forces.get_mut(usize::from(at))) {
                *place = force;
            }
        }
        forces
    }

    /// Forces in the plane into the drive unit's frame; the heading's torque.
    fn turn(&mut self, yaw: &YawTable, forces: &mut [f32; MAX_AXES]) {
        let [x, y] = yaw.plane.map(usize::from);
        if let (Some(&fx), Some(&fy)) = (forces.get(x), forces.get(y)) {
            let [dx, dy] = self.rotation.into_drive([fx, fy]);
            for (at, force) in [(x, dx), (y, dy)] {
                if let Some(place) = forces.get_mut(at) {
                    *place = force;
                }
            }
        }
        let Some(place) = yaw.axis.and_then(|axis| forces.get_mut(usize::from(axis))) else {
            return;
        };
        let (heading, rate) = (self.measurement.heading, self.measurement.heading_rate);
        if self.state.permits_torque() {
            let hold = self.heading.get_or_insert(HeadingHold::at(heading));
            if self.state == crate::safety::State::Yawing {
                hold.aim(self.target);
            }
            let step = yaw.rate_limit * self.table.timing.period_us as f32 * 1e-6;
            *place = hold.torque(heading, rate, [yaw.stiffness, yaw.damping], step);
        } else {
            self.heading = None;
        }
    }

    /// Whether the commanded heading is reached.
    pub(super) fn has_turned(&self) -> bool {
        // Once the hold has taken the target over.
        self.heading.is_some_and(|hold| {
            hold.aims_at(self.target) && hold.has_arrived(self.measurement.heading)
        })
    }

    /// Clamp, slew, counts. An axis with a lost drive gets nothing.
    fn apply(&mut self, forces: &[f32; MAX_AXES]) {
        let seconds = self.table.timing.period_us as f32 * 1e-6;
        for (at, axis) in self.table.axes.iter().enumerate() {
            let (Some(wanted), Some(last)) =
                (forces.get(at).copied(), self.applied.get(at).copied())
            else {
                continue;
            };
            let step = axis.slew * seconds;
            let clamped = within(wanted, -axis.limit, axis.limit);
            let slewed = within(clamped, last - step, last + step);
            if slewed != wanted {
                self.counters.limited = self.counters.limited.saturating_add(1);
            }
            let lost = axis.drives.iter().any(|drive| !self.obeys(*drive));
            let force = if lost || !slewed.is_finite() { 0.0 } else { slewed };
            let limit = self.torque_limit.get(at).copied().unwrap_or(0);
            let counts = rounded(force * axis.counts_per_force).max(-limit).min(limit);
            if let (Some(place), Some(count)) = (self.applied.get_mut(at), self.counts.get_mut(at))
            {
                *place = force;
                *count = counts;
            }
        }
    }

    /// Whether a drive is alive, enabled and in its mode.
    fn obeys(&self, drive: u8) -> bool {
        let index = usize::from(drive);
        let Some(node) = self.nodes.get(index) else { return false };
        node.is_running()
            && node.missed < self.table.timing.missed_fault
            && node.drive_state == cia402::State::OperationEnabled
            && node.is_in_mode
    }

    /// No torque, from the next frame on.
    pub(super) fn zero(&mut self) {
        self.applied = [0.0; MAX_AXES];
        self.counts = [0; MAX_AXES];
    }

    /// Where drives are when they are enabled: pairs are compared from here on.
    pub(super) fn begin_enabling(&mut self) {
        for node in &mut self.nodes {
            node.origin = node.travel;
        }
        self.heading = None;
    }

    fn update_controlwords(&mut self) {
        let goal = match self.state {
            state if state.enables_drives() => Goal::Enabled,
            crate::safety::State::FaultDown => Goal::Off,
            _ => Goal::Ready,
        };
        for (node, table) in self.nodes.iter_mut().zip(self.table.nodes) {
            if table.role == Role::Drive {
                controlword(node, goal);
            }
        }
    }

    /// The frames of each cycle.
    pub(super) fn send_cyclic(&mut self, out: Send<'_>) {
        self.update_controlwords();
        for command in self.table.commands.iter().filter(|command| command.cyclic) {
            let (bytes, len) = self.content(command);
            send(command, bytes, len, out);
        }
    }

    /// Frames that are sent when their content changes, and each [`crate::REPEAT_CYCLES`] cycles: one on
    /// a bus in a cycle, but the legs' at once.
    pub(super) fn send_events(&mut self, out: Send<'_>) {
        if self.events == 0 {
            return;
        }
        let table = self.table;
        let count = table.commands.len().min(self.sent.len());
        let turn = (self.counters.cycles as usize)
            .checked_rem((crate::REPEAT_CYCLES as usize).max(count))
            .unwrap_or(0);
        let mut left = self.events;
        while left != 0 {
            let at = left.trailing_zeros() as usize;
            left &= left.wrapping_sub(1);
            let Some(command) = table.commands.get(at) else { continue };
            let (bytes, len) = self.content(command);
            let known = self.sent.get(at).copied().flatten();
            let legs = command.fields.iter().any(|field| field.source == Source::Legs);
            let changed = known != Some(bytes);
            let repeated = turn == at && self.event_budget > 0;
            if (changed && legs) || repeated || (changed && self.event_budget > 0) {
                self.event_budget = if legs && changed { self.event_budget } else { 0 };
                if let Some(place) = self.sent.get_mut(at) {
                    *place = Some(bytes);
                }
                send(command, bytes, len, out);
            }
        }
    }

    /// What a frame holds, and how much of it. What is after the eighth byte is cut off.
    #[inline(always)]
    fn content(&self, command: &CommandTable<'_>) -> ([u8; 8], u8) {
        // A word can begin at each byte of the frame. What it writes behind its field is zero.
        let (mut bytes, mut used) = ([0; 12], 0_usize);
        for field in command.fields {
            let encoded = field.kind.encode_short(self.value(field.source));
            let rest = bytes.get_mut(used..).and_then(<[u8]>::first_chunk_mut);
            let Some(place) = rest else { break };
            *place = encoded.to_le_bytes();
            used = used.saturating_add(field.kind.bytes());
        }
        (bytes.first_chunk().copied().unwrap_or_default(), used.min(8) as u8)
    }

    fn value(&self, source: Source) -> i32 {
        match source {
            Source::Zero => 0,
            Source::Controlword { node } => {
                self.nodes.get(usize::from(node)).map_or(0, |state| state.controlword.into())
            }
            Source::Mode { node } => {
                let table = self.table.nodes.get(usize::from(node));
                table.and_then(|table| table.motor.as_ref()).map_or(0, |motor| motor.mode.into())
            }
            Source::Torque { axis, sign } => {
                self.torque_counts(axis.into()).saturating_mul(sign.into())
            }
            Source::Legs => {
                let retract = self.state.retracts_legs();
                let command = if retract { LegsCommand::Retract } else { LegsCommand::Lower };
                command as i32
            }
        }
    }
}

/// The nearest integer, halves away from zero; saturates, zero for NaN.
fn rounded(value: f32) -> i32 {
    // The largest single below a half: what is added never rounds up to the next integer by itself.
    (value + libm::copysignf(0.499_999_97, value)) as i32
}

/// The nearest value between two bounds.
fn within(value: f32, low: f32, high: f32) -> f32 {
    if value < low {
        low
    } else if value > high {
        high
    } else {
        value
    }
}

fn send(command: &CommandTable<'_>, bytes: [u8; 8], len: u8, out: Send<'_>) {
    out(usize::from(command.bus), Frame::of(command.cob_id, bytes, len));
}

/// The next controlword of a drive; a fault is reset on an operator's demand alone.
fn controlword(node: &mut NodeState, goal: Goal) {
    let state = node.drive_state;
    if (state, goal) == (cia402::State::OperationEnabled, Goal::Enabled) {
        // What is nearly always so.
        node.controlword = cia402::controlword::ENABLE_OPERATION;
        node.reset_cycles = 0;
        return;
    }
    let reset = node.reset_cycles > 0 && goal != Goal::Enabled;
    node.controlword = cia402::step(state, goal, reset);
    node.reset_cycles = if state.is_fault() { node.reset_cycles.saturating_sub(1) } else { 0 };
}
