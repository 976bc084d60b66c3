//! Bundled models: parsed and derived once per test program.

use shapebot_codegen::derive::{Derivation, Parameters, derive};
use shapebot_dynamics::Real;
use shapebot_interpreter::{Interpreted, Tapes};
use shapebot_model_dsl::model::Model;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// The checked model of a bundled robot.
///
/// # Panics
///
/// If there is no such robot, or its model is refused.
#[must_use]
pub fn model(name: &str) -> Model {
    let text = shapebot_models::text(name).unwrap_or_else(|| panic!("no model `{name}`"));
    checked(name, text)
}

/// The checked model of a text.
///
/// # Panics
///
/// If it is refused.
#[must_use]
pub fn checked(name: &str, text: &str) -> Model {
    let parsed = shapebot_model_dsl::parse(&format!("{name}.robot"), text);
    let messages = || shapebot_model_dsl::render(&parsed.diagnostics, name, text, false);
    parsed.model.clone().unwrap_or_else(|| panic!("{}", messages()))
}

/// Everything derived from a bundled model, parameters as symbols.
///
/// # Panics
///
/// If the model is refused.
pub fn derivation(name: &str) -> Arc<Derivation> {
    static CACHE: Mutex<BTreeMap<String, Arc<Derivation>>> = Mutex::new(BTreeMap::new());
    let mut cache = CACHE.lock().unwrap_or_else(PoisonError::into_inner);
    let entry = cache.entry(name.to_owned()).or_insert_with(|| {
        let derived = derive(&model(name), Parameters::Symbolic);
        Arc::new(derived.unwrap_or_else(|errors| panic!("{name}: {errors:?}")))
    });
    Arc::clone(entry)
}

/// A bundled robot in the interpreter, with the model's own parameters.
///
/// # Panics
///
/// If its model is refused or of another size.
#[must_use]
pub fn interpreted<T: Real, const N: usize, const NX: usize, const NS: usize>(
    name: &str,
) -> Interpreted<N, NX, NS, T> {
    let tapes = Tapes::with_model_parameters(&derivation(name));
    Interpreted::from_tapes(tapes).unwrap_or_else(|error| panic!("{name}: {error}"))
}
