//! Generated code behind the tool's own interface.

use super::{Dynamics, RunsOf, Then, closed_loop, not_shape_accelerated};
use crate::commands::eval::{Field, Results, Selection, State};
use crate::failure::Outcome;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::control::ControlDesign;
use shapebot_dynamics::{Description, LagrangianSystem, Robot, ShapeAccelerated};
use shapebot_experiments::{Experiment, Plants, Settings, Subject, System};
use shapebot_planner::value::RobotId;
use shapebot_planning::PlannedMotion;
use shapebot_planning::Refusal;
use shapebot_tasks::Task;

/// A Lagrangian system without Γ.
pub(crate) struct Lagrangian<R, const N: usize>(pub(crate) R);

/// A robot.
pub(crate) struct Compiled<R, const N: usize, const NX: usize, const NS: usize> {
    pub(crate) robot: R,
    /// Another one, with some parameters set.
    pub(crate) make: fn(&Settings) -> Outcome<R>,
    /// Those that are set.
    pub(crate) set: Vec<(String, f64)>,
    pub(crate) design: Option<&'static ControlDesign>,
}

impl<R: LagrangianSystem<f64, N>, const N: usize> Dynamics for Lagrangian<R, N> {
    fn description(&self) -> &Description {
        self.0.description()
    }

    fn is_shape_accelerated(&self) -> bool {
        false
    }

    fn evaluate(&self, selection: &Selection, state: &State, results: &mut Results) {
        fill_lagrangian(&self.0, selection, state, results);
    }

    fn plan(&self, _task: &Task, _id: &RobotId<'_>) -> Outcome<PlannedMotion> {
        Err(not_shape_accelerated(self.0.description().name))
    }

    fn simulate(&self, _: &Task, _: &PlannedMotion, _: &RobotId<'_>) -> Outcome<Experiment> {
        Err(not_shape_accelerated(self.0.description().name))
    }

    fn with_runs(&self, _: &RunsOf<'_>, _: &mut Then<'_>) -> Outcome {
        Err(not_shape_accelerated(self.0.description().name))
    }

    fn design(&self) -> Outcome<(&'static ControlDesign, Vec<[f64; 2]>)> {
        Err(not_shape_accelerated(self.0.description().name))
    }
}

impl<R, const N: usize, const NX: usize, const NS: usize> Dynamics for Compiled<R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS> + Sync + 'static,
{
    fn description(&self) -> &Description {
        self.robot.description()
    }

    fn is_shape_accelerated(&self) -> bool {
        true
    }

    fn evaluate(&self, selection: &Selection, state: &State, results: &mut Results) {
        fill_lagrangian(&self.robot, selection, state, results);
        fill_shape(&self.robot, selection, state, results);
    }

    fn plan(&self, task: &Task, id: &RobotId<'_>) -> Outcome<PlannedMotion> {
        Ok(shapebot_planning::plan(&self.robot, task, id)?)
    }

    fn simulate(
        &self,
        task: &Task,
        planned: &PlannedMotion,
        id: &RobotId<'_>,
    ) -> Outcome<Experiment> {
        Ok(shapebot_experiments::run(self.subject()?, task, planned, id)?)
    }

    fn with_runs(&self, runs: &RunsOf<'_>, then: &mut Then<'_>) -> Outcome {
        closed_loop::with_runs(self.subject()?, runs, then)
    }

    fn design(&self) -> Outcome<(&'static ControlDesign, Vec<[f64; 2]>)> {
        Ok((self.designed()?, closed_loop::poles(&self.robot)?))
    }
}

impl<R, const N: usize, const NX: usize, const NS: usize> Compiled<R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS> + Sync + 'static,
{
    fn designed(&self) -> Outcome<&'static ControlDesign> {
        self.design.ok_or_else(|| closed_loop::no_design(self.robot.description().name))
    }

    fn subject(&self) -> Outcome<Subject<'_, R, N>> {
        Ok(Subject { model: &self.robot, design: self.designed()?, plants: self })
    }
}

impl<R, const N: usize, const NX: usize, const NS: usize> Plants<N> for Compiled<R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS> + Sync + 'static,
{
    fn plant(&self, model: Option<&str>, set: &Settings) -> Result<Box<System<N>>, Refusal> {
        let set = closed_loop::merged(&self.set, set);
        match model {
            Some(model) => closed_loop::other(model, &set),
            None => Ok(Box::new((self.make)(&set)?)),
        }
    }
}

/// The functions of a Lagrangian system.
fn fill_lagrangian<R: LagrangianSystem<f64, N>, const N: usize>(
    robot: &R,
    selection: &Selection,
    state: &State,
    results: &mut Results,
) {
    let vector = |values: &[f64]| SVector::<f64, N>::from_fn(|i, _| values[i]);
    let (q, qd) = (vector(&state.q), vector(&state.qd));
    let together = selection.several(&[Field::MassMatrix, Field::CoriolisVector, Field::Gravity]);
    if together {
        let motion = robot.motion(&q, &qd);
        put(results, Field::MassMatrix, &motion.mass_matrix);
        put(results, Field::CoriolisVector, &motion.coriolis_vector);
        put(results, Field::Gravity, &motion.gravity);
    }
    for field in selection.iter() {
        match field {
            Field::MassMatrix if !together => put(results, field, &robot.mass_matrix(&q)),
            Field::CoriolisVector if !together => {
                put(results, field, &robot.coriolis_vector(&q, &qd))
            }
            Field::Gravity if !together => put(results, field, &robot.gravity(&q)),
            Field::CoriolisMatrix => put(results, field, &robot.coriolis_matrix(&q, &qd)),
            Field::MassMatrixJacobian => {
                put_layers(results, field, &robot.mass_matrix_jacobian(&q))
            }
            Field::CoriolisVectorJacobianQ => {
                put(results, field, &robot.coriolis_vector_jacobian_q(&q, &qd));
            }
            Field::CoriolisVectorJacobianQd => {
                put(results, field, &robot.coriolis_vector_jacobian_qd(&q, &qd));
            }
            Field::GravityJacobian => put(results, field, &robot.gravity_jacobian(&q)),
            Field::Kinetic => results.clear(field).push(robot.kinetic_energy(&q, &qd)),
            Field::Potential => results.clear(field).push(robot.potential_energy(&q)),
            Field::ForwardDynamics => {
                let force = force(robot, &q, &state.tau);
                put(results, field, &robot.forward_dynamics(&q, &qd, &force));
            }
            _ => {}
        }
    }
}

/// f = B τ.
fn force<R: LagrangianSystem<f64, N>, const N: usize>(
    robot: &R,
    q: &SVector<f64, N>,
    tau: &[f64],
) -> SVector<f64, N> {
    let columns = tau.iter().enumerate().map(|(i, &tau)| robot.input_column(q, i) * tau);
    columns.fold(SVector::zeros(), |sum, column| sum + column)
}

/// Functions of the shape.
fn fill_shape<R: ShapeAccelerated<f64, NX, NS>, const NX: usize, const NS: usize>(
    robot: &R,
    selection: &Selection,
    state: &State,
    results: &mut Results,
) {
    let shape = |values: &[f64]| SVector::<f64, NS>::from_fn(|i, _| values[NX + i]);
    let (qs, qsd, qsdd) = (shape(&state.q), shape(&state.qd), shape(&state.qdd));
    let jacobians = [Field::GammaJacobianQs, Field::GammaJacobianQsd, Field::GammaJacobianQsdd];
    if jacobians.iter().any(|field| selection.contains(*field)) {
        let response = robot.response(&qs, &qsd, &qsdd);
        put(results, Field::Gamma, &response.gamma);
        put(results, Field::GammaJacobianQs, &response.d_qs);
        put(results, Field::GammaJacobianQsd, &response.d_qsd);
        put(results, Field::GammaJacobianQsdd, &response.d_qsdd);
    } else if selection.contains(Field::Gamma) {
        put(results, Field::Gamma, &robot.gamma(&qs, &qsd, &qsdd));
    }
    for field in selection.iter() {
        match field {
            Field::GammaPrime => put(results, field, &robot.gamma_prime(&qs)),
            Field::GammaPrimeJacobian => put(results, field, &robot.gamma_prime_jacobian(&qs)),
            Field::ShapeGain => put(results, field, &robot.shape_gain()),
            _ => {}
        }
    }
}

fn put<const R: usize, const C: usize>(
    results: &mut Results,
    field: Field,
    matrix: &SMatrix<f64, R, C>,
) {
    put_layers(results, field, std::slice::from_ref(matrix));
}

/// Layer by layer, row by row; nalgebra stores columns.
fn put_layers<const R: usize, const C: usize>(
    results: &mut Results,
    field: Field,
    layers: &[SMatrix<f64, R, C>],
) {
    let values = results.clear(field);
    for layer in layers {
        for row in 0..R {
            values.extend(layer.row(row).iter());
        }
    }
}
