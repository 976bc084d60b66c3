//! Γ against the equations of motion that define it.

use super::{EXACT, STATES};
use crate::compare::{Numbers as _, assert_close, assert_close_on_scale};
use crate::states::{Numbers, State, states};
use shapebot_dynamics::nalgebra::SVector;
use shapebot_dynamics::{Ordered as _, Robot};

/// Γ solves the unactuated equations of motion, whatever q_x and q̇_x are: no force is needed on an
/// unactuated coordinate if q̈_x = Γ(q_s, q̇_s, q̈_s).
///
/// # Panics
///
/// If not.
pub fn motion_of_the_shape<const N: usize, const NX: usize, const NS: usize, R>(
    label: &str,
    robot: &R,
) where
    R: Robot<f64, N, NX, NS>,
{
    let coordinates = robot.description().coordinates;
    let mut numbers = Numbers::new(3);
    for (index, State { q, qd, qdd, .. }) in
        states::<N>(robot.description(), STATES).iter().enumerate()
    {
        let (qs, qsd, qsdd) = (R::split(q).1, R::split(qd).1, R::split(qdd).1);
        let gamma = robot.gamma(&qs, &qsd, &qsdd);
        let q = R::join(&numbers.vector(-3.0, 3.0), &qs);
        let qd = R::join(&numbers.vector(-3.0, 3.0), &qsd);
        let qdd = R::join(&gamma, &qsdd);
        let force = robot.inverse_dynamics(&q, &qd, &qdd);
        let scale = (robot.mass_matrix(&q).abs() * qdd.abs()).max();
        for i in (0..N).filter(|&i| !coordinates[i].actuated) {
            let what = format!("{label}, state {index}: force on `{}`", coordinates[i].name);
            assert_close_on_scale(what, &force[i], &0.0, EXACT, scale);
        }
    }
}

/// Γ(q_s, 0, 0) = Γ′(q_s), zero at the origin; the response repeats Γ; K⁰ is Γ′'s Jacobian there, of
/// full row rank; Γ is linear in q̈_s.
///
/// # Panics
///
/// If not.
pub fn shape_map<const N: usize, const NX: usize, const NS: usize, R>(label: &str, robot: &R)
where
    R: Robot<f64, N, NX, NS>,
{
    let rest = SVector::zeros();
    let gain = robot.shape_gain();
    let scale = gain.array().largest();
    let origin = robot.gamma_prime(&rest);
    let zero = SVector::<f64, NX>::zeros();
    assert_close_on_scale(format!("{label}: GammaP(0)"), &origin, &zero, 1e-15, scale);
    let slope = robot.gamma_prime_jacobian(&rest);
    assert_close(format!("{label}: dGammaP_dqs(0)"), &slope, &gain, 1e-13);
    assert!(row_rank_is_full(&gain), "{label}: K0_qs has not full row rank: {gain}");
    for (index, state) in states::<N>(robot.description(), STATES).iter().enumerate() {
        let label = format!("{label}, state {index}");
        let [qs, qsd, qsdd] = [&state.q, &state.qd, &state.qdd].map(|v| R::split(v).1);
        let prime = robot.gamma_prime(&qs);
        let resting = robot.gamma(&qs, &rest, &rest);
        assert_close_on_scale(format!("{label}: Gamma at rest"), &resting, &prime, EXACT, scale);
        let gamma = robot.gamma(&qs, &qsd, &qsdd);
        let response = robot.response(&qs, &qsd, &qsdd);
        assert_close(format!("{label}: Gamma of the response"), &response.gamma, &gamma, EXACT);
        let linear = robot.gamma(&qs, &qsd, &rest) + response.d_qsdd * qsdd;
        let scale = gamma.array().largest().max(linear.array().largest());
        assert_close_on_scale(
            format!("{label}: Gamma, linear in qsdd"),
            &gamma,
            &linear,
            EXACT,
            scale,
        );
    }
}

/// K Kᵀ is positive definite.
fn row_rank_is_full<const NX: usize, const NS: usize>(
    gain: &shapebot_dynamics::nalgebra::SMatrix<f64, NX, NS>,
) -> bool {
    gain.iter().all(|k| k.is_finite())
        && crate::linear_algebra::smallest_pivot(&(gain * gain.transpose())) > f64::epsilon()
}
