//! From a checked model to its equations of motion and derived functions.

mod equations;
mod quantity;

pub use equations::{EnergySource, Equations};
pub use quantity::{Block, Function, Quantity};

use crate::proof::Certificate;
use shapebot_model_dsl::model::Model;
use std::collections::BTreeMap;

/// Whether parameters stay inputs or take the model's own values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameters {
    /// Inputs, set at run time.
    Symbolic,
    /// Folded in.
    Baked,
}

/// Everything derived from a model.
#[derive(Clone, Debug)]
pub struct Derivation {
    /// The model.
    pub model: Model,
    /// How parameters were treated in `functions`.
    pub parameters: Parameters,
    /// The equations of motion, parameters as symbols.
    pub equations: Equations,
    /// What was proved about them.
    pub certificate: Certificate,
    /// Derived functions. Those of the shape-accelerated system are there only if the certificate
    /// says that the robot is one.
    pub functions: BTreeMap<Quantity, Function>,
}
