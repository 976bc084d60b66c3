//! Inputs: what nodes send after SYNC.

use super::Master;
use super::node::{NodeState, single};
use crate::fault::Fault;
use crate::frame::Frame;
use crate::legs::LegsState;
use crate::object::DataType;
use crate::table::{Entry, MAX_COORDINATES, Signal};
use crate::yaw::Rotation;

/// What was sampled at a SYNC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// When SYNC was sent, µs.
    pub time_us: u64,
    /// Number of the cycle.
    pub cycle: u32,
    position: [f64; MAX_COORDINATES],
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
        self.position.get(coordinate).copied().unwrap_or(0.0)
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
            position: [0.0; MAX_COORDINATES],
            velocity: [0.0; MAX_COORDINATES],
            age: [u8::MAX; MAX_COORDINATES],
            heading: 0.0,
            heading_rate: 0.0,
            yaw: 0.0,
        }
    }
}

fn set<T>(values: &mut [T], index: usize, value: T) {
    if let Some(place) = values.get_mut(index) {
        *place = value;
    }
}

/// The most negative value of a signed type: what a sensor sends that has no value.
fn is_no_value(kind: DataType, raw: i64) -> bool {
    kind.is_signed() && raw == kind.range().0
}

impl Master<'_> {
    /// A transmit PDO of a node.
    pub(super) fn input(&mut self, index: usize, at: usize, frame: &Frame, now: u64) {
        let table = self.table;
        let Some(pdo) = table.nodes.get(index).and_then(|node| node.transmit.get(at)) else {
            return;
        };
        let Some(state) = self.nodes.get_mut(index) else { return };
        let bytes = frame.bytes();
        if bytes.len() != pdo.bytes() {
            self.counters.malformed = self.counters.malformed.saturating_add(1);
            return;
        }
        let bit = 1 << (at & 7);
        if !state.is_running() {
            return;
        }
        if pdo.is_synchronous() && state.received & bit != 0 {
            // The first one counts.
            self.counters.duplicate = self.counters.duplicate.saturating_add(1);
            return;
        }
        state.received |= bit;
        state.reported = true;
        let mut rest = bytes;
        for entry in pdo.entries() {
            let Some((own, after)) = rest.split_at_checked(entry.kind.bytes()) else { return };
            rest = after;
            self.signal(index, entry, entry.kind.decode(own), now);
        }
    }

    fn signal(&mut self, index: usize, entry: &Entry, raw: i64, now: u64) {
        let Some(node) = self.nodes.get_mut(index) else { return };
        let value = || single(raw) * entry.scale;
        let measurement = &mut self.measurement;
        match entry.signal {
            Signal::Statusword => node.statusword = raw as u16,
            Signal::ModeDisplay => node.mode = raw as i8,
            Signal::ErrorRegister => node.error_register = raw as u8,
            Signal::Position => position(node, entry, raw),
            Signal::Velocity => node.velocity = Some(value()),
            Signal::ActualTorque => node.torque = value(),
            Signal::Health => node.health = raw as u8,
            Signal::LegsState => node.legs = Some(LegsState(raw as u8)),
            Signal::Sequence => {
                let sequence = raw as u8;
                let same = node.sequence == Some(sequence);
                node.stale = if same { node.stale.saturating_add(1) } else { 0 };
                node.sequence = Some(sequence);
            }
            Signal::Coordinate(_)
            | Signal::Rate(_)
            | Signal::Heading
            | Signal::HeadingRate
            | Signal::Yaw
                if is_no_value(entry.kind, raw) =>
            {
                if self.state != crate::safety::State::Off {
                    self.raise(Fault::SensorInvalid, Some(index), now, 0);
                }
            }
            Signal::Coordinate(at) => {
                set(&mut measurement.position, at.into(), raw as f64 * f64::from(entry.scale));
                set(&mut measurement.age, at.into(), 0);
            }
            Signal::Rate(at) => set(&mut measurement.velocity, at.into(), value()),
            Signal::Heading => measurement.heading = value(),
            Signal::HeadingRate => measurement.heading_rate = value(),
            Signal::Yaw => measurement.yaw = value(),
            Signal::Gap
            | Signal::Controlword
            | Signal::Mode
            | Signal::Torque
            | Signal::LegsCommand => {}
        }
    }

    /// Whether the controller's turn has come: all inputs of this cycle are there, or their time is up.
    /// True once a cycle, until [`Self::measure`].
    #[must_use]
    pub fn inputs_due(&self, now: u64) -> bool {
        if self.taken || self.counters.cycles == 0 {
            return false;
        }
        let late = now.saturating_sub(self.last_sync) >= self.table.timing.input_window_us.into();
        let there = |(expected, node): (&u8, &NodeState)| {
            !node.is_running() || node.received & expected == *expected
        };
        late || self.expected.iter().zip(&self.nodes).all(there)
    }

    /// The inputs of this cycle; what did not come keeps its value and grows older.
    pub fn measure(&mut self, now: u64) -> Measurement {
        self.take_inputs(now);
        self.step(now);
        self.measurement
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
        let mut moved = [0.0; crate::MAX_AXES];
        let mut rates = [0.0; crate::MAX_AXES];
        let seconds = (self.table.timing.period_us.max(1)) as f32 * 1e-6;
        for (at, axis) in self.table.axes.iter().enumerate() {
            let Some((position, velocity, fresh)) = self.axis(axis.drives) else { continue };
            let known = self.axis_known & bit(at) != 0;
            let cycles = self.measured_age(axis.coordinate).saturating_add(1);
            let (Some(last), Some(moved), Some(rate)) =
                (self.axis_position.get_mut(at), moved.get_mut(at), rates.get_mut(at))
            else {
                continue;
            };
            *moved = if known { (position - *last) as f32 } else { 0.0 };
            *last = position;
            *rate = velocity.unwrap_or(*moved / (seconds * f32::from(cycles.max(1))));
            let Some(coordinate) = axis.coordinate else { continue };
            let coordinate = usize::from(coordinate);
            if fresh {
                self.axis_known |= bit(at);
                set(&mut self.measurement.velocity, coordinate, *rate);
                set(&mut self.measurement.position, coordinate, position);
            }
            let age = self.measurement.age(coordinate);
            // Ages of measured coordinates grow below; those of axes here.
            set(
                &mut self.measurement.age,
                coordinate,
                if fresh { 0 } else { age.saturating_add(1) },
            );
        }
        self.turn_back(moved, rates);
        self.age_sensors();
        self.check_nodes(now);
    }

    fn measured_age(&self, coordinate: Option<u8>) -> u8 {
        coordinate.map_or(0, |at| self.measurement.age(at.into()))
    }

    /// Mean position and rate of drives, and whether one of them reported in this cycle.
    fn axis(&self, drives: &[u8]) -> Option<(f64, Option<f32>, bool)> {
        let (mut position, mut velocity, mut rates, mut count) = (0.0, 0.0, 0_u8, 0_u8);
        let mut fresh = false;
        for drive in drives {
            let node = self.nodes.get(usize::from(*drive))?;
            node.counts?;
            position = if count == 0 { node.position() } else { position + node.position() };
            count = count.saturating_add(1);
            fresh |= node.received != 0;
            if let Some(rate) = node.velocity {
                velocity += rate;
                rates = rates.saturating_add(1);
            }
        }
        let velocity = (rates > 0).then(|| velocity / f32::from(rates));
        let mean = match count {
            0 | 1 => position,
            2 => position * 0.5,
            _ => position / f64::from(count),
        };
        (count > 0).then_some((mean, velocity, fresh))
    }

    /// Rates and displacements in the drive unit's plane, turned into the body's frame, then integrated.
    fn turn_back(&mut self, moved: [f32; crate::MAX_AXES], rates: [f32; crate::MAX_AXES]) {
        let Some(yaw) = self.table.yaw else { return };
        let [x, y] = yaw.plane;
        let coordinate = |axis: u8| self.table.axes.get(usize::from(axis))?.coordinate;
        let (Some(to_x), Some(to_y)) = (coordinate(x), coordinate(y)) else { return };
        let at = |values: &[f32; crate::MAX_AXES], axis: u8| {
            values.get(usize::from(axis)).copied().unwrap_or(0.0)
        };
        let rate = self.rotation.into_body([at(&rates, x), at(&rates, y)]);
        let step = self.rotation.into_body([at(&moved, x), at(&moved, y)]);
        for ((to, rate), (step, sum)) in
            [to_x, to_y].into_iter().zip(rate).zip(step.into_iter().zip(&mut self.plane))
        {
            *sum += f64::from(step);
            set(&mut self.measurement.position, to.into(), *sum);
            set(&mut self.measurement.velocity, to.into(), rate);
        }
    }

    /// What sensors did not send in this cycle grows older.
    fn age_sensors(&mut self) {
        for (table, node) in self.table.nodes.iter().zip(&self.nodes) {
            for (pdo, at) in table.transmit.iter().zip(0_u8..8) {
                let came = node.received & 1 << at != 0;
                for entry in pdo.entries().iter().filter(|_| !came) {
                    if let Signal::Coordinate(index) = entry.signal {
                        let age = self.measurement.age(index.into()).saturating_add(1);
                        set(&mut self.measurement.age, index.into(), age);
                    }
                }
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
                && libm::fabs(m.position(lean)) <= f64::from(safety.lean_start)
                && libm::fabsf(m.velocity(lean)) <= safety.lean_rate_start
        })
    }
}

/// A bit for an axis.
fn bit(axis: usize) -> u8 {
    u32::try_from(axis).ok().and_then(|axis| 1_u8.checked_shl(axis)).unwrap_or(0)
}

/// Adds what the position object went since it last came, across its own wrap.
fn position(node: &mut NodeState, entry: &Entry, raw: i64) {
    let (low, high) = entry.kind.range();
    let span = high - low + 1;
    let step = match node.counts {
        None => raw,
        Some(last) => {
            let step = raw - last;
            if step > span / 2 {
                step - span
            } else if step < -span / 2 {
                step + span
            } else {
                step
            }
        }
    };
    node.counts = Some(raw);
    node.unit = entry.scale;
    node.travel = node.travel.saturating_add(step);
}
