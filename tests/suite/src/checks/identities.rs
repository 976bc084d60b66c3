//! Identities of mechanics that tie the functions of a Lagrangian system together.

use super::{EXACT, STATES};
use crate::compare::{Numbers, assert_close, assert_close_on_scale};
use crate::dual::{Dual, moving, slopes};
use crate::linear_algebra::smallest_pivot;
use crate::states::{State, states};
use shapebot_dynamics::Robot;
use shapebot_dynamics::nalgebra::{SMatrix, SVector};

/// M is symmetric and positive definite, and one pass gives what single calls give.
///
/// # Panics
///
/// If not.
pub fn mass_matrix<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
) {
    for (index, State { q, qd, .. }) in states::<N>(robot.description(), STATES).iter().enumerate()
    {
        let label = format!("{label}, state {index}");
        let mass = robot.mass_matrix(q);
        assert_close(format!("{label}: M and its transpose "), &mass.transpose(), &mass, 1e-15);
        let pivot = smallest_pivot(&mass);
        assert!(pivot > 0.0, "{label}: M is not positive definite, pivot {pivot:e}");
        let motion = robot.motion(q, qd);
        assert_close(format!("{label}: motion, M"), &motion.mass_matrix, &mass, EXACT);
        let bias = robot.coriolis_vector(q, qd);
        assert_close(format!("{label}: motion, Cqd"), &motion.coriolis_vector, &bias, EXACT);
        assert_close(format!("{label}: motion, G"), &motion.gravity, &robot.gravity(q), EXACT);
    }
}

/// Ṁ − 2C is skew-symmetric, and C q̇ is what the method without C gives.
///
/// # Panics
///
/// If not.
pub fn coriolis_matrix<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
    dual: &impl Robot<Dual, N, NX, NS>,
) {
    for (index, State { q, qd, .. }) in states::<N>(robot.description(), STATES).iter().enumerate()
    {
        let label = format!("{label}, state {index}");
        let coriolis = robot.coriolis_matrix(q, qd);
        let rate = slopes(&dual.mass_matrix(&moving(q, qd)));
        let skew = rate - coriolis * 2.0;
        let scale = rate.array().largest().max(coriolis.array().largest()).max(f64::MIN_POSITIVE);
        let what = format!("{label}: dM/dt - 2C plus its transpose, ");
        let sum = skew + skew.transpose();
        assert_close_on_scale(what, &sum, &SMatrix::<f64, N, N>::zeros(), EXACT, scale);
        let product = coriolis * qd;
        let found = robot.coriolis_vector(q, qd);
        assert_close(format!("{label}: C times qd, "), &found, &product, EXACT);
    }
}

/// T = ½ q̇ᵀ M q̇; the work of the inertial forces is the change of T.
///
/// # Panics
///
/// If not.
pub fn energies<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
    dual: &impl Robot<Dual, N, NX, NS>,
) {
    for (index, State { q, qd, qdd, .. }) in
        states::<N>(robot.description(), STATES).iter().enumerate()
    {
        let label = format!("{label}, state {index}");
        let half = qd.dot(&(robot.mass_matrix(q) * qd)) * 0.5;
        assert_close(format!("{label}: T"), &robot.kinetic_energy(q, qd), &half, EXACT);
        let power = qd.dot(&robot.inverse_dynamics(q, qd, qdd));
        let (q, qd) = (moving(q, qd), moving(qd, qdd));
        let energy = dual.kinetic_energy(&q, &qd) + dual.potential_energy(&q);
        assert_close(format!("{label}: power"), &power, &energy.slope, 1e-11);
    }
}

/// Inverse dynamics is M q̈ + C q̇ + G, forward dynamics its inverse.
///
/// # Panics
///
/// If not.
pub fn dynamics<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
) {
    for (index, state) in states::<N>(robot.description(), STATES).iter().enumerate() {
        let label = format!("{label}, state {index}");
        let State { q, qd, qdd, force } = state;
        let motion = robot.motion(q, qd);
        let expected = motion.mass_matrix * qdd + motion.coriolis_vector + motion.gravity;
        let found = robot.inverse_dynamics(q, qd, qdd);
        assert_close(format!("{label}: inverse dynamics"), &found, &expected, EXACT);
        // As exact as M is well conditioned.
        let back = robot.forward_dynamics(q, qd, &found);
        assert_close(format!("{label}: forward of inverse dynamics"), &back, qdd, 1e-10);
        let produced = robot.forward_dynamics(q, qd, force);
        let there = robot.inverse_dynamics(q, qd, &produced);
        let scale =
            (motion.mass_matrix.abs() * produced.abs() + motion.gravity.abs() + force.abs()).max();
        let what = format!("{label}: inverse of forward dynamics");
        assert_close_on_scale(what, &there, force, EXACT, scale);
    }
}

/// Coordinates are described as actuated exactly where B has a row; dissipation takes energy out.
///
/// # Panics
///
/// If not.
pub fn inputs<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
) {
    let description = robot.description();
    let free: Vec<usize> = (0..N).filter(|&i| !description.coordinates[i].actuated).collect();
    assert_eq!(free.len(), NX, "{label}: unactuated coordinates");
    let rest = SVector::zeros();
    for (index, State { q, qd, .. }) in states::<N>(description, STATES).iter().enumerate() {
        let label = format!("{label}, state {index}");
        let columns = (0..description.actuators.len()).map(|a| robot.input_column(q, a));
        let reach = columns.fold(rest, |sum, column| sum + column.abs());
        for i in 0..N {
            let actuated = description.coordinates[i].actuated;
            assert_eq!(reach[i] > 0.0, actuated, "{label}: row {i} of B");
        }
        assert_eq!(
            robot.input_column(q, description.actuators.len()),
            rest,
            "{label}: no such actuator"
        );
        let power = qd.dot(&robot.dissipative_force(q, qd));
        assert!(power <= 0.0, "{label}: dissipation gives {power} W");
        assert_eq!(robot.dissipative_force(q, &rest).abs(), rest, "{label}: dissipation at rest");
    }
}
