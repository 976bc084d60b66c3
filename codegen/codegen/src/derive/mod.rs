//! From a checked model to its equations of motion and derived functions.
//!
//! [`equations`] lowers the model and forms M, C q̇ and G with parameters as symbols; the structure
//! proof judges them; [`derive()`] then builds each function in several ways and keeps the cheapest.

mod check;
mod composite;
mod energy;
mod equations;
mod kinematics;
mod lagrangian;
mod lower;
mod mechanics;
mod quantity;
mod recursion;
mod select;
mod shape;
mod solve;
mod tree;
mod vector;

pub use equations::{EnergySource, Equations};
pub use kinematics::points;
pub use quantity::{Block, Function, Quantity};

use crate::proof::{self, Certificate};
use energy as energies;
use mechanics::Mechanics;
use recursion::BodyForm;
use shapebot_model_dsl::Diagnostic;
use shapebot_model_dsl::model::Model;
use std::collections::BTreeMap;
use tree::Tree;

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

/// Derives and proves everything about a model.
///
/// # Errors
///
/// Diagnostics when the energies are no mechanical system, or when the model requires a structure
/// that it does not have.
pub fn derive(model: &Model, parameters: Parameters) -> Result<Derivation, Vec<Diagnostic>> {
    let (equations, certificate) = prove(model)?;
    Ok(specialise(model, &equations, &certificate, parameters))
}

/// The equations of motion with their certificate: what [`specialise`] needs, once for both ways to
/// treat parameters.
///
/// # Errors
///
/// As [`derive()`].
pub fn prove(model: &Model) -> Result<(Equations, Certificate), Vec<Diagnostic>> {
    let equations = equations(model)?;
    let certificate = proof::prove(model, &equations)?;
    Ok((equations, certificate))
}

/// Builds all functions of a proved model.
#[must_use]
pub fn specialise(
    model: &Model,
    equations: &Equations,
    certificate: &Certificate,
    parameters: Parameters,
) -> Derivation {
    let base = Mechanics::new(model, parameters);
    let mut functions = lagrangian::functions(&base);
    functions.extend(kinematics::functions(&base));
    if certificate.is_shape_accelerated() {
        functions.extend(shape::functions(&base, &equations.unactuated()));
    }
    Derivation {
        model: model.clone(),
        parameters,
        equations: equations.clone(),
        certificate: certificate.clone(),
        functions: functions.into_iter().map(|f| (f.quantity, f)).collect(),
    }
}

/// The equations of motion of a model, parameters as symbols.
///
/// # Errors
///
/// Diagnostics when the energies are no mechanical system: a kinetic energy that is not quadratic in
/// the rates, a potential that depends on them, masses that move, a division by zero.
pub fn equations(model: &Model) -> Result<Equations, Vec<Diagnostic>> {
    let mut work = Mechanics::new(model, Parameters::Symbolic);
    check::check(&mut work)?;
    let sources = sources(&mut work);
    let kinetic = work.kinetic();
    let potential = work.potential();
    let mass = match work.mass_by_composites() {
        Some(mass) => mass,
        None => work.mass_from_energy(),
    };
    let bias = work.bias_by_recursion(BodyForm::Tensor);
    let gravity = work.gravity_from_energy();
    let columns: Vec<Vec<shapebot_symbolic::Id>> = (0..model.actuators.len())
        .map(|actuator| kinematics::column(&mut work.lowering, actuator))
        .collect();
    let output = kinematics::output_entries(&mut work.lowering);
    let input = (0..work.count()).map(|i| columns.iter().map(|c| c[i]).collect()).collect();
    Ok(Equations {
        graph: work.lowering.graph,
        mass,
        bias,
        gravity,
        kinetic,
        potential,
        input,
        output,
        position_count: model.position_count(),
        sources,
    })
}

/// Energies body by body and term by term.
fn sources(work: &mut Mechanics<'_>) -> Vec<EnergySource> {
    let model = work.lowering.model;
    let zero = work.lowering.graph.zero();
    let mut out = Vec::new();
    for body in &model.bodies {
        let tree = Tree::of_bodies(&mut work.lowering, &[body]);
        let rates = work.rates.clone();
        let kinetic = energies::kinetic(&mut work.lowering, &tree, &rates);
        let potential = energies::potential(&mut work.lowering, &tree, work.down);
        let name = format!("rigid body `{}`", body.name);
        out.push(EnergySource { name, span: body.span, kinetic, potential });
    }
    for term in &model.kinetic {
        let kinetic = work.lowering.scalar(term.expr);
        out.push(EnergySource {
            name: "kinetic term".into(),
            span: term.span,
            kinetic,
            potential: zero,
        });
    }
    for term in &model.potential {
        let potential = work.lowering.scalar(term.expr);
        out.push(EnergySource {
            name: "potential term".into(),
            span: term.span,
            kinetic: zero,
            potential,
        });
    }
    for term in &model.lagrangian {
        let (kinetic, potential) = work.split_lagrangian(term);
        out.push(EnergySource {
            name: "Lagrangian term".into(),
            span: term.span,
            kinetic,
            potential,
        });
    }
    out
}
