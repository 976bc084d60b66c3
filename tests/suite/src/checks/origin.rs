//! The origin, where Theorem 1 lives and symbolic differentiation likes to divide zero by zero.

use crate::compare::Numbers;
use shapebot_dynamics::Robot;
use shapebot_dynamics::nalgebra::SVector;

/// Every function is finite at the origin, at rest and moving; the origin is an equilibrium.
///
/// # Panics
///
/// If not.
pub fn origin<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
) {
    let check = |what: &str, found: &dyn Numbers| {
        let entries = found.array().entries;
        assert!(
            entries.iter().all(|x| x.is_finite()),
            "{label}: {what} at the origin: {entries:?}"
        );
    };
    let q = SVector::<f64, N>::zeros();
    for qd in [q, SVector::repeat(0.5)] {
        let motion = robot.motion(&q, &qd);
        check("M", &motion.mass_matrix);
        check("Cqd", &motion.coriolis_vector);
        check("C", &robot.coriolis_matrix(&q, &qd));
        check("dM_dq", &robot.mass_matrix_jacobian(&q));
        check("dCqd_dq", &robot.coriolis_vector_jacobian_q(&q, &qd));
        check("dCqd_dqd", &robot.coriolis_vector_jacobian_qd(&q, &qd));
        check("dG_dq", &robot.gravity_jacobian(&q));
        check("energies", &[robot.kinetic_energy(&q, &qd), robot.potential_energy(&q)]);
        check("forward dynamics", &robot.forward_dynamics(&q, &qd, &q));
        check("center of mass", &robot.center_of_mass(&q));
        for point in 0..robot.description().points.len() {
            check("point Jacobian", &robot.point_jacobian(&q, point));
        }
        let (qs, qsd) =
            (SVector::<f64, NS>::zeros(), SVector::<f64, NS>::from_fn(|i, _| qd[NX + i]));
        let response = robot.response(&qs, &qsd, &qsd);
        check("Gamma", &response.gamma);
        check("dGamma_dqs", &response.d_qs);
        check("dGamma_dqsd", &response.d_qsd);
        check("dGamma_dqsdd", &response.d_qsdd);
    }
    let force = robot.gravity(&q).array().largest();
    let weight = robot.gravity_jacobian(&q).array().largest();
    assert!(force <= 1e-14 * weight, "{label}: gravity pulls with {force:e} at the origin");
}
