//! The structure proof: whether a model is a shape-accelerated balancing system, before any code is
//! emitted from it.
//!
//! | condition | claim | refusal |
//! | --- | --- | --- |
//! | (a) | n_x unactuated equations, n_s = k n_x | P0601 |
//! | (b) | those equations are free of q_x and q̇_x | P0602, P0603 |
//! | (c) | M_{u,x} is invertible at the origin and over the declared ranges (Theorem 1) | P0604, P0613 |
//! | (d) | the origin is an equilibrium: G_u(0) = 0 | P0605 |
//! | (e) | K⁰_qs (Eq. 16) has full row rank | P0606 |
//! | (f) | the derived input matrix is [1; 0] | P0607 |
//!
//! Rows go by role: u are the equations that no actuator enters, wherever they stand in q. That a value
//! vanishes is decided by the graph, exactly and for all parameter values; that it vanishes nowhere in a
//! range is shown by intervals, or reported as sampled only.

mod certificate;
mod conditions;
mod finding;
mod integrable;
mod linear;
mod linearisation;
mod mass;
mod mirror;
mod problem;
mod range;
mod rows;
mod shape_map;
#[cfg(test)]
mod tests;
mod text;

pub use certificate::{
    Certificate, Class, Condition, Evidence, Integrability, Linearisation, MassFacts, Mirror,
    PositionFacts, RangeClaim, Reason, Root, RowIntegrability, SetGain, ShapeMap, Strict,
};

pub(crate) use problem::determinant;

use crate::derive::Equations;
use finding::Finding;
use problem::Problem;
use shapebot_model_dsl::Diagnostic;
use shapebot_model_dsl::model::{Model, Requirement};

/// Proves what can be proved about a model. A model that is not shape-accelerated gets a certificate
/// that says so, unless it requires to be.
///
/// # Errors
///
/// What makes the model none of mechanics (P0611), breaks its own demands (P0608, P0609) or, where
/// `require shape_accelerated;` is written, puts it outside the class (P0601-P0607, P0613).
pub fn prove(model: &Model, equations: &Equations) -> Result<Certificate, Vec<Diagnostic>> {
    let mut problem = Problem::new(model, equations);
    let (mass, indefinite) = mass::examine(&problem);
    let mut demands: Vec<Finding> = indefinite.into_iter().collect();
    let regular = demands.is_empty();
    demands.extend(mass::output(&mut problem));
    let (mirrors, asymmetric) = mirror::examine(&mut problem);
    demands.extend(asymmetric);

    let rows = rows::examine(&problem);
    let mut conditions = rows.conditions;
    let mut failures = rows.findings;
    let mut map = None;
    let mut warnings = Vec::new();
    if failures.is_empty() {
        let (condition, dependent) = conditions::independence(&mut problem);
        let independent = dependent.is_empty();
        conditions.push(condition);
        failures.extend(dependent);
        if independent {
            let examined = shape_map::examine(&mut problem);
            conditions.extend(examined.conditions);
            failures.extend(examined.findings);
            warnings = examined.warnings;
            map = examined.map;
        } else {
            conditions.extend(['c', 'd', 'e'].map(shape_map::not_examined));
        }
    } else {
        conditions.extend(['b', 'c', 'd', 'e'].map(shape_map::not_examined));
    }
    conditions.sort_by_key(|condition| condition.letter);

    let required =
        model.requirements.iter().any(|r| matches!(r.requirement, Requirement::ShapeAccelerated));
    if required {
        demands.append(&mut failures.clone());
    }
    if !demands.is_empty() {
        return Err(demands.into_iter().map(Finding::error).collect());
    }
    let class = if failures.is_empty() {
        Class::ShapeAccelerated
    } else {
        let reasons = failures.iter().map(|f| f.reason(&problem)).collect();
        Class::NotShapeAccelerated { reasons }
    };
    let (strict, positions) = conditions::strict(&mut problem);
    let strict = Strict { holds: strict.holds && failures.is_empty(), ..strict };
    let integrability = integrable::examine(&mut problem);
    let linearisation =
        if regular { linearisation::examine(&mut problem, map.as_ref()) } else { None };
    Ok(Certificate {
        robot: model.name.clone(),
        class,
        coordinates: (0..problem.len()).map(|i| problem.name(i)).collect(),
        position_count: problem.n_x(),
        actuated: rows.actuated,
        unactuated: problem.unactuated.clone(),
        conditions,
        strict,
        positions,
        shape_map: map,
        integrability,
        linearisation,
        mass,
        mirrors,
        warnings: warnings.into_iter().map(Finding::warning).collect(),
    })
}
