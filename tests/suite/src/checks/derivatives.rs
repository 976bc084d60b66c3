//! Every Jacobian against dual numbers through the function that it differentiates.

use super::{EXACT, STATES};
use crate::compare::{Numbers, assert_close, assert_close_on_scale};
use crate::dual::{Dual, along, at_rest, jacobian, slopes};
use crate::states::{State, states};
use shapebot_dynamics::Robot;
use shapebot_dynamics::nalgebra::{SMatrix, SVector};

/// ∂M/∂q, ∂(C q̇)/∂q, ∂(C q̇)/∂q̇, ∂G/∂q, G itself, and the Jacobians of points.
///
/// # Panics
///
/// If one of them is off.
pub fn lagrangian_jacobians<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
    dual: &impl Robot<Dual, N, NX, NS>,
) {
    for (index, state) in states::<N>(robot.description(), STATES).iter().enumerate() {
        let label = format!("{label}, state {index}");
        let State { q, qd, .. } = state;
        let layers: [SMatrix<f64, N, N>; N] =
            std::array::from_fn(|k| slopes(&dual.mass_matrix(&along(q, k))));
        assert_close(format!("{label}: dM_dq"), &robot.mass_matrix_jacobian(q), &layers, EXACT);

        let by_q = jacobian(q, |q| dual.coriolis_vector(q, &at_rest(qd)));
        let found = robot.coriolis_vector_jacobian_q(q, qd);
        assert_close(format!("{label}: dCqd_dq"), &found, &by_q, EXACT);

        let by_qd = jacobian(qd, |qd| dual.coriolis_vector(&at_rest(q), qd));
        let found = robot.coriolis_vector_jacobian_qd(q, qd);
        assert_close(format!("{label}: dCqd_dqd"), &found, &by_qd, EXACT);

        let by_q = jacobian(q, |q| dual.gravity(q));
        assert_close(format!("{label}: dG_dq"), &robot.gravity_jacobian(q), &by_q, EXACT);

        let slope = SVector::<f64, N>::from_fn(|k, _| dual.potential_energy(&along(q, k)).slope);
        assert_close(format!("{label}: G"), &robot.gravity(q), &slope, EXACT);

        for (point, name) in robot.description().points.iter().enumerate() {
            let by_q = jacobian(q, |q| dual.point_position(q, point));
            let found = robot.point_jacobian(q, point);
            assert_close(format!("{label}: Jacobian of point `{name}`"), &found, &by_q, EXACT);
        }
    }
}

/// The Jacobians of Γ, Γ′ and the output.
///
/// # Panics
///
/// If one of them is off.
pub fn shape_jacobians<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
    dual: &impl Robot<Dual, N, NX, NS>,
) {
    for (index, state) in states::<N>(robot.description(), STATES).iter().enumerate() {
        let label = format!("{label}, state {index}");
        let part = |v: &SVector<f64, N>| SVector::<f64, NS>::from_fn(|i, _| v[NX + i]);
        let qx = SVector::<f64, NX>::from_fn(|i, _| state.q[i]);
        let [qs, qsd, qsdd] = [&state.q, &state.qd, &state.qdd].map(part);
        let (fixed, fixed_d, fixed_dd) = (at_rest(&qs), at_rest(&qsd), at_rest(&qsdd));
        let response = robot.response(&qs, &qsd, &qsdd);
        for (name, found, expected) in [
            ("dGamma_dqs", response.d_qs, jacobian(&qs, |x| dual.gamma(x, &fixed_d, &fixed_dd))),
            ("dGamma_dqsd", response.d_qsd, jacobian(&qsd, |x| dual.gamma(&fixed, x, &fixed_dd))),
            ("dGamma_dqsdd", response.d_qsdd, jacobian(&qsdd, |x| dual.gamma(&fixed, &fixed_d, x))),
            (
                "dGammaP_dqs",
                robot.gamma_prime_jacobian(&qs),
                jacobian(&qs, |x| dual.gamma_prime(x)),
            ),
        ] {
            assert_close(format!("{label}: {name}"), &found, &expected, EXACT);
        }
        output_jacobians(&label, robot, dual, &qx, &qs);
    }
    let origin = SVector::zeros();
    let expected = jacobian(&origin, |x| dual.gamma_prime(x));
    assert_close(format!("{label}: K0_qs"), &robot.shape_gain(), &expected, 1e-13);
}

fn output_jacobians<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
    dual: &impl Robot<Dual, N, NX, NS>,
    qx: &SVector<f64, NX>,
    qs: &SVector<f64, NS>,
) {
    let position = jacobian(qx, |x| dual.output(x, &at_rest(qs)));
    let shape = jacobian(qs, |x| dual.output(&at_rest(qx), x));
    let scale = position.array().largest();
    let found = robot.output_jacobian_position();
    assert_close(format!("{label}: dh_dqx"), &found, &position, EXACT);
    let found = robot.output_jacobian_shape(qx, qs);
    assert_close_on_scale(format!("{label}: dh_dqs"), &found, &shape, EXACT, scale);
}
