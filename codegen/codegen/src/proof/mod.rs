//! The structure proof.

/// What was proved about a model.
#[derive(Clone, Debug)]
pub struct Certificate {}
