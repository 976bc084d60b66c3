//! What can be wrong with a task, a robot or a plan.

use core::fmt;

/// Why there is no plan. Values are given as doubles whatever the scalar.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A number of the task is not acceptable.
    Invalid {
        /// Its name: `duration`, `degree`, `samples`.
        field: &'static str,
        /// What was given.
        value: f64,
        /// What would be accepted.
        expected: &'static str,
    },
    /// One entry of a list of the task is not acceptable.
    InvalidEntry {
        /// The list's name: `control points`, `contributions`.
        field: &'static str,
        /// Which entry, counted from zero.
        index: usize,
        /// What was given.
        value: f64,
        /// What would be accepted.
        expected: &'static str,
    },
    /// A list has the wrong length.
    Length {
        /// The list's name.
        field: &'static str,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },
    /// A shape set takes part in the motion, but its block of K⁰_qs (Eq. 16) has no inverse.
    UselessShapeSet {
        /// Name of the shape set.
        set: &'static str,
    },
    /// A square or full-rank matrix was expected.
    Singular {
        /// Which one.
        matrix: &'static str,
    },
    /// The weight matrix W (Eq. 25) is not symmetric or not positive definite.
    WeightMatrix {
        /// The row that shows it.
        row: usize,
        /// What W should be.
        expected: &'static str,
    },
    /// A constant matrix or vector has an infinite entry or one that is no number.
    NonFiniteMatrix {
        /// Which one.
        matrix: &'static str,
    },
    /// A quantity is infinite or no number.
    NonFinite {
        /// Which one.
        quantity: &'static str,
        /// When along the motion, seconds.
        time: f64,
    },
    /// Every shape set follows a trajectory of its own: none is left to move the robot.
    NoFreeShapeSet,
    /// A refined plan leaves a coordinate's declared range or a limit of the task.
    LimitExceeded {
        /// Name of the coordinate or actuator.
        coordinate: &'static str,
        /// Its unit.
        unit: &'static str,
        /// When, seconds since the motion's start: its extreme.
        time: f64,
        /// The planned value.
        value: f64,
        /// Smallest admissible value.
        lower: f64,
        /// Largest admissible value.
        upper: f64,
        /// A duration of the desired motion with which the plan keeps its limits, seconds.
        duration: Option<f64>,
    },
    /// The plan leaves the range that the model declares for a coordinate.
    OutOfRange {
        /// Name of the coordinate.
        coordinate: &'static str,
        /// Its unit.
        unit: &'static str,
        /// When, seconds: the first sample outside.
        time: f64,
        /// The planned value.
        value: f64,
        /// Smallest declared value.
        lower: f64,
        /// Largest declared value.
        upper: f64,
    },
}

impl Error {
    /// The error with a duration that would do, if it can have one.
    pub(crate) fn with_duration(self, seconds: f64) -> Self {
        match self {
            Self::LimitExceeded { coordinate, unit, time, value, lower, upper, duration: _ } => {
                let duration = Some(seconds);
                Self::LimitExceeded { coordinate, unit, time, value, lower, upper, duration }
            }
            other => other,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Invalid { field, value, expected } => {
                write!(f, "{field} is {value}, expected {expected}")
            }
            Self::InvalidEntry { field, index, value, expected } => {
                write!(f, "entry {index} of the {field} is {value}, expected {expected}")
            }
            Self::Length { field, found, expected } => {
                write!(f, "the number of {field} is {found}, expected {expected}")
            }
            Self::UselessShapeSet { set } => write!(
                f,
                "shape set `{set}` cannot contribute: its block of the shape gain has no inverse"
            ),
            Self::Singular { matrix } => write!(f, "the {matrix} does not have full rank"),
            Self::WeightMatrix { row, expected } => {
                write!(f, "the weight matrix is not {expected}: see row {row}")
            }
            Self::NonFiniteMatrix { matrix } => write!(f, "the {matrix} is not finite"),
            Self::NonFinite { quantity, time } => {
                write!(f, "the {quantity} is not finite at t = {time} s")
            }
            Self::NoFreeShapeSet => {
                write!(f, "every shape set is constrained: at least one must be free")
            }
            Self::LimitExceeded { coordinate, unit, time, value, lower, upper, duration } => {
                write!(
                    f,
                    "`{coordinate}` is planned to {value} {unit} at t = {time} s, \
                     outside its limits {lower} to {upper} {unit}"
                )?;
                match duration {
                    Some(duration) => write!(f, "; a motion of {duration} s would do"),
                    None => Ok(()),
                }
            }
            Self::OutOfRange { coordinate, unit, time, value, lower, upper } => write!(
                f,
                "`{coordinate}` is planned to {value} {unit} at t = {time} s, \
                 outside its range {lower} to {upper} {unit}"
            ),
        }
    }
}

impl core::error::Error for Error {}
