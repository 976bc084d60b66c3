//! Two implementations or two precisions of one robot against each other.

use super::STATES;
use crate::compare::{Numbers, assert_close, assert_close_on_scale};
use crate::states::{State, states};
use shapebot_dynamics::nalgebra::SVector;
use shapebot_dynamics::{Ordered, Real, Robot};

/// Two implementations agree to `tolerance` in all functions of the traits. `found` may have points and
/// frames that `expected` has not.
///
/// # Panics
///
/// If not.
pub fn agrees<A: Ordered, B: Ordered, const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    found: &impl Robot<A, N, NX, NS>,
    expected: &impl Robot<B, N, NX, NS>,
    tolerance: f64,
) {
    for (index, state) in states::<N>(expected.description(), STATES).iter().enumerate() {
        let label = format!("{label}, state {index}");
        lagrangian(&label, found, expected, state, tolerance);
        shape(&label, found, expected, state, tolerance);
    }
    let (found, expected) = (found.shape_gain(), expected.shape_gain());
    assert_close(format!("{label}: K0_qs"), &found, &expected, tolerance);
}

/// Compiled in single precision it agrees with double precision to about 1e-5 of the largest entry.
///
/// # Panics
///
/// If not.
pub fn single_precision<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    single: &impl Robot<f32, N, NX, NS>,
    double: &impl Robot<f64, N, NX, NS>,
) {
    agrees(label, single, double, 2e-5);
}

fn cast<T: Real, const L: usize>(x: &SVector<f64, L>) -> SVector<T, L> {
    x.map(T::from_f64)
}

fn lagrangian<A: Ordered, B: Ordered, const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    a: &impl Robot<A, N, NX, NS>,
    b: &impl Robot<B, N, NX, NS>,
    State { q, qd, qdd, force }: &State<N>,
    tolerance: f64,
) {
    let ([q, qd, qdd], [p, pd, pdd]) = ([q, qd, qdd].map(cast), [q, qd, qdd].map(cast));
    let check = |field: &str, found: &dyn Numbers, expected: &dyn Numbers| {
        assert_close(format!("{label}: {field}"), &found.array(), &expected.array(), tolerance);
    };
    check("M", &a.mass_matrix(&q), &b.mass_matrix(&p));
    check("C", &a.coriolis_matrix(&q, &qd), &b.coriolis_matrix(&p, &pd));
    check("Cqd", &a.coriolis_vector(&q, &qd), &b.coriolis_vector(&p, &pd));
    check("G", &a.gravity(&q), &b.gravity(&p));
    check("dM_dq", &a.mass_matrix_jacobian(&q), &b.mass_matrix_jacobian(&p));
    check("dG_dq", &a.gravity_jacobian(&q), &b.gravity_jacobian(&p));
    let (found, expected) =
        (a.coriolis_vector_jacobian_q(&q, &qd), b.coriolis_vector_jacobian_q(&p, &pd));
    check("dCqd_dq", &found, &expected);
    let (found, expected) =
        (a.coriolis_vector_jacobian_qd(&q, &qd), b.coriolis_vector_jacobian_qd(&p, &pd));
    check("dCqd_dqd", &found, &expected);
    check(
        "inverse dynamics",
        &a.inverse_dynamics(&q, &qd, &qdd),
        &b.inverse_dynamics(&p, &pd, &pdd),
    );
    // Solving amplifies rounding by the condition of M.
    let (found, expected) =
        (a.forward_dynamics(&q, &qd, &cast(force)), b.forward_dynamics(&p, &pd, &cast(force)));
    assert_close(format!("{label}: forward dynamics"), &found, &expected, 100.0 * tolerance);
    check("center of mass", &a.center_of_mass(&q), &b.center_of_mass(&p));
    check("dissipation", &a.dissipative_force(&q, &qd), &b.dissipative_force(&p, &pd));
    let description = b.description();
    for i in 0..description.actuators.len() {
        check("input column", &a.input_column(&q, i), &b.input_column(&p, i));
    }
    for (j, name) in description.points.iter().enumerate() {
        let i = index_of(name, a.description().points);
        check("point", &a.point_position(&q, i), &b.point_position(&p, j));
        check("point Jacobian", &a.point_jacobian(&q, i), &b.point_jacobian(&p, j));
    }
    for (j, name) in description.frames.iter().enumerate() {
        let i = index_of(name, a.description().frames);
        check("frame", &a.frame_rotation(&q, i), &b.frame_rotation(&p, j));
    }
}

fn index_of(name: &str, names: &[&str]) -> usize {
    let index = names.iter().position(|&other| other == name);
    index.unwrap_or_else(|| panic!("no `{name}` among {names:?}"))
}

fn shape<A: Ordered, B: Ordered, const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    a: &impl Robot<A, N, NX, NS>,
    b: &impl Robot<B, N, NX, NS>,
    state: &State<N>,
    tolerance: f64,
) {
    let part = |v: &SVector<f64, N>| SVector::<f64, NS>::from_fn(|i, _| v[NX + i]);
    let [qs, qsd, qsdd] = [&state.q, &state.qd, &state.qdd].map(part);
    let found = a.response(&cast(&qs), &cast(&qsd), &cast(&qsdd));
    let expected = b.response(&cast(&qs), &cast(&qsd), &cast(&qsdd));
    // What Γ is made of is as large as its Jacobians times their arguments.
    let scale = expected.d_qs.array().largest() + expected.gamma.array().largest();
    let check = |field: &str, found: &dyn Numbers, expected: &dyn Numbers| {
        let what = format!("{label}: {field}");
        assert_close_on_scale(what, &found.array(), &expected.array(), tolerance, scale);
    };
    check("Gamma", &found.gamma, &expected.gamma);
    check("dGamma_dqs", &found.d_qs, &expected.d_qs);
    check("dGamma_dqsd", &found.d_qsd, &expected.d_qsd);
    check("dGamma_dqsdd", &found.d_qsdd, &expected.d_qsdd);
    let found = a.gamma_prime(&cast(&qs));
    check("GammaP", &found, &b.gamma_prime(&cast(&qs)));
    let qx = SVector::<f64, NX>::from_fn(|i, _| state.q[i]);
    let found = a.output(&cast(&qx), &cast(&qs));
    assert_close(format!("{label}: output"), &found, &b.output(&cast(&qx), &cast(&qs)), tolerance);
}
