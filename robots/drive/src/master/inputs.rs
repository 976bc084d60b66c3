//! Inputs: what nodes send after SYNC.

use super::lookup::Input;
use super::node::{NodeState, single};
use super::readings::Readings;
use super::{Master, node_bit};
use crate::fault::Fault;
use crate::frame::Frame;
use crate::table::{MAX_COORDINATES, MAX_NODES};
use crate::yaw::Rotation;
use shapebot_dynamics::Ordered;

/// What was sampled at a SYNC.
///
/// Positions are whole counts with the size of a count. A controller in single precision takes the
/// difference to its origin before anything is rounded ([`Self::way`]), so that its resolution does not
/// depend on how far the robot went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// When SYNC was sent, µs.
    pub time_us: u64,
    /// Number of the cycle.
    pub cycle: u32,
    counts: [i64; MAX_COORDINATES],
    /// SI value of a count.
    unit: [f32; MAX_COORDINATES],
    velocity: [f32; MAX_COORDINATES],
    age: [u8; MAX_COORDINATES],
    /// Heading of the body, rad; zero if it is not measured.
    pub heading: f32,
    /// Its rate, rad/s.
    pub heading_rate: f32,
    /// Angle of the drive unit against the body, rad.
    pub yaw: f32,
}

impl Measurement {
    /// A coordinate, by its index in q; SI. Coordinates in the plane of a drive unit are the integral of
    /// rates that were turned into the body's frame.
    #[must_use]
    pub fn position(&self, coordinate: usize) -> f64 {
        self.way(coordinate, 0)
    }

    /// The same in counts, of whatever size; for [`Self::way`].
    #[must_use]
    pub fn counts(&self, coordinate: usize) -> i64 {
        self.counts.get(coordinate).copied().unwrap_or(0)
    }

    /// The way of a coordinate from an origin, which is given in counts; SI.
    #[must_use]
    pub fn way<T: Ordered>(&self, coordinate: usize, origin: i64) -> T {
        let unit = self.unit.get(coordinate).copied().unwrap_or(0.0);
        T::from_i64(self.counts(coordinate).wrapping_sub(origin)) * T::from_f32(unit)
    }

    #[inline(always)]
    pub(super) fn set_position(&mut self, coordinate: usize, counts: i64, unit: f32) {
        set(&mut self.counts, coordinate, counts);
        set(&mut self.unit, coordinate, unit);
    }

    #[inline(always)]
    pub(super) fn set_velocity(&mut self, coordinate: usize, velocity: f32) {
        set(&mut self.velocity, coordinate, velocity);
    }

    #[inline(always)]
    pub(super) fn set_age(&mut self, coordinate: usize, age: u8) {
        set(&mut self.age, coordinate, age);
    }

    /// Its rate: measured, or the difference of positions over the cycles between them.
    #[must_use]
    pub fn velocity(&self, coordinate: usize) -> f32 {
        self.velocity.get(coordinate).copied().unwrap_or(0.0)
    }

    /// Cycles since the coordinate was measured: 0 is fresh.
    #[must_use]
    pub fn age(&self, coordinate: usize) -> u8 {
        self.age.get(coordinate).copied().unwrap_or(u8::MAX)
    }
}

impl Default for Measurement {
    fn default() -> Self {
        Self {
            time_us: 0,
            cycle: 0,
            counts: [0; MAX_COORDINATES],
            unit: [0.0; MAX_COORDINATES],
            velocity: [0.0; MAX_COORDINATES],
            age: [u8::MAX; MAX_COORDINATES],
            heading: 0.0,
            heading_rate: 0.0,
            yaw: 0.0,
        }
    }
}

#[inline(always)]
fn set<T>(values: &mut [T; MAX_COORDINATES], index: usize, value: T) {
    if let Some(place) = values.get_mut(index) {
        *place = value;
    }
}

/// An axis from cycle to cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisState {
    /// Its position came at least once.
    known: bool,
    /// Position, counts.
    counts: i64,
    /// Displacement in this cycle, in the coordinate's unit.
    moved: f32,
    rate: f32,
}

impl AxisState {
    pub(super) const NEW: Self = Self { known: false, counts: 0, moved: 0.0, rate: 0.0 };
}

/// Mean of the drives of an axis.
struct AxisReading {
    counts: i64,
    /// SI value of a count.
    unit: f32,
    /// Rate by the drives.
    velocity: Option<f32>,
    /// One of them reported in this cycle.
    fresh: bool,
}

impl AxisReading {
    /// Of one, two or more drives; `None` until all have reported.
    #[inline(always)]
    fn of(nodes: &[NodeState; MAX_NODES], drives: &[u8]) -> Option<Self> {
        let node = |drive: &u8| nodes.get(usize::from(*drive)).filter(|it| it.counts.is_some());
        match drives {
            [] => None,
            [one] => {
                let NodeState { travel, unit, velocity, received, .. } = *node(one)?;
                Some(Self { counts: travel, unit, velocity, fresh: received != 0 })
            }
            [one, two] => {
                let (lead, other) = (node(one)?, node(two)?);
                let Some(way) = lead.own_counts(other, other.travel) else {
                    return Self::mean(nodes, drives);
                };
                let velocity = match (lead.velocity, other.velocity) {
                    (Some(own), Some(others)) => Some((own + others) * 0.5),
                    (own, others) => own.or(others),
                };
                let counts = lead.travel.wrapping_add(way);
                let fresh = lead.received | other.received != 0;
                Some(Self { counts, unit: lead.unit * 0.5, velocity, fresh })
            }
            _ => Self::mean(nodes, drives),
        }
    }

    /// Of more than two drives, or of drives whose counts have several sizes: in small parts of a count.
    #[cold]
    #[inline(never)]
    fn mean(nodes: &[NodeState; MAX_NODES], drives: &[u8]) -> Option<Self> {
        let (mut sum, mut count, mut unit) = (0.0, 0.0, None);
        let (mut velocity, mut rates, mut fresh) = (0.0, 0.0, false);
        for drive in drives {
            let node = nodes.get(usize::from(*drive)).filter(|it| it.counts.is_some())?;
            sum += node.travel as f64 * f64::from(node.unit);
            count += 1.0;
            unit = unit.or(Some(node.unit));
            fresh |= node.received != 0;
            if let Some(rate) = node.velocity {
                velocity += rate;
                rates += 1.0;
            }
        }
        let part = unit? / 256.0;
        // The cast saturates.
        let counts = libm::round(sum / (count * f64::from(part))) as i64;
        let velocity = (rates > 0.0).then(|| velocity / rates);
        Some(Self { counts, unit: part, velocity, fresh })
    }
}

impl Master<'_> {
    /// A transmit PDO of a node.
    pub(super) fn input(&mut self, input: &Input<'_>, frame: &Frame, now: u64) {
        let (index, pdo) = (usize::from(input.node), input.pdo);
        let Some(node) = self.nodes.get_mut(index) else { return };
        let data = match frame.data() {
            Some(data) if frame.len() == pdo.bytes() => data,
            _ => {
                self.counters.malformed = self.counters.malformed.saturating_add(1);
                return;
            }
        };
        if !node.is_running() {
            return;
        }
        if node.received & input.bit != 0 && pdo.is_synchronous() {
            // The first one counts.
            self.counters.duplicate = self.counters.duplicate.saturating_add(1);
            return;
        }
        node.received |= input.bit;
        node.reported = true;
        if node.received & node.expected == node.expected {
            self.awaited &= !node_bit(index);
        }
        let mut to = Readings { node, measurement: &mut self.measurement, invalid: 0 };
        match pdo.reader() {
            Some(reader) => reader(data, &mut to),
            None => to.interpret(pdo, data),
        }
        for _ in 0..to.invalid {
            if self.state != crate::safety::State::Off {
                self.raise(Fault::SensorInvalid, Some(index), now, 0);
            }
        }
    }

    /// Whether the controller's turn has come: all inputs of this cycle are there, or their time is up.
    /// True once a cycle, until [`Self::measure`].
    #[must_use]
    pub fn inputs_due(&self, now: u64) -> bool {
        if self.taken || self.counters.cycles == 0 {
            return false;
        }
        self.awaited == 0
            || now.saturating_sub(self.last_sync) >= self.table.timing.input_window_us.into()
    }

    /// The inputs of this cycle; what did not come keeps its value and grows older.
    pub fn measure(&mut self, now: u64) -> &Measurement {
        self.take_inputs(now);
        self.step(now);
        &self.measurement
    }

    /// Once a cycle: positions of axes, rates in the body's frame, checks.
    pub(super) fn take_inputs(&mut self, now: u64) {
        if self.taken {
            return;
        }
        self.taken = true;
        self.measurement.time_us = self.last_sync;
        self.measurement.cycle = self.counters.cycles;
        if self.table.yaw.is_some() {
            self.rotation = Rotation::of(self.measurement.yaw);
        }
        self.take_axes();
        self.turn_back();
        self.age_sensors();
        self.check_nodes(now);
    }

    /// Positions and rates of axes.
    fn take_axes(&mut self) {
        let table = self.table;
        let seconds = (table.timing.period_us.max(1)) as f32 * 1e-6;
        for (axis, state) in table.axes.iter().zip(&mut self.axes) {
            (state.moved, state.rate) = (0.0, 0.0);
            let Some(reading) = AxisReading::of(&self.nodes, axis.drives) else { continue };
            let AxisReading { counts, unit, velocity, fresh } = reading;
            let coordinate = axis.coordinate.map(usize::from);
            let age = coordinate.map_or(0, |at| self.measurement.age(at));
            if state.known {
                state.moved = single(counts.wrapping_sub(state.counts)) * unit;
            }
            state.counts = counts;
            state.rate = velocity
                .unwrap_or_else(|| state.moved / (seconds * f32::from(age.saturating_add(1))));
            let Some(coordinate) = coordinate else { continue };
            if fresh {
                state.known = true;
                self.measurement.set_velocity(coordinate, state.rate);
                self.measurement.set_position(coordinate, counts, unit);
                self.measurement.set_age(coordinate, 0);
            } else {
                // Ages of measured coordinates grow below; those of axes here.
                self.measurement.set_age(coordinate, age.saturating_add(1));
            }
        }
    }

    /// Rates and displacements in the drive unit's plane, turned into the body's frame, then integrated.
    fn turn_back(&mut self) {
        let Some(yaw) = &self.table.yaw else { return };
        let plane = yaw.plane.map(usize::from);
        let [to_x, to_y] = plane.map(|axis| self.table.axes.get(axis)?.coordinate);
        let (Some(to_x), Some(to_y)) = (to_x, to_y) else { return };
        let [x, y] = plane.map(|axis| self.axes.get(axis).unwrap_or(&AxisState::NEW));
        let rate = self.rotation.into_body([x.rate, y.rate]);
        let step = self.rotation.into_body([x.moved, y.moved]);
        for ((to, rate), (step, sum)) in
            [to_x, to_y].into_iter().zip(rate).zip(step.into_iter().zip(&mut self.plane))
        {
            *sum = sum.wrapping_add(parts(step));
            self.measurement.set_position(to.into(), *sum, PART);
            self.measurement.set_velocity(to.into(), rate);
        }
    }

    /// What sensors did not send in this cycle grows older.
    fn age_sensors(&mut self) {
        for sensed in self.sensed.iter().map_while(Option::as_ref) {
            let node = self.nodes.get(usize::from(sensed.node));
            if node.is_some_and(|node| node.received & sensed.pdo == 0) {
                let index = usize::from(sensed.coordinate);
                let age = self.measurement.age(index).saturating_add(1);
                self.measurement.set_age(index, age);
            }
        }
    }

    /// Whether lean and its rate are known and small enough to start.
    pub(super) fn is_upright(&self) -> bool {
        let safety = &self.table.safety;
        safety.lean.iter().all(|lean| {
            let lean = usize::from(*lean);
            let m = &self.measurement;
            m.age(lean) <= 1
                && libm::fabsf(m.way(lean, 0)) <= safety.lean_start
                && libm::fabsf(m.velocity(lean)) <= safety.lean_rate_start
        })
    }
}

/// Displacements in the plane are added up in these parts, 2⁻⁴⁰ of a metre or radian.
const PART: f32 = 1.0 / (ROUGH * ROUGH);

/// Half of the bits of [`PART`].
const ROUGH: f32 = 1_048_576.0;

/// A displacement of a cycle in parts, exact to the last one: twenty bits of it, then twenty more, since
/// only numbers of 32 bits have an instruction. Saturates beyond 2¹¹; zero if it is not a number.
fn parts(step: f32) -> i64 {
    let scaled = step * ROUGH;
    let rough = scaled as i32;
    let rest = ((scaled - rough as f32) * ROUGH) as i32;
    (i64::from(rough) << 20) + i64::from(rest)
}

#[cfg(test)]
mod tests {
    use super::{PART, parts};

    #[test]
    fn displacements_are_kept_to_the_last_part() {
        for step in [0.0, 1.5, -2.75, 1.0e-3, -7.3e-5, 3.0e-9, 1234.567] {
            let kept = parts(step) as f64 * f64::from(PART);
            assert!((kept - f64::from(step)).abs() < f64::from(PART), "{step} {kept}");
        }
        assert_eq!(parts(f32::NAN), 0);
        assert!(parts(f32::INFINITY) > 0 && parts(f32::NEG_INFINITY) < 0);
    }
}
