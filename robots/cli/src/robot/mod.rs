//! Robots: bundled ones run compiled code, model files go through the interpreter.

mod bundled;
mod compiled;
mod interpreted;
mod plants;
mod text;

pub(crate) use bundled::{Bundled, bundled};
pub(crate) use text::{ModelText, derive, prove, rederive};

use crate::commands::eval::{Results, Selection, Sizes, State};
use crate::failure::{Failure, Outcome};
use shapebot_dynamics::Description;
use shapebot_dynamics::control::ControlDesign;
use shapebot_experiments::{AnyRobot, Driven, Experiment, Planned, Plants, Runs};
use shapebot_planner::value::RobotId;
use shapebot_planning::PlannedMotion;
use shapebot_tasks::Task;
use std::path::Path;

/// A robot of any size whose parameters are set.
pub(crate) trait Dynamics {
    /// Names, units, ranges, actuators and shape sets.
    fn description(&self) -> &Description;

    /// Computes the selected fields at a state whose vectors have the robot's lengths.
    fn evaluate(&self, selection: &Selection, state: &State, results: &mut Results);

    /// Whether there is Γ.
    fn is_shape_accelerated(&self) -> bool;

    /// The robot for planning and simulation, or why there is none.
    fn robot(&self) -> Outcome<&AnyRobot>;

    /// The controller's design, or why there is none.
    fn control(&self) -> Outcome<&'static ControlDesign>;

    /// Makes plants.
    fn plants(&self) -> &dyn Plants;

    /// Plans a motion; `id` is what the plan's files say about the robot.
    fn plan(&self, task: &Task, id: &RobotId<'_>) -> Outcome<PlannedMotion> {
        Ok(self.robot()?.plan(task, id)?)
    }

    /// Lets a controller follow a planned motion of the robot, as the task says.
    fn simulate(&self, planned: Planned<'_>) -> Outcome<Experiment> {
        Ok(self.robot()?.simulate(self.driven()?, planned)?)
    }

    /// Random runs of a planned motion of a task's name: seed and number of runs.
    fn trials<'a>(
        &'a self,
        planned: (&str, Planned<'a>),
        runs: [u64; 2],
    ) -> Outcome<Box<dyn Runs + 'a>> {
        Ok(self.robot()?.trials(self.driven()?, planned, runs)?)
    }

    /// Gains and plants.
    fn driven(&self) -> Outcome<Driven<'_>> {
        Ok(Driven { design: self.control()?, plants: self.plants() })
    }

    /// Numbers of coordinates.
    fn sizes(&self) -> Sizes {
        let description = self.description();
        let (all, position) = (description.coordinates.len(), description.position_count);
        Sizes { all, position, shape: all - position }
    }
}

/// What the user names: a model file or a bundled robot.
pub(crate) enum Source {
    /// A model file that was read.
    File(ModelText),
    /// A robot that was compiled in.
    Bundled(&'static Bundled),
}

/// Finds what the user names: an existing path or a name that ends in `.robot` is a file, everything
/// else a bundled robot.
pub(crate) fn open(name: &str) -> Outcome<Source> {
    let path = Path::new(name);
    if name.ends_with(".robot") || path.exists() {
        return ModelText::read(path).map(Source::File);
    }
    match bundled().find(|robot| robot.name() == name) {
        Some(robot) => Ok(Source::Bundled(robot)),
        None => Err(Failure::unknown("file or bundled robot", name, bundled().map(Bundled::name))),
    }
}

/// Why there is no plan.
fn not_shape_accelerated(name: &str) -> Failure {
    Failure::refused(format!("`{name}` is not shape-accelerated: `shapebot check {name}` says why"))
}

impl Source {
    /// The robot with some parameters set: compiled code for a bundled one, the interpreter for a file.
    pub(crate) fn dynamics(&self, parameters: &[(String, f64)]) -> Outcome<Box<dyn Dynamics>> {
        match self {
            Self::File(text) => interpreted::open(text, parameters),
            Self::Bundled(robot) => robot.dynamics(parameters),
        }
    }

    /// The model's text.
    pub(crate) fn text(&self) -> Outcome<ModelText> {
        match self {
            Self::File(text) => Ok(text.clone()),
            Self::Bundled(robot) => robot.text(),
        }
    }
}

/// What the files of plans say about a robot with some parameters set.
pub(crate) fn identity<'d>(description: &'d Description, set: &[(String, f64)]) -> RobotId<'d> {
    RobotId::with(description, |name| {
        let set = set.iter().find(|(given, _)| bundled::identifier(given) == name);
        set.map(|(_, value)| *value)
    })
}

#[cfg(test)]
mod tests;
