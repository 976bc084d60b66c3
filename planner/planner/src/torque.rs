//! Forces along a plan by inverse dynamics.

use crate::Error;
use crate::linear_algebra::is_finite;
use crate::plan::Row;
use nalgebra::SVector;
use shapebot_dynamics::{Actuator, Description, Ordered, Robot};

/// Generalised forces on q = [q_x, q_s] that make a robot move as planned: M q̈ + C q̇ + G (Eq. 2), without
/// friction. The unactuated entries are zero but for rounding: that is what Γ means.
pub fn generalised_force<R, T, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    row: &Row<T, NX, NS>,
) -> SVector<T, N>
where
    R: Robot<T, N, NX, NS>,
    T: Ordered,
{
    let q = R::join(&row.position, &row.plan.shape);
    let qd = R::join(&row.velocity, &row.plan.shape_velocity);
    let qdd = R::join(&row.acceleration, &row.plan.shape_acceleration);
    robot.inverse_dynamics(&q, &qd, &qdd)
}

/// Forces of the actuators, in the order of the description; entries past their number are zero.
///
/// Each is the force's component along the actuator's column of B: exact where the columns are
/// orthogonal, as they are in this class of robots (B = [1; 0]).
pub fn actuator_force<R, T, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    row: &Row<T, NX, NS>,
) -> SVector<T, N>
where
    R: Robot<T, N, NX, NS>,
    T: Ordered,
{
    let force = generalised_force(robot, row);
    let q = R::join(&row.position, &row.plan.shape);
    let actuators = robot.description().actuators.len().min(N);
    SVector::from_fn(|index, _| {
        if index >= actuators {
            return T::zero();
        }
        let column = robot.input_column(&q, index);
        let square = column.dot(&column);
        if square > T::zero() { column.dot(&force) / square } else { T::zero() }
    })
}

/// The largest forces along a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceReport<T: Ordered, const N: usize> {
    /// The largest magnitude of each actuator's force, in its unit.
    pub peak: SVector<T, N>,
    /// The largest magnitude of each unactuated generalised force: how far the plan violates the
    /// robot's dynamics, rounding errors if `LagrangianSystem` and Γ agree.
    pub residual: T,
}

/// Surveys the actuators' forces along the rows of a plan.
///
/// # Errors
///
/// [`Error::LimitExceeded`] for the actuator that exceeds its declared limit most, at the time of its
/// largest force, [`Error::NonFinite`] where a force is no number.
pub fn survey_forces<R, T, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    rows: impl Iterator<Item = Row<T, NX, NS>>,
) -> Result<ForceReport<T, N>, Error>
where
    R: Robot<T, N, NX, NS>,
    T: Ordered,
{
    let description = robot.description();
    let limits = description.actuators.iter().map(|actuator| actuator.limit);
    survey_within(description, limits, rows, |row| {
        [actuator_force(robot, row), generalised_force(robot, row)]
    })
}

/// [`survey_forces`] with other limits than the declared ones: one per actuator, a magnitude in the
/// actuator's unit, +∞ for none. `forces` gives [`actuator_force`] and [`generalised_force`] of a row.
///
/// # Errors
///
/// Those of [`survey_forces`].
pub fn survey_within<T, const N: usize, const NX: usize, const NS: usize>(
    description: &Description,
    limits: impl IntoIterator<Item = f64>,
    rows: impl Iterator<Item = Row<T, NX, NS>>,
    mut forces: impl FnMut(&Row<T, NX, NS>) -> [SVector<T, N>; 2],
) -> Result<ForceReport<T, N>, Error>
where
    T: Ordered,
{
    let mut report = ForceReport { peak: SVector::<T, N>::zeros(), residual: T::zero() };
    // The force of largest magnitude of each actuator, and when.
    let mut extremes = [(T::zero(), T::zero()); N];
    for row in rows {
        let [force, all] = forces(&row);
        if !is_finite(&force) || !is_finite(&all) {
            let time = row.plan.time.to_f64();
            return Err(Error::NonFinite { quantity: "force of an actuator", time });
        }
        for (extreme, &force) in extremes.iter_mut().zip(force.iter()) {
            if force.abs() > extreme.0.abs() {
                *extreme = (force, row.plan.time);
            }
        }
        for (coordinate, force) in description.coordinates.iter().zip(all.iter()) {
            if !coordinate.actuated && force.abs() > report.residual {
                report.residual = force.abs();
            }
        }
    }
    report.peak = SVector::from_fn(|i, _| extremes[i].0.abs());
    let extremes = extremes.map(|(force, time)| (force.to_f64(), time.to_f64()));
    worst_excess(description.actuators, limits, &extremes).map_or(Ok(report), Err)
}

/// The actuator that exceeds its limit by the largest factor.
fn worst_excess(
    actuators: &[Actuator],
    limits: impl IntoIterator<Item = f64>,
    extremes: &[(f64, f64)],
) -> Option<Error> {
    let mut worst = (1.0, None);
    for ((actuator, limit), &(value, time)) in actuators.iter().zip(limits).zip(extremes) {
        let excess = value.abs() / limit;
        if excess > worst.0 {
            let (coordinate, unit) = (actuator.name, actuator.unit);
            let (lower, upper, duration) = (-limit, limit, None);
            let error =
                Error::LimitExceeded { coordinate, unit, time, value, lower, upper, duration };
            worst = (excess, Some(error));
        }
    }
    worst.1
}
