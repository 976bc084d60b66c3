//! Generated code behind the tool's own interface.

use super::{Dynamics, not_shape_accelerated, plants};
use crate::commands::eval::{Field, Results, Selection, State};
use crate::failure::{Failure, Outcome};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::control::ControlDesign;
use shapebot_dynamics::{Description, LagrangianSystem, ShapeAccelerated};
use shapebot_experiments::{AnyRobot, AnySystem, Plants, Settings, System, with_sized};
use shapebot_planning::Refusal;

/// A Lagrangian system without Γ.
pub(crate) struct Lagrangian<const N: usize>(pub(crate) Box<System<N>>);

/// A robot.
pub(crate) struct Compiled {
    pub(crate) robot: AnyRobot,
    /// Another one, with some parameters set.
    pub(crate) system: fn(&Settings) -> Outcome<AnySystem>,
    /// Those that are set.
    pub(crate) set: Vec<(String, f64)>,
    pub(crate) design: Option<&'static ControlDesign>,
}

impl<const N: usize> Dynamics for Lagrangian<N> {
    fn description(&self) -> &Description {
        self.0.description()
    }

    fn evaluate(&self, selection: &Selection, state: &State, results: &mut Results) {
        fill_lagrangian(&*self.0, selection, state, results);
    }

    fn is_shape_accelerated(&self) -> bool {
        false
    }

    fn robot(&self) -> Outcome<&AnyRobot> {
        Err(not_shape_accelerated(self.0.description().name))
    }

    fn control(&self) -> Outcome<&'static ControlDesign> {
        Err(no_design(self.0.description().name))
    }

    fn plants(&self) -> &dyn Plants {
        &NoPlants
    }
}

/// Without Γ there is nothing to simulate.
struct NoPlants;

impl Plants for NoPlants {
    fn plant(&self, _: Option<&str>, _: &Settings) -> Result<AnySystem, Refusal> {
        Err(Refusal::plan("the model is not shape-accelerated"))
    }
}

impl Dynamics for Compiled {
    fn description(&self) -> &Description {
        self.robot.description()
    }

    fn evaluate(&self, selection: &Selection, state: &State, results: &mut Results) {
        with_sized!(&self.robot, |robot| {
            fill_lagrangian(robot, selection, state, results);
            fill_shape(robot, selection, state, results);
        });
    }

    fn is_shape_accelerated(&self) -> bool {
        true
    }

    fn robot(&self) -> Outcome<&AnyRobot> {
        Ok(&self.robot)
    }

    fn control(&self) -> Outcome<&'static ControlDesign> {
        self.design.ok_or_else(|| no_design(self.description().name))
    }

    fn plants(&self) -> &dyn Plants {
        self
    }
}

impl Plants for Compiled {
    fn plant(&self, model: Option<&str>, set: &Settings) -> Result<AnySystem, Refusal> {
        let set = plants::merged(&self.set, set);
        match model {
            Some(model) => plants::other(model, &set),
            None => Ok((self.system)(&set)?),
        }
    }
}

/// Why there is no controller.
fn no_design(name: &str) -> Failure {
    Failure::refused(format!(
        "no gains were found that make the linearised loop of `{name}` stable"
    ))
}

/// The functions of a Lagrangian system.
fn fill_lagrangian<const N: usize>(
    robot: &dyn LagrangianSystem<f64, N>,
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
fn force<const N: usize>(
    robot: &dyn LagrangianSystem<f64, N>,
    q: &SVector<f64, N>,
    tau: &[f64],
) -> SVector<f64, N> {
    let columns = tau.iter().enumerate().map(|(i, &tau)| robot.input_column(q, i) * tau);
    columns.fold(SVector::zeros(), |sum, column| sum + column)
}

/// Functions of the shape.
fn fill_shape<const NX: usize, const NS: usize>(
    robot: &dyn ShapeAccelerated<f64, NX, NS>,
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
