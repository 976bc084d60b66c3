//! What can go wrong on an operator's side.

use shapebot_drive::operator::Refusal;
use std::fmt;

/// What can go wrong on an operator's side.
#[derive(Debug)]
pub enum Error {
    /// The socket or file fails.
    Io(std::io::Error),
    /// The bus fails.
    Bus(shapebot_bus::BusError),
    /// The robot refused.
    Refused(Refusal),
    /// No telemetry came for this many milliseconds.
    Silent(u64),
    /// Telemetry comes, but the command was not seen to be taken within this many milliseconds.
    NotTaken(u64),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "{error}"),
            Self::Bus(error) => write!(f, "{error}"),
            Self::Refused(refusal) => write!(f, "refused: {}", crate::refusal(*refusal)),
            Self::Silent(ms) => write!(f, "no telemetry within {ms} ms: is the robot running?"),
            Self::NotTaken(ms) => write!(f, "the command was not taken within {ms} ms"),
        }
    }
}

impl std::error::Error for Error {}

impl From<std::io::Error> for Error {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<shapebot_bus::BusError> for Error {
    fn from(error: shapebot_bus::BusError) -> Self {
        Self::Bus(error)
    }
}
