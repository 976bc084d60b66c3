//! Energies, motors, friction, the output.

use super::Resolver;
use super::scope::identifier;
use super::value::{Array, Scalar, Value};
use crate::Span;
use crate::ast::{self, Energy, Expr as AstExpr, ExprKind, WrittenUnit};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::model::{self, Dimension, EnergyTerm, Output, Unit};
use crate::units::ratio;

impl<'a> Resolver<'a> {
    pub(super) fn energy(&mut self, kind: &Energy, expr: &'a AstExpr, docs: &str, span: Span) {
        let what = match kind {
            Energy::Kinetic => "a kinetic energy",
            Energy::Potential => "a potential energy",
            Energy::Lagrangian => "a Lagrangian",
            Energy::Dissipation => "a dissipation function",
        };
        let Some(scalar) = self.scalar(expr, what) else { return };
        let is_power = matches!(kind, Energy::Dissipation);
        let wanted = if is_power { Dimension::POWER } else { Dimension::ENERGY };
        if let Some(found) = scalar.dimension.filter(|d| *d != wanted) {
            self.not_energy(expr.span, what, is_power, found);
            return;
        }
        let term = EnergyTerm { expr: scalar.id, docs: self.copy_of(docs, span), span };
        match kind {
            Energy::Kinetic => self.kinetic.push(term),
            Energy::Potential => self.potential.push(term),
            Energy::Lagrangian => self.lagrangian.push(term),
            Energy::Dissipation => self.dissipation.push(term),
        }
    }

    fn not_energy(&mut self, span: Span, what: &str, is_power: bool, found: Dimension) {
        let (code, wanted, name, unit) = if is_power {
            (codes::E0308, Dimension::POWER, "power: kg·m²/s³", "watts")
        } else {
            (codes::E0307, Dimension::ENERGY, "energy: kg·m²/s²", "joules")
        };
        let mut diagnostic = Diagnostic::error(code, span, format!("{what} is measured in {unit}"))
            .label(format!("expected {name}, found {}", found.describe()));
        if let Some(missing) = wanted.over(found) {
            let named = missing.quantity().map_or(String::new(), |q| format!(" ({q})"));
            diagnostic = diagnostic
                .help(format!("a factor is missing whose dimension is {}{named}", missing.si()));
        }
        self.sink.push(diagnostic);
    }

    /// What `d/dt(…)` differentiates, for a motor or a brake.
    fn displacement(&mut self, on: &'a AstExpr, what: &str) -> Option<Array> {
        let ExprKind::Derivative(inner) = &on.kind else {
            let value = self.eval(on);
            if !matches!(value, Value::Poison) {
                let text = if matches!(on.kind, ExprKind::Name(_) | ExprKind::Postfix(..)) {
                    "write `d/dt(…)` around it"
                } else {
                    "write `on d/dt(…)`"
                };
                self.sink.push(
                    Diagnostic::error(codes::E0408, on.span, format!("{what} works on a rate"))
                        .label("this is no `d/dt(…)`")
                        .note("power is force times rate; the input matrix is derived from it by virtual work")
                        .help(text),
                );
            }
            return None;
        };
        let value = self.eval(inner);
        let array = self.entries(&value, inner.span, "what a motor or a brake moves")?;
        let rates = array.entries.iter().any(|s| self.arena.depends(s.id).rates);
        let moves = array.entries.iter().all(|s| self.arena.depends(s.id).coordinates);
        if !moves {
            self.sink.push(
                Diagnostic::error(
                    codes::E0408,
                    inner.span,
                    format!("{what} works on something that moves"),
                )
                .label("its rate is zero"),
            );
            return None;
        }
        self.no_rates(rates, inner.span, "what a motor or a brake moves").then_some(array)
    }

    pub(super) fn actuator(&mut self, actuator: &'a ast::Actuator, docs: &str, span: Span) {
        let declared = self.declarator(&actuator.name);
        if self.is_reserved(&actuator.name.name.text, actuator.name.name.span) {
            return;
        }
        let moved = self.displacement(&actuator.on, "a motor");
        let (Some(declared), Some(moved)) = (declared, moved) else {
            if let Some(limit) = &actuator.limit {
                self.eval(limit);
            }
            return;
        };
        let names: Vec<String> = match &declared.labels {
            None if moved.entries.len() == 1 => vec![self.path(&declared.key)],
            None => {
                moved.labels.iter().map(|l| format!("{}.{l}", self.path(&declared.key))).collect()
            }
            Some(labels) => {
                labels.iter().map(|l| format!("{}.{l}", self.path(&declared.key))).collect()
            }
        };
        if names.len() != moved.entries.len() {
            self.lengths(actuator.name.span, names.len(), actuator.on.span, moved.entries.len());
            return;
        }
        for (path, scalar) in names.iter().zip(&moved.entries) {
            let Some(unit) = self.force_unit(*scalar, actuator.on.span) else { return };
            let limit = match &actuator.limit {
                None => None,
                Some(expr) => {
                    let Some(limit) =
                        self.constant_quantity(expr, "the limit of this motor", unit.dimension)
                    else {
                        return;
                    };
                    if !self.not_negative(limit, false, expr.span, "the limit of a motor") {
                        return;
                    }
                    Some(limit.id)
                }
            };
            let name = identifier(path);
            self.claim("quantities", &name, actuator.name.span);
            let docs = self.copy_of(docs, span);
            self.actuators.push(model::Actuator {
                name,
                displacement: scalar.id,
                limit,
                unit,
                docs,
                span,
            });
        }
    }

    /// Energy per unit of displacement.
    fn force_unit(&mut self, moved: Scalar, span: Span) -> Option<Unit> {
        let dimension = moved.dimension.unwrap_or(Dimension::NONE);
        let Some(force) = Dimension::ENERGY.over(dimension) else {
            self.exponent_overflow(span);
            return None;
        };
        Some(Unit { dimension: force, text: force.unit_text(), scale: ratio(1, 1) })
    }

    pub(super) fn friction(&mut self, level: &'a AstExpr, on: &'a AstExpr, span: Span) {
        let level_value = self.eval(level);
        let levels = self.entries(&level_value, level.span, "a level of friction");
        let Some(moved) = self.displacement(on, "dry friction") else { return };
        let Some(levels) = levels else { return };
        if levels.entries.len() != 1 && levels.entries.len() != moved.entries.len() {
            self.lengths(level.span, levels.entries.len(), on.span, moved.entries.len());
            return;
        }
        for (i, scalar) in moved.entries.iter().enumerate() {
            let Some(unit) = self.force_unit(*scalar, on.span) else { return };
            let Some(l) = levels.entries.get(i).or(levels.entries.first()).copied() else { return };
            if !self.demand(l, unit.dimension, level.span, "a level of friction") {
                return;
            }
            if !self.arena.depends(l.id).is_constant() {
                self.sink.push(
                    Diagnostic::error(
                        codes::E0507,
                        level.span,
                        "a level of friction is a constant of the robot",
                    )
                    .label("this changes while the robot moves"),
                );
                return;
            }
            self.friction.push(model::CoulombFriction {
                level: l.id,
                displacement: scalar.id,
                span,
            });
        }
    }

    pub(super) fn output(&mut self, expr: &'a AstExpr, unit: &'a WrittenUnit, span: Span) {
        let value = self.eval(expr);
        let unit = self.unit(unit);
        let Some(array) = self.entries(&value, expr.span, "the output") else { return };
        let Some(unit) = unit else { return };
        if let Some(first) = &self.output {
            let diagnostic = Diagnostic::error(codes::E0506, span, "the output is declared twice")
                .also(first.span, "first here")
                .help("put all entries into one array");
            self.sink.push(diagnostic);
            return;
        }
        let spans: Vec<Span> = match &expr.kind {
            ExprKind::Array(list) => list.iter().map(|e| e.span).collect(),
            _ => vec![expr.span; array.entries.len()],
        };
        for (scalar, at) in array.entries.iter().zip(&spans) {
            let rates = self.arena.depends(scalar.id).rates;
            if !self.demand(*scalar, unit.dimension, *at, "an entry of the output")
                || !self.no_rates(rates, *at, "the output")
            {
                return;
            }
        }
        let names = output_names(expr, &array);
        self.output = Some(Output {
            entries: array.entries.iter().map(|s| s.id).collect(),
            names,
            unit,
            span,
        });
    }
}

/// The last segment of each plain path, unless two are alike.
fn output_names(expr: &AstExpr, array: &Array) -> Vec<String> {
    let segment = |e: &AstExpr| match &e.kind {
        ExprKind::Name(name) => Some(name.text.clone()),
        ExprKind::Postfix(_, list) => match list.last() {
            Some(ast::Postfix::Member(name)) => Some(name.text.clone()),
            _ => None,
        },
        _ => None,
    };
    let names: Vec<Option<String>> = match &expr.kind {
        ExprKind::Array(list) => list.iter().map(segment).collect(),
        _ if array.entries.len() == 1 => vec![segment(expr)],
        ExprKind::Name(_) | ExprKind::Postfix(..) => array
            .labels
            .iter()
            .map(|l| Some(l.clone()).filter(|l| l.starts_with(|c: char| c.is_ascii_alphabetic())))
            .collect(),
        _ => vec![None; array.entries.len()],
    };
    let unique = |i: usize, n: &String| {
        names.iter().enumerate().all(|(j, m)| i == j || m.as_ref() != Some(n))
    };
    let name = |(i, n): (usize, &Option<String>)| match n {
        Some(n) if unique(i, n) => n.clone(),
        _ => format!("out_{i}"),
    };
    names.iter().enumerate().map(name).collect()
}
