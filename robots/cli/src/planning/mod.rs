//! From what the user asks for to the planner and back: sizes are run-time values on this side.

mod motion;
mod task;

pub(crate) use motion::{PlannedMotion, Row, termination};
pub(crate) use task::{Path, PlanTask};

use crate::failure::{Failure, Outcome};
use crate::output::number;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Description, ShapeAccelerated};
use shapebot_planner::motion::{Bezier, DesiredMotion, Line};
use shapebot_planner::{Error, Plan, Task, Weighting};
use std::time::Instant;

/// Plans with any robot of given sizes. One instance per pair of sizes serves all robots that have
/// them.
pub(crate) fn plan<const NX: usize, const NS: usize>(
    robot: &dyn ShapeAccelerated<f64, NX, NS>,
    task: &PlanTask,
) -> Outcome<PlannedMotion> {
    match &task.path {
        Path::Line { goal, degree } => {
            let goal = point("line", goal, robot.shape_description())?;
            let line =
                Line::new(SVector::zeros(), goal, task.duration, *degree).map_err(failure)?;
            plan_along(robot, &line, task)
        }
        Path::Bezier { points } => {
            let description = robot.shape_description();
            let points = points.iter().map(|p| point("bezier", p, description));
            let points = points.collect::<Outcome<Vec<SVector<f64, NX>>>>()?;
            let curve = Bezier::new(&points, task.duration).map_err(failure)?;
            plan_along(robot, &curve, task)
        }
    }
}

fn point<const NX: usize>(
    option: &str,
    entries: &[f64],
    description: &Description,
) -> Outcome<SVector<f64, NX>> {
    if entries.len() != NX {
        let (found, names) = (entries.len(), description.outputs.join(", "));
        let numbers = if found == 1 { "number" } else { "numbers" };
        let message = format!(
            "--{option} gives {found} {numbers} for a point, the robot's output has {NX}: {names}"
        );
        return Err(Failure::usage(message));
    }
    Ok(SVector::from_fn(|i, _| entries[i]))
}

fn plan_along<const NX: usize, const NS: usize>(
    robot: &dyn ShapeAccelerated<f64, NX, NS>,
    motion: &dyn DesiredMotion<f64, NX>,
    task: &PlanTask,
) -> Outcome<PlannedMotion> {
    let description = robot.shape_description();
    let contributions = task.contributions(description)?;
    let weighting = match &contributions {
        Some(contributions) => Weighting::Contributions(contributions),
        None => Weighting::MinimumNorm,
    };
    let request = Task::<_, f64, NS>::new(motion, task.samples)
        .weighting(weighting)
        .objective(task.objective);
    let start = Instant::now();
    let plan = shapebot_planner::plan(robot, &request).map_err(failure)?;
    let elapsed = start.elapsed();
    let rows = plan.rows(robot).map(|row| Row::of(&row)).collect();
    let report = *plan.report();
    Ok(PlannedMotion {
        description: *description,
        weights: contributions.clone(),
        gain: rows_of(plan.gain()),
        initial_gain: rows_of(plan.initial_gain()),
        along: along(&plan),
        output_rmse: report.output_rmse,
        output_max_error: report.output_max_error,
        output_end_error: report.output_end_error,
        peak_shape: report.peak_shape.iter().copied().collect(),
        cost: report.cost,
        initial_cost: report.initial_cost,
        iterations: report.iterations,
        evaluations: report.evaluations,
        termination: report.termination,
        elapsed,
        rows,
    })
}

/// K times the unit direction of the motion, if it is straight: all that such a task determines.
fn along<const NX: usize, const NS: usize>(
    plan: &Plan<'_, dyn DesiredMotion<f64, NX> + '_, f64, NX, NS>,
) -> Option<Vec<f64>> {
    let duration = plan.motion().duration();
    let accelerations =
        (1..20).map(|i| plan.at(duration * f64::from(i) / 20.0).desired.position[2]);
    let accelerations: Vec<SVector<f64, NX>> = accelerations.collect();
    let longest = accelerations.iter().copied().max_by(|a, b| a.dot(a).total_cmp(&b.dot(b)))?;
    let length = longest.dot(&longest).sqrt();
    if length == 0.0 {
        return None;
    }
    let direction = longest / length;
    let straight = |a: &SVector<f64, NX>| {
        let across = a - direction * direction.dot(a);
        across.dot(&across).sqrt() <= 1e-9 * length
    };
    accelerations.iter().all(straight).then(|| (plan.gain() * direction).iter().copied().collect())
}

fn rows_of<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

/// A task that makes no sense is the user's mistake, a plan that does not work out is refused.
fn failure(error: Error) -> Failure {
    match error {
        Error::Invalid { .. } | Error::InvalidEntry { .. } | Error::Length { .. } => {
            Failure::usage(error)
        }
        Error::OutOfRange { coordinate, unit, time, value, lower, upper } => {
            let (unit, [value, lower, upper]) = number::shown(unit, [value, lower, upper]);
            Failure::refused(format!(
                "`{coordinate}` would be {value} {unit} at t = {time} s, outside of its range {lower} to \
                 {upper} {unit}: give the motion more time"
            ))
        }
        _ => Failure::refused(error),
    }
}
