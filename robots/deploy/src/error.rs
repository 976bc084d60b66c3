//! What can go wrong.

use std::path::PathBuf;
use std::{fmt, io};

/// Why a crate is not made, or not written.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The model is wrong: all messages about it, with their places.
    Model(String),
    /// The drive description is wrong, or does not fit the model.
    Drive(shapebot_drive_build::Errors),
    /// The robot is not shape-accelerated, or of a size that is not compiled in.
    Robot(shapebot_interpreter::Error),
    /// No gains were found that balance the robot.
    Gains(String),
    /// The robot's controller refuses its own gains.
    Control(shapebot_control::Error),
    /// The plan of the tests cannot be written.
    Plan(shapebot_planner::value::FileError),
    /// The plan that was given is none, or is another robot's.
    GivenPlan(shapebot_planner::value::FileError),
    /// This build has not the sources of a crate that the target needs.
    Sources {
        /// The crate.
        name: &'static str,
    },
    /// The drive has more buses than the target.
    Buses {
        /// Those of the drive.
        found: usize,
        /// Those of the target.
        most: usize,
    },
    /// A template of this crate is wrong.
    Template {
        /// The file that it makes.
        path: String,
        /// What the template engine says.
        message: String,
    },
    /// There is something else at the folder's place.
    Occupied {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder was made by this crate and has been edited since.
    Edited {
        /// The folder.
        folder: PathBuf,
        /// Files that differ, or that were added.
        files: Vec<String>,
    },
    /// The system refused.
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model(rendered) => f.write_str(rendered.trim_end()),
            Self::Drive(errors) => write!(f, "{errors}"),
            Self::Robot(error) => write!(f, "{error}"),
            Self::Gains(why) => write!(f, "no controller for this robot: {why}"),
            Self::Control(error) => write!(f, "{error}"),
            Self::Plan(error) => write!(f, "the plan of the tests: {error}"),
            Self::GivenPlan(error) => write!(f, "the plan: {error}"),
            Self::Sources { name } => write!(
                f,
                "this build has not the sources of `{name}`: build the tool from a checkout"
            ),
            Self::Buses { found, most } => {
                write!(f, "the drive has {found} buses, the target's emulated board {most}")
            }
            Self::Template { path, message } => write!(f, "the template of `{path}`: {message}"),
            Self::Occupied { folder } => write!(
                f,
                "{} is not empty and was not written by `deploy`: choose another folder",
                folder.display()
            ),
            Self::Edited { folder, files } => write!(
                f,
                "{} was edited: {}; move it away or choose another folder",
                folder.display(),
                files.join(", ")
            ),
            Self::Io { path, source } => write!(f, "{}: {source}", path.display()),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Drive(error) => Some(error),
            Self::Robot(error) => Some(error),
            Self::Control(error) => Some(error),
            Self::Plan(error) | Self::GivenPlan(error) => Some(error),
            Self::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}

impl From<shapebot_drive_build::Errors> for Error {
    fn from(errors: shapebot_drive_build::Errors) -> Self {
        Self::Drive(errors)
    }
}

impl From<shapebot_interpreter::Error> for Error {
    fn from(error: shapebot_interpreter::Error) -> Self {
        Self::Robot(error)
    }
}

impl From<shapebot_control::Error> for Error {
    fn from(error: shapebot_control::Error) -> Self {
        Self::Control(error)
    }
}

impl From<shapebot_planner::value::FileError> for Error {
    fn from(error: shapebot_planner::value::FileError) -> Self {
        Self::Plan(error)
    }
}
