//! Why there is no experiment.

use shapebot_planner::value::FileError;
use shapebot_planning::Refusal;
use std::fmt;

/// Why there is no experiment.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// The task makes no sense for the robot, or the robot for the task.
    Task(Refusal),
    /// The plan's bytes are not those of a plan for the robot.
    Plan(FileError),
    /// The simulation, or the controller in it, is refused.
    Simulation(shapebot_sim::Error),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Task(refusal) => write!(f, "{refusal}"),
            Self::Plan(error) => write!(f, "{error}"),
            Self::Simulation(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for Error {}

impl From<Refusal> for Error {
    fn from(refusal: Refusal) -> Self {
        Self::Task(refusal)
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        Self::Plan(error)
    }
}

impl From<shapebot_sim::Error> for Error {
    fn from(error: shapebot_sim::Error) -> Self {
        Self::Simulation(error)
    }
}

impl From<shapebot_control::Error> for Error {
    fn from(error: shapebot_control::Error) -> Self {
        Self::Simulation(error.into())
    }
}
