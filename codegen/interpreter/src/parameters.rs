//! Whether values suit a model's parameters.

use crate::Error;
use crate::constant::Constants;
use shapebot_codegen::derive::Derivation;
use shapebot_model_dsl::model::{Comparison, Model, Requirement};

/// Checks parameter values, in SI units in the order of the model: their number, that they are finite
/// and in their ranges, and what the model requires of them.
///
/// # Errors
///
/// [`Error::Length`], [`Error::OutOfRange`], [`Error::Requirement`].
pub fn check_parameters(derivation: &Derivation, values: &[f64]) -> Result<(), Error> {
    let model = &derivation.model;
    let (found, expected) = (values.len(), model.parameters.len());
    if found != expected {
        return Err(Error::Length { what: "parameters", found, expected });
    }
    for (parameter, &value) in model.parameters.iter().zip(values) {
        let (lower, upper) =
            parameter.range.map_or((f64::MIN, f64::MAX), |range| (range.lower, range.upper));
        if !(lower..=upper).contains(&value) {
            let (name, unit) = (parameter.name.clone(), parameter.unit.text.clone());
            return Err(Error::OutOfRange { name, unit, value, lower, upper });
        }
    }
    check_requirements(&with_values(model, values))
}

fn with_values(model: &Model, values: &[f64]) -> Model {
    let mut model = model.clone();
    for (parameter, &value) in model.parameters.iter_mut().zip(values) {
        parameter.value_f64 = value;
    }
    model
}

fn check_requirements(model: &Model) -> Result<(), Error> {
    let constants = Constants::of(model);
    for required in &model.requirements {
        let Requirement::Compare(left, comparison, right) = required.requirement else { continue };
        let (left, right) = (constants.value(left), constants.value(right));
        let holds = match comparison {
            Comparison::Less => left < right,
            Comparison::LessOrEqual => left <= right,
            Comparison::Greater => left > right,
            Comparison::GreaterOrEqual => left >= right,
        };
        if !holds {
            return Err(Error::Requirement { text: model.text(required.span).trim().to_owned() });
        }
    }
    Ok(())
}
