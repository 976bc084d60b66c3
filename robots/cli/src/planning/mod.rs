//! From what the user asks for to the planner and back: sizes are run-time values on this side.

mod desired;
mod files;
mod held;
mod motion;
mod phase;
mod shares;

pub(crate) use motion::{Detail, Phase, PlannedMotion, Row};

use crate::failure::{Failure, Outcome};
use crate::output::number;
use nalgebra::SVector;
use phase::{Planned, Request, plan_phase};
use shapebot_dynamics::{Robot, ShapeAccelerated};
use shapebot_planner::{Error, Start, TwoPhases, generalised_force};
use shapebot_tasks::{Motion, Task};
use std::time::Duration;

/// A robot of given sizes. One instance per pair of sizes serves all robots that have them.
type Shaped<'r, const NX: usize, const NS: usize> = dyn ShapeAccelerated<f64, NX, NS> + 'r;

/// The planner's rows.
type Samples<const NX: usize, const NS: usize> = Vec<shapebot_planner::Row<f64, NX, NS>>;

/// Forces that a row takes.
type Forces<'f, const N: usize, const NX: usize, const NS: usize> =
    dyn Fn(&shapebot_planner::Row<f64, NX, NS>) -> SVector<f64, N> + 'f;

/// Plans a task with a robot.
pub(crate) fn plan<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    task: &Task,
) -> Outcome<PlannedMotion>
where
    R: Robot<f64, N, NX, NS>,
{
    plan_shaped::<N, NX, NS>(robot, &|row| generalised_force(robot, row), task)
}

fn plan_shaped<const N: usize, const NX: usize, const NS: usize>(
    robot: &Shaped<'_, NX, NS>,
    force: &Forces<'_, N, NX, NS>,
    task: &Task,
) -> Outcome<PlannedMotion> {
    let description = robot.shape_description();
    let planned = match &task.motion.value {
        Motion::TwoPhases { goal, duration, shares } => {
            let goal = desired::point(goal, description)?;
            let phases = TwoPhases::new(SVector::zeros(), goal, *duration).map_err(failure)?;
            plan_phases(robot, task, &phases, shares)?
        }
        _ => desired::with_motion(task, description, |motion| {
            let request = Request {
                motion,
                samples: task.samples,
                shares: &task.shares,
                standing: task.standing,
                start: None,
            };
            plan_phase(robot, task, &request).map(|phase| vec![phase])
        })?,
    };
    let planned = Joined::of(planned);
    let files = files::files(description, &planned.samples, force)?;
    Ok(planned.motion(robot, task, files))
}

/// Plans both halves, the second from where the first ends.
fn plan_phases<const NX: usize, const NS: usize>(
    robot: &Shaped<'_, NX, NS>,
    task: &Task,
    phases: &TwoPhases<f64, NX>,
    shares: &[shapebot_tasks::Shares; 2],
) -> Outcome<Vec<Planned<NX, NS>>> {
    let mut planned: Vec<Planned<NX, NS>> = Vec::new();
    for (motion, shares) in phases.halves.iter().zip(shares) {
        let last = planned.last().and_then(|phase| phase.samples.last());
        let start = last.map(|last| Start {
            position: last.position,
            velocity: last.velocity,
            shape: last.plan.shape,
            shape_velocity: last.plan.shape_velocity,
            shape_acceleration: Some(last.plan.shape_acceleration),
        });
        let samples = task.samples / 2 + 1;
        let request = Request { motion, samples, shares, standing: [0.0; 2], start };
        planned.push(plan_phase(robot, task, &request)?);
    }
    Ok(planned)
}

/// The phases of a plan, one after the other.
struct Joined<const NX: usize, const NS: usize> {
    samples: Samples<NX, NS>,
    phases: Vec<Phase>,
    elapsed: Duration,
    duration: f64,
    floor: Option<f64>,
}

impl<const NX: usize, const NS: usize> Joined<NX, NS> {
    fn of(planned: Vec<Planned<NX, NS>>) -> Self {
        let single = planned.len() == 1;
        let mut joined = Self {
            samples: Vec::new(),
            phases: Vec::new(),
            elapsed: Duration::ZERO,
            duration: 0.0,
            floor: None,
        };
        for mut phase in planned {
            // Phases share the sample where they meet.
            let shared = usize::from(!joined.samples.is_empty());
            for row in &mut phase.samples {
                row.plan.time += joined.duration;
            }
            joined.samples.extend(phase.samples.drain(shared..));
            joined.elapsed += phase.elapsed;
            joined.duration += phase.duration;
            joined.floor = phase.floor.filter(|_| single);
            joined.phases.push(phase.phase);
        }
        joined
    }

    fn motion(
        self,
        robot: &Shaped<'_, NX, NS>,
        task: &Task,
        files: motion::PlanFiles,
    ) -> PlannedMotion {
        let errors: Vec<(f64, f64)> = self
            .samples
            .iter()
            .map(|row| (row.plan.time, row.output_error().dot(&row.output_error())))
            .collect();
        let slack = 1e-9 * self.duration;
        let within = errors.iter().filter(|(t, _)| (-slack..=self.duration + slack).contains(t));
        let peak = |index: usize| {
            self.samples.iter().fold(0.0, |peak: f64, row| peak.max(row.plan.shape[index].abs()))
        };
        PlannedMotion {
            description: *robot.shape_description(),
            method: task.method,
            output_rmse: root_mean(errors.iter().map(|(_, square)| *square)),
            motion_rmse: root_mean(within.map(|(_, square)| *square)),
            floor: self.floor,
            output_max_error: errors.iter().fold(0.0_f64, |most, (_, e)| most.max(*e)).sqrt(),
            output_end_error: errors.last().map_or(0.0, |(_, square)| square.sqrt()),
            peak_shape: (0..NS).map(peak).collect(),
            elapsed: self.elapsed,
            rows: self.samples.iter().map(Row::of).collect(),
            phases: self.phases,
            files,
        }
    }
}

fn root_mean(squares: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = squares.fold((0.0, 0.0), |(count, sum), square| (count + 1.0, sum + square));
    if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 }
}

/// A task that makes no sense is the user's mistake, a plan that does not work out is refused.
fn failure(error: Error) -> Failure {
    match error {
        Error::Invalid { .. } | Error::InvalidEntry { .. } | Error::Length { .. } => {
            Failure::usage(error)
        }
        Error::OutOfRange { coordinate, unit, time, value, lower, upper } => {
            let range = outside(coordinate, unit, time, [value, lower, upper]);
            Failure::refused(format!("{range}: give the motion more time"))
        }
        Error::LimitExceeded { coordinate, unit, time, value, lower, upper, duration } => {
            let range = outside(coordinate, unit, time, [value, lower, upper]);
            Failure::refused(match duration {
                Some(seconds) => format!("{range}: {seconds:.2} s for the motion would do"),
                None => range,
            })
        }
        _ => Failure::refused(error),
    }
}

fn outside(coordinate: &str, unit: &str, time: f64, numbers: [f64; 3]) -> String {
    let (unit, [value, lower, upper]) = number::shown(unit, numbers);
    format!(
        "`{coordinate}` would be {value} {unit} at t = {time:.4} s, outside of its range {lower} to \
         {upper} {unit}"
    )
}
