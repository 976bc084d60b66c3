//! Why there is no controller.

use core::fmt;

/// Why there is no controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// The design has another number of axes than the robot.
    Axes {
        /// Which gains.
        what: &'static str,
        /// Entries found.
        found: usize,
        /// Entries expected.
        expected: usize,
    },
    /// A gain, limit or period is negative, zero where it must not be, or not finite.
    Gain {
        /// Which.
        what: &'static str,
    },
    /// The design is for the other kind of robot: position variables actuated or not.
    Kind,
    /// Neither are all position variables actuated with as many unactuated shape variables, nor none of
    /// them with all of the shape actuated.
    Roles,
    /// An actuator works on no or on several coordinates, or several on one.
    Actuator {
        /// Its index.
        index: usize,
    },
    /// No frame turns with the unactuated shape variables and nothing else: there is no place for the
    /// inertial unit.
    NoFrame,
    /// The description has no point of this index.
    NoPoint,
    /// A matrix that must be inverted is singular at the origin.
    Singular {
        /// Which.
        matrix: &'static str,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Axes { what, found, expected } => {
                write!(f, "{found} entries of `{what}`, {expected} expected")
            }
            Self::Gain { what } => write!(f, "`{what}` is out of its range"),
            Self::Kind => f.write_str(
                "the design is for a robot whose position variables have the other kind of role",
            ),
            Self::Roles => f.write_str(
                "either all position variables are actuated and as many shape variables are not, \
                 or none is and all of the shape is",
            ),
            Self::Actuator { index } => {
                write!(f, "actuator {index} does not work on exactly one coordinate of its own")
            }
            Self::NoFrame => f.write_str(
                "no frame turns with all unactuated shape variables and with nothing else",
            ),
            Self::NoPoint => f.write_str("the robot has no point of this index"),
            Self::Singular { matrix } => write!(f, "the {matrix} is singular at the origin"),
        }
    }
}

impl core::error::Error for Error {}
