//! Whether the energies of a model are those of a mechanical system.

use super::mechanics::Mechanics;
use shapebot_model_dsl::model::ExprId;
use shapebot_model_dsl::{Diagnostic, Span, codes};
use shapebot_symbolic::{Id, Symbol, symbols_of};

/// Refuses energies that are not T(q, q̇) − V(q) with T a quadratic form in q̇.
pub(crate) fn check(work: &mut Mechanics<'_>) -> Result<(), Vec<Diagnostic>> {
    let mut found = Vec::new();
    let model = work.lowering.model;
    for body in &model.bodies {
        constant(work, body.mass, body.span, &format!("the mass of `{}`", body.name), &mut found);
        for entry in body.inertia.iter().flatten() {
            constant(
                work,
                *entry,
                body.span,
                &format!("the inertia of `{}`", body.name),
                &mut found,
            );
        }
    }
    for term in &model.kinetic {
        let value = work.lowering.scalar(term.expr);
        quadratic(work, value, term.span, &mut found);
    }
    for term in &model.lagrangian {
        let (kinetic, potential) = work.split_lagrangian(term);
        quadratic(work, kinetic, term.span, &mut found);
        free_of_rates(work, potential, term.span, &mut found);
    }
    for term in &model.potential {
        let value = work.lowering.scalar(term.expr);
        free_of_rates(work, value, term.span, &mut found);
    }
    if work.lowering.graph.singular().is_some() {
        let whole = Span { start: 0, end: 0 };
        found.push(
            Diagnostic::error(
                codes::P0615,
                whole,
                "an expression divides by zero for all values of its symbols",
            )
            .note("a denominator of the model vanishes identically, so its equations do not exist")
            .help("look for a difference of equal terms under a `/` or inside `ln`"),
        );
    }
    found.sort_by_key(|d| d.span);
    found.dedup();
    if found.is_empty() { Ok(()) } else { Err(found) }
}

fn moves(symbol: &Symbol) -> bool {
    !matches!(symbol, Symbol::Parameter(_))
}

fn constant(
    work: &mut Mechanics<'_>,
    expr: ExprId,
    span: Span,
    what: &str,
    found: &mut Vec<Diagnostic>,
) {
    let value = work.lowering.scalar(expr);
    if symbols_of(&work.lowering.graph, &[value]).iter().any(moves) {
        let place = work.lowering.model.expr_span(expr);
        found.push(
            Diagnostic::error(codes::P0615, place, format!("{what} depends on the motion"))
                .label("must be made of parameters and numbers")
                .also(span, "of this body")
                .note("the equations of a rigid body hold for constant mass and inertia")
                .help("write the moving part as a rigid body of its own"),
        );
    }
}

fn quadratic(work: &mut Mechanics<'_>, value: Id, span: Span, found: &mut Vec<Diagnostic>) {
    let hessian = work.hessian(value);
    let rates = work.rates.clone();
    let graph = work.graph();
    let rows: Vec<Id> = hessian.iter().map(|row| super::vector::dot(graph, row, &rates)).collect();
    let twice = super::vector::dot(graph, &rows, &rates);
    let half = graph.fraction(1, 2);
    let form = graph.mul(half, twice);
    let entries: Vec<Id> = hessian.concat();
    let curved = symbols_of(graph, &entries)
        .iter()
        .any(|s| matches!(s, Symbol::Rate(_) | Symbol::Acceleration(_)));
    if form != value || curved {
        found.push(
            Diagnostic::error(codes::P0610, span, "this kinetic energy is no quadratic form in the rates")
                .label("is not ½ q̇ᵀ M(q) q̇")
                .note("the mass matrix is M = ∂²T/∂q̇²; terms of other degree in the rates have no place in it")
                .help("write terms without rates under `potential`, and drag under `dissipation`"),
        );
    }
}

fn free_of_rates(work: &mut Mechanics<'_>, value: Id, span: Span, found: &mut Vec<Diagnostic>) {
    let moving = |s: &Symbol| matches!(s, Symbol::Rate(_) | Symbol::Acceleration(_));
    if symbols_of(&work.lowering.graph, &[value]).iter().any(moving) {
        found.push(
            Diagnostic::error(codes::P0614, span, "this potential energy depends on a rate")
                .label("contains a time derivative")
                .note("a potential is a function of the coordinates alone; its slope is the force G(q)")
                .help("write energies of motion under `kinetic`, drag under `dissipation`"),
        );
    }
}
