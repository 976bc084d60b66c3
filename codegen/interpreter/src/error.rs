//! Why a model cannot be interpreted, or a function not evaluated.

use shapebot_codegen::derive::Quantity;
use std::fmt;

/// Why a model cannot be interpreted, or a function not evaluated.
#[derive(Clone, Debug, PartialEq, Eq)]
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
            Self::UnsupportedDimensions { positions, shapes } => write!(
                f,
                "no planner for {positions} position and {shapes} shape variables: the tool is \
                 compiled for 1 to 3 position variables and up to 4 shape sets"
            ),
        }
    }
}

impl std::error::Error for Error {}
