//! Model files through the interpreter.

use super::{Dynamics, ModelText, RunsOf, Then, closed_loop, derive, not_shape_accelerated};
use crate::commands::eval::{Field, Results, Selection, State};
use crate::failure::{Failure, Outcome};
use shapebot_codegen::derive::{Derivation, Parameters, Quantity};
use shapebot_dynamics::Description;
use shapebot_dynamics::control::ControlDesign;
use shapebot_experiments::{Experiment, Plants, Settings, Subject, System};
use shapebot_interpreter::{self as interpreter, Error, Tapes, check_parameters, with_interpreted};
use shapebot_model_dsl::model::Parameter;
use shapebot_planner::value::RobotId;
use shapebot_planning::PlannedMotion;
use shapebot_planning::Refusal;
use shapebot_tasks::Task;
use std::cell::{OnceCell, RefCell};

/// Reads, derives and compiles a model to tapes.
pub(crate) fn open(text: &ModelText, set: &[(String, f64)]) -> Outcome<Box<dyn Dynamics>> {
    let derivation = derive(text, Parameters::Symbolic)?;
    let values = parameter_values(&derivation, set)?;
    let tapes = Tapes::new(&derivation, &values).map_err(Failure::usage)?;
    let (name, scratch, design) = (text.name.clone(), RefCell::default(), OnceCell::new());
    let source = Source { derivation, set: set.to_vec() };
    Ok(Box::new(Interpreted { name, tapes, scratch, source, design }))
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
    /// Made when it is asked for.
    design: OnceCell<Result<&'static ControlDesign, String>>,
}

/// Where the functions come from.
struct Source {
    derivation: Derivation,
    /// Parameters that are set.
    set: Vec<(String, f64)>,
}

/// Plants of N coordinates from a derivation.
struct Derived<'s, const N: usize, const NX: usize, const NS: usize>(&'s Source);

impl<const N: usize, const NX: usize, const NS: usize> Plants<N> for Derived<'_, N, NX, NS> {
    fn plant(&self, model: Option<&str>, set: &Settings) -> Result<Box<System<N>>, Refusal> {
        let set = closed_loop::merged(&self.0.set, set);
        if let Some(model) = model {
            return closed_loop::other(model, &set);
        }
        let values = parameter_values(&self.0.derivation, &set)?;
        let robot = interpreter::Interpreted::<N, NX, NS>::new(&self.0.derivation, &values);
        Ok(Box::new(robot.map_err(Refusal::task)?))
    }
}

/// What is done with a robot of known sizes.
enum Errand<'a> {
    Simulate(&'a Task, &'a PlannedMotion, &'a RobotId<'a>, &'a mut Option<Experiment>),
    Runs(&'a RunsOf<'a>, &'a mut Then<'a>),
    Poles(&'a mut Vec<[f64; 2]>),
}

fn run_errand<const N: usize, const NX: usize, const NS: usize>(
    robot: &interpreter::Interpreted<N, NX, NS>,
    source: &Source,
    design: &'static ControlDesign,
    errand: Errand<'_>,
) -> Outcome {
    let plants = Derived::<N, NX, NS>(source);
    let subject = Subject { model: robot, design, plants: &plants };
    match errand {
        Errand::Simulate(task, planned, id, to) => {
            *to = Some(shapebot_experiments::run(subject, task, planned, id)?);
        }
        Errand::Runs(runs, then) => closed_loop::with_runs(subject, runs, then)?,
        Errand::Poles(to) => *to = closed_loop::poles(robot)?,
    }
    Ok(())
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

    fn run_errand(&self, errand: Errand<'_>) -> Outcome {
        if !self.is_shape_accelerated() {
            return Err(not_shape_accelerated(&self.name));
        }
        let design = self.designed()?;
        let (source, tapes) = (&self.source, self.tapes.clone());
        let done = with_interpreted!(tapes, |robot| run_errand(&robot, source, design, errand));
        done.map_err(Failure::refused)?
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

    fn simulate(
        &self,
        task: &Task,
        planned: &PlannedMotion,
        id: &RobotId<'_>,
    ) -> Outcome<Experiment> {
        let mut experiment = None;
        self.run_errand(Errand::Simulate(task, planned, id, &mut experiment))?;
        experiment.ok_or_else(|| not_shape_accelerated(&self.name))
    }

    fn with_runs(&self, runs: &RunsOf<'_>, then: &mut Then<'_>) -> Outcome {
        self.run_errand(Errand::Runs(runs, &mut |runs| then(runs)))
    }

    fn design(&self) -> Outcome<(&'static ControlDesign, Vec<[f64; 2]>)> {
        let mut poles = Vec::new();
        self.run_errand(Errand::Poles(&mut poles))?;
        Ok((self.designed()?, poles))
    }
}
