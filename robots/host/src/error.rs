//! What can go wrong.

use shapebot_bus::BusError;
use shapebot_planner::value::FileError;
use std::{fmt, io};

/// Why a robot's program does not start, or ended.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The command line is wrong.
    Usage(String),
    /// A bus cannot be opened, or failed.
    Bus(BusError),
    /// The plan file is refused.
    Plan(FileError),
    /// The robot, its gains and its drive do not fit together.
    Runtime(shapebot_runtime::Error),
    /// The system refused.
    Io {
        /// What was being done.
        place: String,
        /// The system's error.
        source: io::Error,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(message) => f.write_str(message),
            Self::Bus(error) => write!(f, "{error}"),
            Self::Plan(error) => write!(f, "{error}"),
            Self::Runtime(error) => write!(f, "{error}"),
            Self::Io { place, source } => write!(f, "{place}: {source}"),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Usage(_) => None,
            Self::Bus(error) => Some(error),
            Self::Plan(error) => Some(error),
            Self::Runtime(error) => Some(error),
            Self::Io { source, .. } => Some(source),
        }
    }
}

impl From<BusError> for Error {
    fn from(error: BusError) -> Self {
        Self::Bus(error)
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        Self::Plan(error)
    }
}

impl From<shapebot_runtime::Error> for Error {
    fn from(error: shapebot_runtime::Error) -> Self {
        Self::Runtime(error)
    }
}

impl From<shapebot_control::Error> for Error {
    fn from(error: shapebot_control::Error) -> Self {
        Self::Runtime(error.into())
    }
}
