//! Model files through the interpreter.

use super::{Dynamics, ModelText, derive, not_shape_accelerated, plants};
use crate::commands::eval::{Field, Results, Selection, State};
use crate::failure::{Failure, Outcome};
use shapebot_codegen::derive::{Derivation, Parameters, Quantity};
use shapebot_dynamics::Description;
use shapebot_dynamics::control::ControlDesign;
use shapebot_experiments::{AnyRobot, AnySystem, Plants, Settings, SizedRobot, Supported};
use shapebot_interpreter::Interpreted as Interpreter;
use shapebot_interpreter::{Error, Tapes, check_parameters, with_interpreted};
use shapebot_model_dsl::model::Parameter;
use shapebot_planning::Refusal;
use std::cell::{OnceCell, RefCell};

/// Reads, derives and compiles a model to tapes.
pub(crate) fn open(text: &ModelText, set: &[(String, f64)]) -> Outcome<Box<dyn Dynamics>> {
    let derivation = derive(text, Parameters::Symbolic)?;
    let values = parameter_values(&derivation, set)?;
    let tapes = Tapes::new(&derivation, &values).map_err(Failure::usage)?;
    let (name, scratch, design) = (text.name.clone(), RefCell::default(), OnceCell::new());
    let source = Source { derivation, set: set.to_vec() };
    let robot = any_robot(tapes.clone());
    Ok(Box::new(Interpreted { name, tapes, scratch, source, robot, design }))
}

/// The functions behind the runtime traits, at the model's sizes.
fn any_robot(tapes: Tapes<f64>) -> Result<AnyRobot, Error> {
    with_interpreted!(tapes, |robot| any(robot))
}

fn any<const N: usize, const NX: usize, const NS: usize>(robot: Interpreter<N, NX, NS>) -> AnyRobot
where
    SizedRobot<N, NX, NS>: Supported,
{
    let robot: Box<SizedRobot<N, NX, NS>> = Box::new(robot);
    robot.any()
}

fn any_system<const N: usize, const NX: usize, const NS: usize>(
    robot: Interpreter<N, NX, NS>,
) -> AnySystem {
    AnySystem::new::<N>(Box::new(robot))
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
    source: Source,
    robot: Result<AnyRobot, Error>,
    /// Made when it is asked for.
    design: OnceCell<Result<&'static ControlDesign, String>>,
}

/// Where the functions come from.
struct Source {
    derivation: Derivation,
    /// Parameters that are set.
    set: Vec<(String, f64)>,
}

impl Plants for Source {
    fn plant(&self, model: Option<&str>, set: &Settings) -> Result<AnySystem, Refusal> {
        let set = plants::merged(&self.set, set);
        if let Some(model) = model {
            return plants::other(model, &set);
        }
        let values = parameter_values(&self.derivation, &set)?;
        let tapes = Tapes::new(&self.derivation, &values).map_err(Refusal::task)?;
        let system = with_interpreted!(tapes, |robot| any_system(robot));
        system.map_err(Refusal::task)
    }
}

/// Memory that is used again from state to state.
#[derive(Default)]
struct Scratch {
    force: Vec<f64>,
    results: Vec<f64>,
}

impl Interpreted {
    fn designed(&self) -> Outcome<&'static ControlDesign> {
        let design = self.design.get_or_init(|| {
            let design = shapebot_synthesis::design(&self.source.derivation)?;
            // Lives as long as the program, once per robot.
            Ok(&*Box::leak(Box::new(design)))
        });
        design.as_ref().copied().map_err(|reason| {
            Failure::refused(format!("no controller for `{}`: {reason}", self.name))
        })
    }

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

    fn evaluate(&self, selection: &Selection, state: &State, results: &mut Results) {
        // A field that a derivation lacks stays empty and is printed as null.
        let _ = self.fill(selection, state, results);
    }

    fn is_shape_accelerated(&self) -> bool {
        self.tapes.has(Quantity::Response)
    }

    fn robot(&self) -> Outcome<&AnyRobot> {
        match &self.robot {
            Err(Error::NotShapeAccelerated { .. }) => Err(not_shape_accelerated(&self.name)),
            robot => robot.as_ref().map_err(Failure::refused),
        }
    }

    fn control(&self) -> Outcome<&'static ControlDesign> {
        self.designed()
    }

    fn plants(&self) -> &dyn Plants {
        &self.source
    }
}
