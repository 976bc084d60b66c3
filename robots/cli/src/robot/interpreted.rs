//! Model files through the interpreter.

use super::{Dynamics, ModelText, derive, not_shape_accelerated};
use crate::commands::eval::{Field, Results, Selection, State};
use crate::failure::{Failure, Outcome};
use shapebot_planning::PlannedMotion;
use shapebot_codegen::derive::{Derivation, Parameters, Quantity};
use shapebot_dynamics::Description;
use shapebot_interpreter::{Error, Tapes, check_parameters, with_interpreted};
use shapebot_model_dsl::model::Parameter;
use shapebot_planner::value::RobotId;
use shapebot_tasks::Task;
use std::cell::RefCell;

/// Reads, derives and compiles a model to tapes.
pub(crate) fn open(text: &ModelText, set: &[(String, f64)]) -> Outcome<Box<dyn Dynamics>> {
    let derivation = derive(text, Parameters::Symbolic)?;
    let values = parameter_values(&derivation, set)?;
    let tapes = Tapes::new(&derivation, &values).map_err(Failure::usage)?;
    Ok(Box::new(Interpreted { name: text.name.clone(), tapes, scratch: RefCell::default() }))
}

/// Values of all parameters: those set by name, the model's own for the rest.
fn parameter_values(derivation: &Derivation, set: &[(String, f64)]) -> Outcome<Vec<f64>> {
    let parameters = &derivation.model.parameters;
    let mut values: Vec<f64> = parameters.iter().map(|parameter| parameter.value_f64).collect();
    let mut seen = Vec::new();
    for (name, value) in set {
        let known = |p: &Parameter| p.name == *name || p.path == *name;
        let Some(i) = parameters.iter().position(known) else {
            return Err(Failure::unknown("parameter", name, parameters.iter().map(|p| &*p.name)));
        };
        if seen.contains(&i) {
            return Err(Failure::usage(format!("parameter `{name}` is set twice")));
        }
        seen.push(i);
        values[i] = *value;
    }
    check_parameters(derivation, &values).map_err(Failure::usage)?;
    Ok(values)
}

struct Interpreted {
    /// The file, for messages.
    name: String,
    tapes: Tapes<f64>,
    scratch: RefCell<Scratch>,
}

/// Memory that is used again from state to state.
#[derive(Default)]
struct Scratch {
    force: Vec<f64>,
    results: Vec<f64>,
}

impl Interpreted {
    /// f = B τ.
    fn force(&self, state: &State, scratch: &mut Scratch) -> Result<(), Error> {
        scratch.force.clear();
        scratch.force.resize(state.q.len(), 0.0);
        for (actuator, &tau) in state.tau.iter().enumerate() {
            self.run(Quantity::InputColumn(actuator), state, &[], &mut scratch.results)?;
            for (force, column) in scratch.force.iter_mut().zip(&scratch.results) {
                *force += column * tau;
            }
        }
        Ok(())
    }

    fn run(
        &self,
        quantity: Quantity,
        state: &State,
        force: &[f64],
        results: &mut Vec<f64>,
    ) -> Result<(), Error> {
        results.resize(self.tapes.result_count(quantity)?, 0.0);
        let state =
            shapebot_interpreter::State { q: &state.q, qd: &state.qd, qdd: &state.qdd, force };
        self.tapes.evaluate(quantity, &state, results)
    }

    fn fill(
        &self,
        selection: &Selection,
        state: &State,
        results: &mut Results,
    ) -> Result<(), Error> {
        let scratch = &mut *self.scratch.borrow_mut();
        if selection.contains(Field::ForwardDynamics) {
            self.force(state, scratch)?;
        }
        for (quantity, fields) in schedule(selection) {
            self.run(quantity, state, &scratch.force, &mut scratch.results)?;
            let blocks = self.tapes.blocks(quantity)?;
            for (block, field) in blocks.iter().zip(fields) {
                let count: usize = block.extents.iter().product();
                let values = scratch.results.get(block.offset..block.offset + count).unwrap_or(&[]);
                results.clear(*field).extend_from_slice(values);
            }
        }
        Ok(())
    }
}

const MOTION: [Field; 3] = [Field::MassMatrix, Field::CoriolisVector, Field::Gravity];

const RESPONSE: [Field; 4] =
    [Field::Gamma, Field::GammaJacobianQs, Field::GammaJacobianQsd, Field::GammaJacobianQsdd];

/// Which functions to run, with the fields that their blocks are: bundles where they pay.
fn schedule(selection: &Selection) -> impl Iterator<Item = (Quantity, &'static [Field])> + '_ {
    let motion = selection.several(&MOTION);
    // Jacobians of Γ come in its bundle only.
    let response = RESPONSE[1..].iter().any(|field| selection.contains(*field));
    let bundles = [
        motion.then_some((Quantity::Motion, &MOTION[..])),
        response.then_some((Quantity::Response, &RESPONSE[..])),
    ];
    let single = selection.iter().filter_map(move |field| {
        let bundled = motion && MOTION.contains(&field) || response && RESPONSE.contains(&field);
        alone(field).filter(|_| !bundled)
    });
    bundles.into_iter().flatten().chain(single)
}

/// The function that is one field.
const fn alone(field: Field) -> Option<(Quantity, &'static [Field])> {
    Some(match field {
        Field::MassMatrix => (Quantity::MassMatrix, &[Field::MassMatrix]),
        Field::CoriolisMatrix => (Quantity::CoriolisMatrix, &[Field::CoriolisMatrix]),
        Field::CoriolisVector => (Quantity::CoriolisVector, &[Field::CoriolisVector]),
        Field::Gravity => (Quantity::Gravity, &[Field::Gravity]),
        Field::Gamma => (Quantity::Gamma, &[Field::Gamma]),
        Field::GammaPrime => (Quantity::GammaPrime, &[Field::GammaPrime]),
        Field::MassMatrixJacobian => (Quantity::MassMatrixJacobian, &[Field::MassMatrixJacobian]),
        Field::CoriolisVectorJacobianQ => {
            (Quantity::CoriolisVectorJacobianQ, &[Field::CoriolisVectorJacobianQ])
        }
        Field::CoriolisVectorJacobianQd => {
            (Quantity::CoriolisVectorJacobianQd, &[Field::CoriolisVectorJacobianQd])
        }
        Field::GravityJacobian => (Quantity::GravityJacobian, &[Field::GravityJacobian]),
        Field::GammaPrimeJacobian => (Quantity::GammaPrimeJacobian, &[Field::GammaPrimeJacobian]),
        Field::Kinetic => (Quantity::KineticEnergy, &[Field::Kinetic]),
        Field::Potential => (Quantity::PotentialEnergy, &[Field::Potential]),
        Field::ForwardDynamics => (Quantity::ForwardDynamics, &[Field::ForwardDynamics]),
        Field::ShapeGain => (Quantity::ShapeGain, &[Field::ShapeGain]),
        Field::GammaJacobianQs | Field::GammaJacobianQsd | Field::GammaJacobianQsdd => return None,
    })
}

impl Dynamics for Interpreted {
    fn description(&self) -> &Description {
        self.tapes.description()
    }

    fn is_shape_accelerated(&self) -> bool {
        self.tapes.has(Quantity::Response)
    }

    fn evaluate(&self, selection: &Selection, state: &State, results: &mut Results) {
        // A field that a derivation lacks stays empty and is printed as null.
        let _ = self.fill(selection, state, results);
    }

    fn plan(&self, task: &Task, id: &RobotId<'_>) -> Outcome<PlannedMotion> {
        if !self.is_shape_accelerated() {
            return Err(not_shape_accelerated(&self.name));
        }
        let tapes = self.tapes.clone();
        let planned = with_interpreted!(tapes, |robot| shapebot_planning::plan(&robot, task, id));
        Ok(planned.map_err(Failure::refused)??)
    }
}
