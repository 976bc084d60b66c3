//! What is to happen, from the bytes of a plan's file.

use crate::{Error, SizedRobot};
use nalgebra::SVector;
use shapebot_control::Target;
use shapebot_dynamics::Robot;
use shapebot_planner::value::{PlanView, RobotId};
use shapebot_planning::{PlannedMotion, Row};
use shapebot_sim::{Moment, Table};

/// The plan at every control period, evaluated as a controller would: by the polynomials of its file.
pub(crate) fn reference<const N: usize, const NX: usize, const NS: usize>(
    model: &SizedRobot<N, NX, NS>,
    planned: &PlannedMotion,
    id: &RobotId<'_>,
    period: f64,
) -> Result<Table<N, NX, NS>, Error> {
    let view = PlanView::<f64, NX, NS, N>::open(&planned.files.binary, id)?;
    let start = view.start_time();
    let steps = ((view.end_time() - start) / period - 1e-6).ceil().max(1.0) as usize;
    let moment = |k: usize| {
        let time = start + k as f64 * period;
        let state = view.at(time);
        let [q, qd] = [0, 1].map(|order: usize| {
            <&SizedRobot<N, NX, NS>>::join(&state.position[order], &state.shape[order])
        });
        let target = Target {
            position: state.position,
            shape: state.shape,
            // The file has the forces of a robot without dissipation.
            force: state.force - model.dissipative_force(&q, &qd),
        };
        let planned_output = model.output(&state.position[0], &state.shape[0]);
        Moment { target, planned: planned_output, desired: desired(&planned.rows, time) }
    };
    Ok(Table::new(period, (0..=steps).map(moment).collect())?)
}

/// Desired output and its velocity: a cubic through values and velocities of the rows.
fn desired<const NX: usize>(rows: &[Row], time: f64) -> [SVector<f64, NX>; 2] {
    let vector = |list: &[f64]| SVector::from_fn(|i, _| list.get(i).copied().unwrap_or_default());
    let after = rows.partition_point(|row| row.time <= time);
    let (Some(a), Some(b)) = (rows.get(after.saturating_sub(1)), rows.get(after)) else {
        let last = rows.last();
        let at = last.map_or_else(SVector::zeros, |row| vector(&row.desired));
        // A regulator is not to run on after the end.
        let moves = last.is_some_and(|row| (row.time - time).abs() < 1e-9);
        let velocity = last.filter(|_| moves).map(|row| vector(&row.desired_velocity));
        return [at, velocity.unwrap_or_else(SVector::zeros)];
    };
    let (h, s) = (b.time - a.time, (time - a.time) / (b.time - a.time));
    if h.is_nan() || h <= 0.0 {
        return [vector(&a.desired), vector(&a.desired_velocity)];
    }
    let (p, v) = (vector(&a.desired), vector(&a.desired_velocity) * h);
    let (way, w) = (vector(&b.desired) - p, vector(&b.desired_velocity) * h);
    let (c2, c3) = (way * 3.0 - v * 2.0 - w, v + w - way * 2.0);
    [p + (v + (c2 + c3 * s) * s) * s, (v + (c2 * 2.0 + c3 * (3.0 * s)) * s) / h]
}
