//! The derived equations of motion, readable: in the model's own parameters, as text, LaTeX or JSON.
//!
//! Every value is brought into a normal form (a quotient of polynomials in parameters, rates and the
//! sines and cosines of angles), arranged for the eye, and printed only if the graph confirms that it is
//! the value it was made from. What would be longer than a few lines is printed as it is computed, with
//! shared parts named `a_1`, `a_2`, ….

mod forms;
mod fraction;
mod json;
mod latex;
mod layout;
mod names;
mod polynomial;
mod render;
mod sheet;
#[cfg(test)]
mod tests;
mod text;

use crate::derive::{Derivation, Equations};
use crate::proof::Certificate;
use shapebot_model_dsl::model::Model;

/// What is printed: a model with its equations and its certificate.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// Names and units.
    pub model: &'a Model,
    /// The equations of motion.
    pub equations: &'a Equations,
    /// What was proved about them.
    pub certificate: &'a Certificate,
}

impl<'a> From<&'a Derivation> for Subject<'a> {
    fn from(derivation: &'a Derivation) -> Self {
        let Derivation { model, equations, certificate, .. } = derivation;
        Self { model, equations, certificate }
    }
}

impl<'a> From<(&'a Model, &'a Equations, &'a Certificate)> for Subject<'a> {
    fn from((model, equations, certificate): (&'a Model, &'a Equations, &'a Certificate)) -> Self {
        Self { model, equations, certificate }
    }
}

/// The equations as plain text in the notation of the model file; `phi.x'` is a rate.
#[must_use]
pub fn to_text<'a>(subject: impl Into<Subject<'a>>) -> String {
    text::print(subject.into())
}

/// The equations as a LaTeX fragment that needs nothing but `amsmath`.
#[must_use]
pub fn to_latex<'a>(subject: impl Into<Subject<'a>>) -> String {
    latex::print(subject.into())
}

/// Equations and certificate as JSON; formulas are strings, as text and as LaTeX.
#[must_use]
pub fn to_json<'a>(subject: impl Into<Subject<'a>>) -> String {
    json::print(subject.into())
}
