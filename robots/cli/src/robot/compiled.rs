//! Generated code behind the tool's own interface.

use super::Dynamics;
use crate::commands::eval::{Field, Results, Selection, State};
use crate::failure::Outcome;
use crate::planning::{self, PlanTask, PlannedMotion};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Description, Robot};

/// A type that implements the runtime traits.
pub(crate) struct Compiled<R, const N: usize, const NX: usize, const NS: usize>(pub(crate) R);

impl<R, const N: usize, const NX: usize, const NS: usize> Compiled<R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    /// M, C q̇ and G.
    fn fill_motion(&self, selection: &Selection, q: &SVector<f64, N>, qd: &SVector<f64, N>, results: &mut Results) {
        if selection.several(&[Field::MassMatrix, Field::CoriolisVector, Field::Gravity]) {
            let motion = self.0.motion(q, qd);
            put(results, Field::MassMatrix, &motion.mass_matrix);
            put(results, Field::CoriolisVector, &motion.coriolis_vector);
            put(results, Field::Gravity, &motion.gravity);
        } else if selection.contains(Field::MassMatrix) {
            put(results, Field::MassMatrix, &self.0.mass_matrix(q));
        } else if selection.contains(Field::CoriolisVector) {
            put(results, Field::CoriolisVector, &self.0.coriolis_vector(q, qd));
        } else if selection.contains(Field::Gravity) {
            put(results, Field::Gravity, &self.0.gravity(q));
        }
    }

    /// The remaining functions of the Lagrangian system.
    fn fill_lagrangian(
        &self,
        field: Field,
        [q, qd]: [&SVector<f64, N>; 2],
        tau: &[f64],
        results: &mut Results,
    ) {
        let robot = &self.0;
        match field {
            Field::CoriolisMatrix => put(results, field, &robot.coriolis_matrix(q, qd)),
            Field::MassMatrixJacobian => {
                results.clear(field);
                for layer in &robot.mass_matrix_jacobian(q) {
                    append(results, field, layer);
                }
            }
            Field::CoriolisVectorJacobianQ => put(results, field, &robot.coriolis_vector_jacobian_q(q, qd)),
            Field::CoriolisVectorJacobianQd => put(results, field, &robot.coriolis_vector_jacobian_qd(q, qd)),
            Field::GravityJacobian => put(results, field, &robot.gravity_jacobian(q)),
            Field::Kinetic => results.clear(field).push(robot.kinetic_energy(q, qd)),
            Field::Potential => results.clear(field).push(robot.potential_energy(q)),
            Field::ForwardDynamics => {
                let force = self.force(q, tau);
                put(results, field, &robot.forward_dynamics(q, qd, &force));
            }
            _ => {}
        }
    }

    /// f = B τ.
    fn force(&self, q: &SVector<f64, N>, tau: &[f64]) -> SVector<f64, N> {
        let columns = tau.iter().enumerate().map(|(i, &tau)| self.0.input_column(q, i) * tau);
        columns.fold(SVector::zeros(), |sum, column| sum + column)
    }

    /// Functions of the shape.
    fn fill_shape(&self, selection: &Selection, state: [&SVector<f64, NS>; 3], results: &mut Results) {
        let (robot, [qs, qsd, qsdd]) = (&self.0, state);
        let jacobians = [Field::GammaJacobianQs, Field::GammaJacobianQsd, Field::GammaJacobianQsdd];
        if jacobians.iter().any(|field| selection.contains(*field)) {
            let response = robot.response(qs, qsd, qsdd);
            put(results, Field::Gamma, &response.gamma);
            put(results, Field::GammaJacobianQs, &response.d_qs);
            put(results, Field::GammaJacobianQsd, &response.d_qsd);
            put(results, Field::GammaJacobianQsdd, &response.d_qsdd);
        } else if selection.contains(Field::Gamma) {
            put(results, Field::Gamma, &robot.gamma(qs, qsd, qsdd));
        }
        if selection.contains(Field::GammaPrime) {
            put(results, Field::GammaPrime, &robot.gamma_prime(qs));
        }
        if selection.contains(Field::GammaPrimeJacobian) {
            put(results, Field::GammaPrimeJacobian, &robot.gamma_prime_jacobian(qs));
        }
        if selection.contains(Field::ShapeGain) {
            put(results, Field::ShapeGain, &robot.shape_gain());
        }
    }
}

fn put<const R: usize, const C: usize>(results: &mut Results, field: Field, matrix: &SMatrix<f64, R, C>) {
    results.clear(field);
    append(results, field, matrix);
}

/// Row by row; nalgebra stores columns.
fn append<const R: usize, const C: usize>(results: &mut Results, field: Field, matrix: &SMatrix<f64, R, C>) {
    let values = results.memory(field);
    for row in 0..R {
        values.extend(matrix.row(row).iter());
    }
}

impl<R, const N: usize, const NX: usize, const NS: usize> Dynamics for Compiled<R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    fn description(&self) -> &Description {
        self.0.description()
    }

    fn is_shape_accelerated(&self) -> bool {
        true
    }

    fn evaluate(&self, selection: &Selection, state: &State, results: &mut Results) {
        let vector = |values: &[f64]| SVector::<f64, N>::from_fn(|i, _| values[i]);
        let shape = |values: &[f64]| SVector::<f64, NS>::from_fn(|i, _| values[NX + i]);
        let (q, qd) = (vector(&state.q), vector(&state.qd));
        self.fill_motion(selection, &q, &qd, results);
        for field in selection.iter() {
            self.fill_lagrangian(field, [&q, &qd], &state.tau, results);
        }
        let (qs, qsd, qsdd) = (shape(&state.q), shape(&state.qd), shape(&state.qdd));
        self.fill_shape(selection, [&qs, &qsd, &qsdd], results);
    }

    fn plan(&self, task: &PlanTask) -> Outcome<PlannedMotion> {
        planning::plan(&self.0, task)
    }
}
