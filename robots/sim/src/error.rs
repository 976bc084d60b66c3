//! What can be wrong with a simulation.

use std::fmt;

/// Why something is not simulated.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// A number is out of its range.
    Invalid {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it has to be.
        expected: &'static str,
    },
    /// The potential energy is not that of the known weights, so that the effect of a slope is not known.
    NotWeight {
        /// Largest difference of generalised forces.
        residual: f64,
        /// Largest generalised force of gravity.
        gravity: f64,
    },
    /// Another number of coordinates than the type says.
    Coordinates {
        /// Found in the description.
        found: usize,
        /// N of the type.
        expected: usize,
    },
    /// A push or a weight at a point that the robot does not have.
    Point {
        /// Index of the point.
        index: usize,
        /// Number of points.
        points: usize,
    },
    /// A recorded motion without samples, or whose times do not grow evenly.
    Table {
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A matrix equation without a solution.
    NoSolution {
        /// Which.
        equation: &'static str,
    },
    /// The robot's roles do not allow this controller.
    Control(shapebot_control::Error),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Invalid { what, value, expected } => {
                write!(f, "{what} is {value}: it must be {expected}")
            }
            Self::NotWeight { residual, gravity } => write!(
                f,
                "the potential energy is not that of rigid bodies and the given weights (generalised \
                 forces differ by {residual:.3e} of {gravity:.3e}): what a slope does is not known"
            ),
            Self::Coordinates { found, expected } => {
                write!(f, "the description has {found} coordinates, not {expected}")
            }
            Self::Point { index, points } => {
                write!(f, "there is no point {index}: the robot has {points}")
            }
            Self::Table { reason } => write!(f, "recorded motion: {reason}"),
            Self::NoSolution { equation } => write!(f, "the {equation} has no solution"),
            Self::Control(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Control(error) => Some(error),
            _ => None,
        }
    }
}

impl From<shapebot_control::Error> for Error {
    fn from(error: shapebot_control::Error) -> Self {
        Self::Control(error)
    }
}

/// Refuses what is not finite or below `least`.
pub(crate) fn at_least(what: &'static str, value: f64, least: f64) -> Result<(), Error> {
    if value.is_finite() && value >= least {
        return Ok(());
    }
    let expected = if least > 0.0 { "positive and finite" } else { "finite and not negative" };
    Err(Error::Invalid { what, value, expected })
}
