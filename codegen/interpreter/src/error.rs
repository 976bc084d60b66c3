//! Why a model cannot be interpreted, or a function not evaluated.

use shapebot_codegen::derive::Quantity;
use std::fmt;

/// Why a model cannot be interpreted, or a function not evaluated.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A list has the wrong length.
    Length {
        /// What the list holds: `parameters`, `coordinates`.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },
    /// The derivation has no such function: the model is not shape-accelerated, or lists fewer frames,
    /// points or actuators.
    Absent(Quantity),
    /// The model is not of the paper's class; its certificate says why.
    NotShapeAccelerated {
        /// The model's name.
        model: String,
    },
    /// A parameter's value is not finite or not in its range.
    OutOfRange {
        /// The parameter.
        name: String,
        /// Its unit.
        unit: String,
        /// What was given.
        value: f64,
        /// Smallest allowed value.
        lower: f64,
        /// Largest allowed value.
        upper: f64,
    },
    /// Parameter values break a `require` of the model.
    Requirement {
        /// Its text.
        text: String,
    },
    /// No instance of the planner was compiled for this number of position and shape variables.
    UnsupportedDimensions {
        /// Number of position variables n_x.
        positions: usize,
        /// Number of shape variables n_s.
        shapes: usize,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { what, found, expected } => {
                write!(f, "{found} {what} given, expected {expected}")
            }
            Self::Absent(quantity) => write!(f, "the model has no {quantity:?}"),
            Self::NotShapeAccelerated { model } => {
                write!(f, "`{model}` is not shape-accelerated, so there is no Γ to plan with")
            }
            Self::OutOfRange { name, value, .. } if !value.is_finite() => {
                write!(f, "parameter `{name}` is {value}, which is not finite")
            }
            Self::OutOfRange { name, unit, value, lower, upper } => write!(
                f,
                "parameter `{name}` = {value} {unit} is outside of its range {lower} to {upper} {unit}"
            ),
            Self::Requirement { text } => write!(f, "the parameters break `{text}`"),
            Self::UnsupportedDimensions { positions, shapes } => write!(
                f,
                "no planner for {positions} position and {shapes} shape variables: the tool is \
                 compiled for 1 to 3 position variables and up to 4 shape sets"
            ),
        }
    }
}

impl std::error::Error for Error {}
