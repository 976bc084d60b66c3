//! Agreement with the reference states.

use super::EXACT;
use crate::compare::{Numbers, assert_close};
use crate::reference::Data;
use shapebot_dynamics::Robot;
use shapebot_dynamics::nalgebra::SVector;

/// All functions at all states of a reference file, to 1e-12 of the largest entry.
///
/// # Panics
///
/// If one of them is off, or the file is of another robot.
pub fn reference_states<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
    reference: &Data,
) {
    let names: Vec<&str> = robot.description().coordinates.iter().map(|c| c.name).collect();
    let expected = reference.get("coordinates").list();
    let expected: Vec<&str> = expected.iter().map(Data::text).collect();
    assert_eq!(names, expected, "{label}: coordinates");
    let states = reference.get("states").list();
    assert_eq!(states.len(), 20, "{label}: reference states");
    for (index, state) in states.iter().enumerate() {
        let check = |field: &str, found: &dyn Fn() -> crate::compare::Array| {
            let what = format!("{label}, state {index}: {field}");
            assert_close(what, &found(), &state.get(field), EXACT);
        };
        lagrangian(robot, state, &check);
        forward(robot, state, &check);
        shape(robot, state, &check);
    }
}

type Check<'a> = &'a dyn Fn(&str, &dyn Fn() -> crate::compare::Array);

fn lagrangian<const N: usize, const NX: usize, const NS: usize>(
    robot: &impl Robot<f64, N, NX, NS>,
    state: &Data,
    check: Check<'_>,
) {
    let [q, qd] = ["q", "qd"].map(|field| state.get(field).vector::<N>());
    check("M", &|| robot.mass_matrix(&q).array());
    check("C", &|| robot.coriolis_matrix(&q, &qd).array());
    check("Cqd", &|| robot.coriolis_vector(&q, &qd).array());
    check("G", &|| robot.gravity(&q).array());
    check("dM_dq", &|| robot.mass_matrix_jacobian(&q).array());
    check("dCqd_dq", &|| robot.coriolis_vector_jacobian_q(&q, &qd).array());
    check("dCqd_dqd", &|| robot.coriolis_vector_jacobian_qd(&q, &qd).array());
    check("dG_dq", &|| robot.gravity_jacobian(&q).array());
    check("kinetic", &|| robot.kinetic_energy(&q, &qd).array());
    check("potential", &|| robot.potential_energy(&q).array());
    let motion = robot.motion(&q, &qd);
    check("M", &|| motion.mass_matrix.array());
    check("Cqd", &|| motion.coriolis_vector.array());
    check("G", &|| motion.gravity.array());
}

/// q̈ under the file's forces, one per actuated coordinate in order.
fn forward<const N: usize, const NX: usize, const NS: usize>(
    robot: &impl Robot<f64, N, NX, NS>,
    state: &Data,
    check: Check<'_>,
) {
    let [q, qd] = ["q", "qd"].map(|field| state.get(field).vector::<N>());
    let mut tau = state.get("tau").array().entries.into_iter();
    let coordinates = robot.description().coordinates;
    let force = SVector::<f64, N>::from_fn(|i, _| {
        if coordinates[i].actuated {
            tau.next().expect("a force per actuated coordinate")
        } else {
            0.0
        }
    });
    assert_eq!(tau.next(), None, "more forces than actuated coordinates");
    check("qdd_fd", &|| robot.forward_dynamics(&q, &qd, &force).array());
}

fn shape<const N: usize, const NX: usize, const NS: usize>(
    robot: &impl Robot<f64, N, NX, NS>,
    state: &Data,
    check: Check<'_>,
) {
    let part = |field: &str| {
        let whole = state.get(field).vector::<N>();
        SVector::<f64, NS>::from_fn(|i, _| whole[NX + i])
    };
    let [qs, qsd, qsdd] = ["q", "qd", "qdd"].map(part);
    check("Gamma", &|| robot.gamma(&qs, &qsd, &qsdd).array());
    check("GammaP", &|| robot.gamma_prime(&qs).array());
    check("dGammaP_dqs", &|| robot.gamma_prime_jacobian(&qs).array());
    let response = robot.response(&qs, &qsd, &qsdd);
    check("Gamma", &|| response.gamma.array());
    check("dGamma_dqs", &|| response.d_qs.array());
    check("dGamma_dqsd", &|| response.d_qsd.array());
    check("dGamma_dqsdd", &|| response.d_qsdd.array());
}

/// K⁰_qs of a reference file, to 1e-13.
///
/// # Panics
///
/// If it is off.
pub fn shape_gain<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
    reference: &Data,
) {
    assert_close(format!("{label}: K0_qs"), &robot.shape_gain(), &reference.get("K0_qs"), 1e-13);
}
