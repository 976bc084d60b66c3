//! What a place demands of a value: kind, dimension, constancy.

use super::Resolver;
use super::value::{Array, Scalar, Value};
use crate::Span;
use crate::ast;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::model::Dimension;
use num_traits::ToPrimitive;

impl<'a> Resolver<'a> {
    /// A scalar, or a report.
    pub(super) fn scalar(&mut self, expr: &'a ast::Expr, what: &str) -> Option<Scalar> {
        let value = self.eval(expr);
        self.as_scalar(&value, expr.span, what)
    }

    pub(super) fn as_scalar(
        &mut self,
        value: &Value<'a>,
        span: Span,
        what: &str,
    ) -> Option<Scalar> {
        match value {
            Value::Scalar(s) => Some(*s),
            Value::Array(a) if a.entries.len() == 1 => a.entries.first().copied(),
            Value::Poison => None,
            other => {
                let help = match other {
                    Value::Vector(_) => {
                        Some("take a component `.x`, a norm `|v|^2` or `dot(a, b)`")
                    }
                    Value::Array(_) => Some("take an entry such as `.x`, or a norm `|v|^2`"),
                    _ => None,
                };
                self.sink.push(
                    Diagnostic::error(codes::E0401, span, format!("{what} is a scalar"))
                        .label(format!("this is {}", other.kind()))
                        .maybe_help(help.map(str::to_owned)),
                );
                None
            }
        }
    }

    /// A scalar of the dimension.
    pub(super) fn quantity(
        &mut self,
        expr: &'a ast::Expr,
        what: &str,
        wanted: Dimension,
    ) -> Option<Scalar> {
        let scalar = self.scalar(expr, what)?;
        self.demand(scalar, wanted, expr.span, what).then_some(scalar)
    }

    /// Checks a dimension; reports a wrong one.
    pub(super) fn demand(
        &mut self,
        scalar: Scalar,
        wanted: Dimension,
        span: Span,
        what: &str,
    ) -> bool {
        let number = self.arena.as_number(scalar.id).map(crate::units::decimal);
        self.demand_dimension(scalar.dimension, wanted, number, span, what)
    }

    /// The same for anything with a dimension; `number` is its value if it is a plain literal.
    pub(super) fn demand_dimension(
        &mut self,
        dimension: Option<Dimension>,
        wanted: Dimension,
        number: Option<String>,
        span: Span,
        what: &str,
    ) -> bool {
        let Some(found) = dimension.filter(|d| *d != wanted) else { return true };
        let mut diagnostic =
            Diagnostic::error(codes::E0304, span, format!("{what} has the wrong dimension"))
                .label(format!("expected {}, found {}", wanted.describe(), found.describe()));
        if let Some(number) = number.filter(|_| found.is_none()) {
            diagnostic = diagnostic
                .help(format!("give the number its unit: `{number}*{}`", wanted.unit_text()));
        } else if let Some(ratio) = wanted.over(found).filter(|r| !r.is_none()) {
            let name = ratio.quantity().map_or(String::new(), |q| format!(" ({q})"));
            diagnostic = diagnostic
                .help(format!("a factor is missing whose dimension is {}{name}", ratio.si()));
        }
        self.sink.push(diagnostic);
        false
    }

    /// A scalar that depends on parameters at most.
    pub(super) fn constant_quantity(
        &mut self,
        expr: &'a ast::Expr,
        what: &str,
        wanted: Dimension,
    ) -> Option<Scalar> {
        let scalar = self.quantity(expr, what, wanted)?;
        if self.arena.depends(scalar.id).is_constant() {
            return Some(scalar);
        }
        self.sink.push(
            Diagnostic::error(
                codes::E0507,
                expr.span,
                format!("{what} is a constant of the robot"),
            )
            .label("this changes while the robot moves")
            .help("build it from parameters and numbers alone"),
        );
        None
    }

    /// Reports a constant that is negative at the model's own values, or zero where that is too little.
    pub(super) fn not_negative(
        &mut self,
        scalar: Scalar,
        zero_allowed: bool,
        span: Span,
        what: &str,
    ) -> bool {
        let Some(value) = self.number(scalar.id) else { return true };
        if value > 0.0 || (zero_allowed && value == 0.0) {
            return true;
        }
        let wanted = if zero_allowed { "negative" } else { "zero or negative" };
        self.sink.push(
            Diagnostic::error(codes::E0514, span, format!("{what} cannot be {wanted}"))
                .label(format!("{value} in SI units at the model's own values"))
                .help("correct the value, or a sign"),
        );
        false
    }

    /// Reports a dependence on rates where only positions make sense.
    pub(super) fn no_rates(&mut self, depends_on_rates: bool, span: Span, what: &str) -> bool {
        if depends_on_rates {
            self.sink.push(
                Diagnostic::error(codes::E0508, span, format!("{what} depends on positions alone"))
                    .label("this holds a time derivative")
                    .note("where the robot is follows from its coordinates; rates enter energies and forces only"),
            );
        }
        !depends_on_rates
    }

    /// A whole number known while the file is read.
    pub(super) fn whole(&mut self, expr: &'a ast::Expr, what: &str) -> Option<i64> {
        let value = self.eval(expr);
        let number = match &value {
            Value::Poison => return None,
            Value::Scalar(s) => {
                self.arena.as_number(s.id).filter(|n| n.is_integer()).and_then(ToPrimitive::to_i64)
            }
            _ => None,
        };
        if number.is_none_or(|n| n.abs() > 1_000_000) {
            self.sink.push(
                Diagnostic::error(codes::E0512, expr.span, format!("{what} is a whole number"))
                    .label("not a whole number known while the file is read")
                    .help("use literals, a `const`, or the index of a repetition"),
            );
            return None;
        }
        number
    }

    /// Scalars of an array or one scalar.
    pub(super) fn entries(&mut self, value: &Value<'a>, span: Span, what: &str) -> Option<Array> {
        match value {
            Value::Array(a) => Some(a.clone()),
            Value::Scalar(s) => Some(Array::new(vec![*s], super::value::default_labels(1))),
            Value::Poison => None,
            other => {
                self.sink.push(
                    Diagnostic::error(
                        codes::E0401,
                        span,
                        format!("{what} is a scalar or an array of scalars"),
                    )
                    .label(format!("this is {}", other.kind())),
                );
                None
            }
        }
    }
}
