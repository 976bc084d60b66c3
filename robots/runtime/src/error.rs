//! What can be wrong with a runtime's parts.

use core::fmt;

/// Why a runtime cannot be made, or a plan not be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The controller refuses the robot or its gains.
    Control(shapebot_control::Error),
    /// The drive is for a robot with another number of coordinates.
    Coordinates {
        /// Those of the drive.
        found: usize,
        /// Those of the robot.
        expected: usize,
    },
    /// The drive's period is not the gains'.
    Period {
        /// The drive's, µs.
        drive_us: u32,
    },
    /// A setting is not positive and finite.
    Setting {
        /// Its name.
        what: &'static str,
    },
    /// A plan is being followed.
    Busy,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Control(error) => write!(f, "{error}"),
            Self::Coordinates { found, expected } => {
                write!(f, "the drive has {found} coordinates, the robot {expected}")
            }
            Self::Period { drive_us } => {
                write!(f, "the drive's period of {drive_us} µs is not that of the gains")
            }
            Self::Setting { what } => write!(f, "`{what}` is not positive and finite"),
            Self::Busy => write!(f, "a plan is being followed"),
        }
    }
}

impl core::error::Error for Error {}

impl From<shapebot_control::Error> for Error {
    fn from(error: shapebot_control::Error) -> Self {
        Self::Control(error)
    }
}
