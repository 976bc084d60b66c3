//! Outputs: torques, controlwords, legs.

use super::node::NodeState;
use super::{Master, Send};
use crate::cia402::{self, Goal};
use crate::fault::Fault;
use crate::frame::Frame;
use crate::legs::LegsCommand;
use crate::table::{AxisTable, CommandTable, MAX_AXES, MAX_NODES, Role, Source, YawTable};
use crate::yaw::HeadingHold;

/// Straight-line code that fills the bytes of one frame, in their order; what is behind them is zero.
///
/// `shapebot-drive-build` writes one for each frame of the master; without one the master goes through
/// the frame's fields, with the same result.
pub type Writer = fn(&Outputs<'_>) -> [u8; 8];

/// What the master puts into its frames: see [`Source`] for each.
#[derive(Clone, Copy, Debug)]
pub struct Outputs<'m> {
    nodes: &'m [NodeState; MAX_NODES],
    counts: &'m [i32; MAX_AXES],
    legs: LegsCommand,
}

impl Outputs<'_> {
    /// [`Source::Controlword`] of a node, by its index.
    #[inline(always)]
    #[must_use]
    pub fn controlword(&self, node: usize) -> u16 {
        self.nodes.get(node).map_or(0, |state| state.controlword)
    }

    /// [`Source::Torque`] of an axis, by its index: counts of each drive's torque object.
    #[inline(always)]
    #[must_use]
    pub fn torque(&self, axis: usize) -> i32 {
        self.counts.get(axis).copied().unwrap_or(0)
    }

    /// [`Source::Legs`].
    #[inline(always)]
    #[must_use]
    pub fn legs_command(&self) -> u8 {
        self.legs as u8
    }
}

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

    /// The same of as many forces as there may be.
    #[inline(always)]
    #[must_use]
    pub const fn from_forces(forces: [f32; MAX_AXES]) -> Self {
        Self { forces }
    }

    fn of(&self, axis: &AxisTable<'_>) -> f32 {
        axis.force.and_then(|force| self.forces.get(usize::from(force))).copied().unwrap_or(0.0)
    }
}

impl Master<'_> {
    /// Takes the controller's forces and sends them; drives apply them at the next SYNC.
    ///
    /// One number for each axis goes to all of its drives (Eq. 13). Where the state forbids torque, or a
    /// force is not finite, all are zero; so are forces that were given in such a state, though this call
    /// may leave it.
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
        let meant = self.state.permits_torque();
        if meant && !forces.iter().all(|force| force.is_finite()) {
            self.raise(Fault::NotFinite, None, now, 0);
        }
        self.step(now);
        if meant && self.state.permits_torque() && !self.faults.has(Fault::NotFinite) {
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
        let missed_fault = self.table.timing.missed_fault;
        let (axes, nodes) = (self.table.axes.iter().zip(&self.torque_limit), &self.nodes);
        let outputs = self.applied.iter_mut().zip(&mut self.counts);
        for (((axis, limit), wanted), (applied, counts)) in axes.zip(forces).zip(outputs) {
            let step = axis.slew * seconds;
            let clamped = within(*wanted, -axis.limit, axis.limit);
            let slewed = within(clamped, *applied - step, *applied + step);
            if slewed != *wanted {
                self.counters.limited = self.counters.limited.saturating_add(1);
            }
            let obeys = |drive: &u8| {
                nodes.get(usize::from(*drive)).is_some_and(|node| node.obeys(missed_fault))
            };
            let obeyed = axis.drives.iter().all(obeys) && slewed.is_finite();
            *applied = if obeyed { slewed } else { 0.0 };
            *counts = rounded(*applied * axis.counts_per_force).max(-*limit).min(*limit);
        }
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
        let outputs = self.outputs();
        for (command, len) in self.table.commands.iter().zip(&self.lengths) {
            if command.cyclic {
                send(command, self.content(command, &outputs), *len, out);
            }
        }
    }

    /// Frames that are sent when their content changes, and each [`crate::REPEAT_CYCLES`] cycles: one on
    /// a bus in a cycle, but the legs' at once.
    pub(super) fn send_events(&mut self, out: Send<'_>) {
        self.events_seen = (self.state, self.counters.cycles);
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
            let (Some(command), Some(len)) = (table.commands.get(at), self.lengths.get(at)) else {
                continue;
            };
            let bytes = self.content(command, &self.outputs());
            let changed = self.sent.get(at).copied().flatten() != Some(bytes);
            let may = self.event_budget > 0;
            let due = changed || may && turn == at;
            if !due {
                continue;
            }
            let legs = command.fields.iter().any(|field| field.source == Source::Legs);
            if may || legs {
                self.event_budget = if legs && changed { self.event_budget } else { 0 };
                send(command, bytes, *len, out);
                if let Some(place) = self.sent.get_mut(at) {
                    *place = Some(bytes);
                }
            }
        }
    }

    const fn outputs(&self) -> Outputs<'_> {
        let retract = self.state.retracts_legs();
        let legs = if retract { LegsCommand::Retract } else { LegsCommand::Lower };
        Outputs { nodes: &self.nodes, counts: &self.counts, legs }
    }

    /// What a frame holds. What is after the eighth byte is cut off.
    #[inline(always)]
    fn content(&self, command: &CommandTable<'_>, outputs: &Outputs<'_>) -> [u8; 8] {
        match command.writer {
            Some(writer) => writer(outputs),
            None => self.interpreted(command, outputs),
        }
    }

    /// As the fields of a frame say.
    #[inline(never)]
    fn interpreted(&self, command: &CommandTable<'_>, outputs: &Outputs<'_>) -> [u8; 8] {
        // A word can begin at each byte of the frame. What it writes behind its field is zero.
        let (mut bytes, mut used) = ([0; 12], 0_usize);
        for field in command.fields {
            let value = match field.source {
                Source::Zero => 0,
                Source::Controlword { node } => outputs.controlword(node.into()).into(),
                Source::Mode { node } => {
                    let table = self.table.nodes.get(usize::from(node));
                    let motor = table.and_then(|table| table.motor.as_ref());
                    motor.map_or(0, |motor| motor.mode.into())
                }
                Source::Torque { axis, sign } => {
                    outputs.torque(axis.into()).saturating_mul(sign.into())
                }
                Source::Legs => outputs.legs_command().into(),
            };
            let rest = bytes.get_mut(used..).and_then(<[u8]>::first_chunk_mut);
            let Some(place) = rest else { break };
            *place = field.kind.low_bytes(value);
            used = used.saturating_add(field.kind.bytes());
        }
        bytes.first_chunk().copied().unwrap_or_default()
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
