//! Robots: bundled ones run compiled code, model files go through the interpreter.

mod bundled;
mod closed_loop;
mod compiled;
mod interpreted;
mod text;

pub(crate) use bundled::{Bundled, bundled};
pub(crate) use text::{ModelText, derive, prove, rederive};

use crate::commands::eval::{Results, Selection, Sizes, State};
use crate::failure::{Failure, Outcome};
use shapebot_dynamics::Description;
use shapebot_dynamics::control::ControlDesign;
use shapebot_experiments::{Experiment, Runs};
use shapebot_planner::value::RobotId;
use shapebot_planning::PlannedMotion;
use shapebot_tasks::Task;
use std::path::Path;

/// Random runs that are asked for.
pub(crate) struct RunsOf<'a> {
    /// The task's name.
    pub(crate) name: &'a str,
    pub(crate) task: &'a Task,
    pub(crate) planned: &'a PlannedMotion,
    pub(crate) id: &'a RobotId<'a>,
    /// Seed and number of runs.
    pub(crate) runs: [u64; 2],
}

/// What is done with random runs.
pub(crate) type Then<'t> = dyn FnMut(&dyn Runs) -> Outcome + 't;

/// A robot of any size whose parameters are set.
pub(crate) trait Dynamics {
    /// Names, units, ranges, actuators and shape sets.
    fn description(&self) -> &Description;

    /// Whether there is Γ.
    fn is_shape_accelerated(&self) -> bool;

    /// Computes the selected fields at a state whose vectors have the robot's lengths.
    fn evaluate(&self, selection: &Selection, state: &State, results: &mut Results);

    /// Plans a motion; `id` is what the plan's files say about the robot.
    fn plan(&self, task: &Task, id: &RobotId<'_>) -> Outcome<PlannedMotion>;

    /// Lets a controller follow a planned motion of the robot, as the task says.
    fn simulate(
        &self,
        task: &Task,
        planned: &PlannedMotion,
        id: &RobotId<'_>,
    ) -> Outcome<Experiment>;

    /// Calls a function with the random runs of a task.
    fn with_runs(&self, runs: &RunsOf<'_>, then: &mut Then<'_>) -> Outcome;

    /// The controller's design with the poles without control, 1/s.
    fn design(&self) -> Outcome<(&'static ControlDesign, Vec<[f64; 2]>)>;

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
