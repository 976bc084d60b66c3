//! The loop: plant → sensors → controller → actuators → plant.

use crate::error::at_least;
use crate::raw::{RawSensors, Unit};
use crate::record::Tally;
use crate::reference::{Moment, Reference};
use crate::sensors::SensorSuite;
use crate::{Error, Fall, Plant, Run, Sample, Scenario};
use nalgebra::SVector;
use shapebot_control::estimator::Reading;
use shapebot_control::{Command, Controller, State};
use shapebot_dynamics::{LagrangianSystem, Robot, Role, ShapeAccelerated};
use std::collections::VecDeque;

/// What follows a reference.
pub trait Tracker<const N: usize, const NX: usize, const NS: usize> {
    /// Forces for the control period that begins now.
    fn step(
        &mut self,
        state: &State<f64, N>,
        moment: &Moment<N, NX, NS>,
    ) -> Command<f64, N, NX, NS>;

    /// The inertial unit whose readings it wants instead of states; none for states.
    fn unit(&self) -> Option<Unit<N>> {
        None
    }

    /// Takes a reading of that unit, once per control period; what it makes of it is what
    /// [`Tracker::step`] is given.
    fn estimate(&mut self, _: &Reading<f64, N>, moment: &Moment<N, NX, NS>) -> State<f64, N> {
        let join =
            |order: usize| joined(&moment.target.position[order], &moment.target.shape[order]);
        State { q: join(0), qd: join(1) }
    }
}

fn joined<const N: usize, const NX: usize, const NS: usize>(
    position: &SVector<f64, NX>,
    shape: &SVector<f64, NS>,
) -> SVector<f64, N> {
    SVector::from_fn(|i, _| if i < NX { position[i] } else { shape[i - NX] })
}

impl<R, const N: usize, const NX: usize, const NS: usize> Tracker<N, NX, NS>
    for Controller<'_, R, f64, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    fn step(
        &mut self,
        state: &State<f64, N>,
        moment: &Moment<N, NX, NS>,
    ) -> Command<f64, N, NX, NS> {
        Self::step(self, state, &moment.target)
    }
}

/// Times of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Control period, s: the controller's own.
    pub period: f64,
    /// Steps of the plant per control period.
    pub substeps: usize,
    /// Whether a command takes effect one period after its reading, as in a loop that reads and writes
    /// its drives in the same cycle.
    pub latency: bool,
    /// How long the run goes on after the reference ends, s.
    pub after: f64,
    /// A sample is recorded every so many periods; 0 for the first and the last only.
    pub record_every: usize,
}

impl Default for Timing {
    /// 500 Hz, four steps of the plant each, no latency, two more seconds, 100 samples per second.
    fn default() -> Self {
        Self { period: 0.002, substeps: 4, latency: false, after: 2.0, record_every: 5 }
    }
}

/// The plant's side of a run: its Lagrangian, its output, what happens to it, and when.
#[derive(Clone, Copy)]
pub struct World<'a, const N: usize, const NX: usize, const NS: usize> {
    /// The plant.
    pub system: &'a dyn LagrangianSystem<f64, N>,
    /// Its output h.
    pub map: &'a dyn ShapeAccelerated<f64, NX, NS>,
    /// What happens to it.
    pub scenario: &'a Scenario<NX, NS>,
    /// Times.
    pub timing: Timing,
}

/// Lets a tracker follow a reference.
///
/// # Errors
///
/// As [`Plant::new`]; times that are not positive.
pub fn simulate<const N: usize, const NX: usize, const NS: usize>(
    world: &World<'_, N, NX, NS>,
    reference: &dyn Reference<N, NX, NS>,
    tracker: &mut dyn Tracker<N, NX, NS>,
) -> Result<Run<N, NX, NS>, Error> {
    let World { system, map, scenario, timing } = *world;
    at_least("control period", timing.period, f64::MIN_POSITIVE)?;
    at_least("plant steps per control period", timing.substeps as f64, 1.0)?;
    at_least("time after the reference", timing.after, 0.0)?;
    let plant = Plant::new(system, map, scenario, timing.period / timing.substeps as f64)?;
    let state = start(&plant, scenario, &reference.at(0.0));
    let description = system.description();
    let mut course = Loop {
        sensors: SensorSuite::new(scenario.sensors, description, timing.period, scenario.seed),
        raw: RawSensors::new(scenario.sensors, timing.period, scenario.seed),
        drives: Drives::new(&timing, scenario.actuation_delay),
        plant,
        timing,
        state,
    };
    Ok(course.run(reference, tracker))
}

/// The reference's first state, moved as the scenario says.
fn start<const N: usize, const NX: usize, const NS: usize>(
    plant: &Plant<'_, N, NX, NS>,
    scenario: &Scenario<NX, NS>,
    first: &Moment<N, NX, NS>,
) -> State<f64, N> {
    let target = &first.target;
    let (qx, qs) = (target.position[0] + scenario.start_position, target.shape[0]);
    // A lean moves the output, which is to stay: h is affine in q_x.
    let leaning = qs + scenario.start_shape;
    let moved = plant.output(&joined(&qx, &leaning)) - plant.output(&joined(&qx, &qs));
    let qx = qx - plant.coordinates_per_output() * moved;
    State { q: joined(&qx, &leaning), qd: joined(&target.position[1], &target.shape[1]) }
}

struct Loop<'a, const N: usize, const NX: usize, const NS: usize> {
    plant: Plant<'a, N, NX, NS>,
    sensors: SensorSuite<N, NS>,
    raw: RawSensors<N, NS>,
    drives: Drives<N>,
    timing: Timing,
    state: State<f64, N>,
}

impl<const N: usize, const NX: usize, const NS: usize> Loop<'_, N, NX, NS> {
    fn run(
        &mut self,
        reference: &dyn Reference<N, NX, NS>,
        tracker: &mut dyn Tracker<N, NX, NS>,
    ) -> Run<N, NX, NS> {
        let Timing { period, after, record_every, .. } = self.timing;
        let motion_steps = (reference.duration() / period).round() as usize;
        let steps = ((reference.duration() + after) / period).round() as usize;
        let (mut samples, mut tally, mut fell) = (Vec::new(), Tally::new(), None);
        for k in 0..=steps {
            let time = k as f64 * period;
            fell = self.fall(time);
            let moment = reference.at(time);
            let told = self.told(tracker, &moment);
            let command = tracker.step(&told, &moment);
            let actual = self.plant.output(&self.state.q);
            tally.add(&moment, &actual, &command, k <= motion_steps);
            let recorded = record_every > 0 && k % record_every == 0;
            if recorded || k == 0 || k == steps || fell.is_some() {
                samples.push(sample(time, &self.state, &moment, actual, &command));
            }
            if fell.is_some() || k == steps {
                break;
            }
            self.drives.command(command.force, command.actuator);
            self.advance(time);
        }
        Run { samples, fell, errors: tally.errors() }
    }

    /// What the tracker is told of the state.
    fn told(
        &mut self,
        tracker: &mut dyn Tracker<N, NX, NS>,
        moment: &Moment<N, NX, NS>,
    ) -> State<f64, N> {
        match tracker.unit() {
            Some(unit) => {
                let reading = self.raw.read(&self.plant, &unit, &self.state);
                tracker.estimate(&reading, moment)
            }
            None => self.sensors.read(&self.state, &self.plant.lean_offset(&self.state.q)),
        }
    }

    /// One control period of the plant.
    fn advance(&mut self, time: f64) {
        for substep in 0..self.timing.substeps {
            let now = time + substep as f64 * self.plant.step();
            let (force, actuators) = self.drives.next();
            let drive = self.plant.actuate(&self.state.q, &force, &actuators);
            self.state = self.plant.advance(now, &self.state, &drive);
        }
    }

    /// The first coordinate that tells a fall. Actuated shape variables are joints, which cannot fall.
    fn fall(&self, time: f64) -> Option<Fall> {
        let coordinates = self.plant.system().description().coordinates;
        let mut values = self.state.q.iter().zip(coordinates).enumerate();
        let fallen = values.find(|(_, (value, c))| {
            let joint = c.role == Role::Shape && c.actuated;
            !value.is_finite() || (!joint && !(c.lower..=c.upper).contains(*value))
        });
        fallen.map(|(coordinate, (&value, _))| Fall { time, coordinate, value })
    }
}

fn sample<const N: usize, const NX: usize, const NS: usize>(
    time: f64,
    state: &State<f64, N>,
    moment: &Moment<N, NX, NS>,
    actual: SVector<f64, NX>,
    command: &Command<f64, N, NX, NS>,
) -> Sample<N, NX, NS> {
    Sample {
        time,
        state: *state,
        desired: moment.desired[0],
        planned: moment.planned,
        actual,
        planned_shape: moment.target.shape[0],
        compensation: command.compensation,
        actuator: command.actuator,
        saturated: command.saturated,
    }
}

/// Generalised forces and forces of the actuators.
type Drive<const N: usize> = (SVector<f64, N>, SVector<f64, N>);

/// Commands on their way to the motors, held until the next one arrives. Delays are whole steps of the
/// plant.
struct Drives<const N: usize> {
    delay: usize,
    held: Drive<N>,
    /// With the step at which they arrive.
    on_the_way: VecDeque<(usize, Drive<N>)>,
    step: usize,
}

impl<const N: usize> Drives<N> {
    fn new(timing: &Timing, delay: f64) -> Self {
        let step = timing.period / timing.substeps as f64;
        let latency = if timing.latency { timing.substeps } else { 0 };
        Self {
            delay: (delay / step).round() as usize + latency,
            held: (SVector::zeros(), SVector::zeros()),
            on_the_way: VecDeque::new(),
            step: 0,
        }
    }

    fn command(&mut self, force: SVector<f64, N>, actuators: SVector<f64, N>) {
        self.on_the_way.push_back((self.step + self.delay, (force, actuators)));
    }

    fn next(&mut self) -> Drive<N> {
        while let Some((arrival, drive)) = self.on_the_way.front()
            && *arrival <= self.step
        {
            self.held = *drive;
            self.on_the_way.pop_front();
        }
        self.step += 1;
        self.held
    }
}

#[cfg(test)]
mod tests {
    use super::{Drives, Timing};
    use nalgebra::Vector1;

    fn forces(timing: &Timing, delay: f64) -> Vec<f64> {
        let mut drives = Drives::<1>::new(timing, delay);
        let mut seen = Vec::new();
        for k in 1..=3 {
            let force = Vector1::new(f64::from(k));
            drives.command(force, force);
            seen.extend((0..timing.substeps).map(|_| drives.next().0[0]));
        }
        seen
    }

    #[test]
    fn commands_are_held_for_their_period() {
        let timing = Timing { substeps: 2, ..Timing::default() };
        assert_eq!(forces(&timing, 0.0), [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
    }

    #[test]
    fn latency_is_one_period_and_delay_adds_to_it() {
        let timing = Timing { substeps: 2, latency: true, ..Timing::default() };
        assert_eq!(forces(&timing, 0.0), [0.0, 0.0, 1.0, 1.0, 2.0, 2.0]);
        assert_eq!(forces(&timing, 0.001), [0.0, 0.0, 0.0, 1.0, 1.0, 2.0]);
    }
}
