//! Inputs: what nodes send after SYNC.

use super::node::{NodeState, single};
use super::{Master, node_bit};
use crate::fault::Fault;
use crate::frame::Frame;
use crate::legs::LegsState;
use crate::object::DataType;
use crate::table::{Entry, MAX_AXES, MAX_COORDINATES, NodeTable, Signal};
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

    fn set_position(&mut self, coordinate: usize, counts: i64, unit: f32) {
        set(&mut self.counts, coordinate, counts);
        set(&mut self.unit, coordinate, unit);
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

fn set<T>(values: &mut [T], index: usize, value: T) {
    if let Some(place) = values.get_mut(index) {
        *place = value;
    }
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

/// The next number of a type in a frame's bytes, extended to 32 bits by its sign; `None` after their end.
#[inline(always)]
fn next(rest: &mut &[u8], kind: DataType) -> Option<u32> {
    Some(match kind {
        DataType::I8 => i8::from_le_bytes(chunk(rest)?) as u32,
        DataType::I16 => i16::from_le_bytes(chunk(rest)?) as u32,
        DataType::U8 => u8::from_le_bytes(chunk(rest)?).into(),
        DataType::U16 => u16::from_le_bytes(chunk(rest)?).into(),
        DataType::I32 | DataType::U32 => u32::from_le_bytes(chunk(rest)?),
    })
}

#[inline(always)]
fn chunk<const BYTES: usize>(rest: &mut &[u8]) -> Option<[u8; BYTES]> {
    let (own, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(*own)
}

impl Master<'_> {
    /// A transmit PDO of a node.
    // Not inline: what a caller holds in registers would be spilled in the loop.
    #[inline(never)]
    pub(super) fn input(&mut self, index: usize, at: usize, frame: &Frame, now: u64) {
        let Some(table) = self.table.nodes.get(index) else { return };
        let (Some(pdo), Some(node)) = (table.transmit.get(at), self.nodes.get_mut(index)) else {
            return;
        };
        let bytes = frame.bytes();
        if bytes.len() != pdo.bytes() {
            self.counters.malformed = self.counters.malformed.saturating_add(1);
            return;
        }
        let bit = 1 << (at & 7);
        if !node.is_running() {
            return;
        }
        if pdo.is_synchronous() && node.received & bit != 0 {
            // The first one counts.
            self.counters.duplicate = self.counters.duplicate.saturating_add(1);
            return;
        }
        node.received |= bit;
        node.reported = true;
        if let Some(expected) = self.expected.get(index)
            && node.received & expected == *expected
        {
            self.awaited &= !node_bit(index);
        }
        let mut rest = bytes;
        let mut invalid = 0_u8;
        for entry in pdo.entries() {
            let Some(raw) = next(&mut rest, entry.kind) else { break };
            if !signal(node, table, &mut self.measurement, entry, raw) {
                invalid = invalid.saturating_add(1);
            }
        }
        if self.state != crate::safety::State::Off {
            for _ in 0..invalid {
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
        let (mut moved, mut rates) = ([0.0; MAX_AXES], [0.0; MAX_AXES]);
        let seconds = (self.table.timing.period_us.max(1)) as f32 * 1e-6;
        for (at, axis) in self.table.axes.iter().enumerate() {
            let Some(AxisReading { counts, unit, velocity, fresh }) = self.axis(axis.drives) else {
                continue;
            };
            let known = self.axis_known & bit(at) != 0;
            let cycles = self.measured_age(axis.coordinate).saturating_add(1);
            let (Some(last), Some(moved), Some(rate)) =
                (self.axis_counts.get_mut(at), moved.get_mut(at), rates.get_mut(at))
            else {
                continue;
            };
            *moved = if known { single(counts.wrapping_sub(*last)) * unit } else { 0.0 };
            *last = counts;
            *rate = velocity.unwrap_or(*moved / (seconds * f32::from(cycles.max(1))));
            let Some(coordinate) = axis.coordinate else { continue };
            let coordinate = usize::from(coordinate);
            if fresh {
                self.axis_known |= bit(at);
                set(&mut self.measurement.velocity, coordinate, *rate);
                self.measurement.set_position(coordinate, counts, unit);
            }
            let age = self.measurement.age(coordinate);
            // Ages of measured coordinates grow below; those of axes here.
            set(
                &mut self.measurement.age,
                coordinate,
                if fresh { 0 } else { age.saturating_add(1) },
            );
        }
        self.turn_back(&moved, &rates);
        self.age_sensors();
        self.check_nodes(now);
    }

    fn measured_age(&self, coordinate: Option<u8>) -> u8 {
        coordinate.map_or(0, |at| self.measurement.age(at.into()))
    }

    /// Mean position and rate of drives; `None` until all have reported.
    fn axis(&self, drives: &[u8]) -> Option<AxisReading> {
        let (first, others) = drives.split_first()?;
        let lead = self.nodes.get(usize::from(*first))?;
        lead.counts?;
        let (mut counts, mut fresh, mut alike) = (lead.travel, lead.received != 0, true);
        let (mut velocity, mut rates) =
            (lead.velocity.unwrap_or(0.0), u8::from(lead.velocity.is_some()));
        for drive in others {
            let node = self.nodes.get(usize::from(*drive))?;
            node.counts?;
            match lead.own_counts(node, node.travel) {
                Some(way) => counts = counts.saturating_add(way),
                None => alike = false,
            }
            fresh |= node.received != 0;
            if let Some(rate) = node.velocity {
                velocity += rate;
                rates = rates.saturating_add(1);
            }
        }
        let velocity = match rates {
            0 => None,
            1 => Some(velocity),
            _ => Some(velocity / f32::from(rates)),
        };
        let (counts, unit) = match others.len() {
            0 => (counts, lead.unit),
            1 if alike => (counts, lead.unit * 0.5),
            _ => self.mean(drives, lead.unit),
        };
        Some(AxisReading { counts, unit, velocity, fresh })
    }

    /// Mean position of more than two drives, or of drives whose counts have several sizes: in small parts
    /// of a count.
    #[cold]
    fn mean(&self, drives: &[u8], unit: f32) -> (i64, f32) {
        let nodes = drives.iter().filter_map(|drive| self.nodes.get(usize::from(*drive)));
        let (sum, count) = nodes.fold((0.0, 0.0), |(sum, count), node| {
            (sum + node.travel as f64 * f64::from(node.unit), count + 1.0)
        });
        let part = unit / 256.0;
        // The cast saturates.
        (libm::round(sum / (count * f64::from(part))) as i64, part)
    }

    /// Rates and displacements in the drive unit's plane, turned into the body's frame, then integrated.
    fn turn_back(&mut self, moved: &[f32; MAX_AXES], rates: &[f32; MAX_AXES]) {
        let Some(yaw) = &self.table.yaw else { return };
        let [x, y] = yaw.plane;
        let coordinate = |axis: u8| self.table.axes.get(usize::from(axis))?.coordinate;
        let (Some(to_x), Some(to_y)) = (coordinate(x), coordinate(y)) else { return };
        let at = |values: &[f32; MAX_AXES], axis: u8| {
            values.get(usize::from(axis)).copied().unwrap_or(0.0)
        };
        let rate = self.rotation.into_body([at(rates, x), at(rates, y)]);
        let step = self.rotation.into_body([at(moved, x), at(moved, y)]);
        for ((to, rate), (step, sum)) in
            [to_x, to_y].into_iter().zip(rate).zip(step.into_iter().zip(&mut self.plane))
        {
            *sum = sum.saturating_add(parts(step));
            self.measurement.set_position(to.into(), *sum, PART);
            set(&mut self.measurement.velocity, to.into(), rate);
        }
    }

    /// What sensors did not send in this cycle grows older.
    fn age_sensors(&mut self) {
        for sensed in self.sensed.iter().flatten() {
            let node = self.nodes.get(usize::from(sensed.node));
            if node.is_some_and(|node| node.received & sensed.pdo == 0) {
                let index = usize::from(sensed.coordinate);
                let age = self.measurement.age(index).saturating_add(1);
                set(&mut self.measurement.age, index, age);
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

/// A bit for an axis.
fn bit(axis: usize) -> u8 {
    u32::try_from(axis).ok().and_then(|axis| 1_u8.checked_shl(axis)).unwrap_or(0)
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

/// Takes a number of a node; `false` if it is the one that stands for no value.
#[inline(always)]
fn signal(
    node: &mut NodeState,
    table: &NodeTable<'_>,
    measurement: &mut Measurement,
    entry: &Entry,
    raw: u32,
) -> bool {
    let value = || entry.kind.single(raw) * entry.scale;
    match entry.signal {
        Signal::Statusword => node.set_statusword(raw as u16),
        Signal::ModeDisplay => node.set_mode(raw as i8, table),
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
            if entry.kind.lowest() == Some(raw) =>
        {
            return false;
        }
        Signal::Coordinate(at) => {
            measurement.set_position(at.into(), entry.kind.value(raw), entry.scale);
            set(&mut measurement.age, at.into(), 0);
        }
        Signal::Rate(at) => set(&mut measurement.velocity, at.into(), value()),
        Signal::Heading => measurement.heading = value(),
        Signal::HeadingRate => measurement.heading_rate = value(),
        Signal::Yaw => measurement.yaw = value(),
        Signal::Gap | Signal::Controlword | Signal::Mode | Signal::Torque | Signal::LegsCommand => {
        }
    }
    true
}

/// Adds what the position object went since it last came, across its own wrap.
fn position(node: &mut NodeState, entry: &Entry, raw: u32) {
    let step = match node.counts {
        None => entry.kind.value(raw),
        Some(last) => entry.kind.way(last, raw).into(),
    };
    node.counts = Some(raw);
    node.unit = entry.scale;
    node.travel = node.travel.saturating_add(step);
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
