//! Forces along a plan by inverse dynamics.

use crate::Error;
use crate::linear_algebra::is_finite;
use crate::plan::Row;
use nalgebra::SVector;
use shapebot_dynamics::{Ordered, Robot};

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
/// [`Error::LimitExceeded`] at the first sample where an actuator's declared limit is exceeded,
/// [`Error::NonFinite`] where a force is no number.
pub fn survey_forces<R, T, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    rows: impl Iterator<Item = Row<T, NX, NS>>,
) -> Result<ForceReport<T, N>, Error>
where
    R: Robot<T, N, NX, NS>,
    T: Ordered,
{
    let description = robot.description();
    let mut report = ForceReport { peak: SVector::<T, N>::zeros(), residual: T::zero() };
    for row in rows {
        let force = actuator_force(robot, &row);
        let time = row.plan.time.to_f64();
        if !is_finite(&force) {
            return Err(Error::NonFinite { quantity: "force of an actuator", time });
        }
        for (actuator, (&force, peak)) in
            description.actuators.iter().zip(force.iter().zip(report.peak.iter_mut()))
        {
            if force.abs().to_f64() > actuator.limit {
                return Err(Error::LimitExceeded {
                    coordinate: actuator.name,
                    unit: actuator.unit,
                    time,
                    value: force.to_f64(),
                    lower: -actuator.limit,
                    upper: actuator.limit,
                    duration: None,
                });
            }
            if force.abs() > *peak {
                *peak = force.abs();
            }
        }
        let all = generalised_force(robot, &row);
        for (coordinate, force) in description.coordinates.iter().zip(all.iter()) {
            if !coordinate.actuated && force.abs() > report.residual {
                report.residual = force.abs();
            }
        }
    }
    Ok(report)
}
