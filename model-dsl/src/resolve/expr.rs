//! Expressions: sums, powers, names, members.

use super::Resolver;
use super::scope::{Binding, is_ambiguous, plain_path};
use super::value::{Array, Scalar, Value, default_labels};
use crate::Span;
use crate::ast::{self, ExprKind, Name, Postfix};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::model::{Dimension, Expr};
use crate::suggest::closest;
use crate::units::{self, ratio};
use num_rational::BigRational;

/// A part of a sum or a product.
pub(super) struct Part<'a> {
    pub(super) value: Value<'a>,
    pub(super) span: Span,
    /// Subtracted, or divided by.
    pub(super) inverse: bool,
}

impl<'a> Resolver<'a> {
    pub(super) fn eval(&mut self, expr: &'a ast::Expr) -> Value<'a> {
        let span = expr.span;
        if self.arena.overflow.is_some() {
            return Value::Poison;
        }
        match &expr.kind {
            ExprKind::Error => Value::Poison,
            ExprKind::Number(value) => self.literal(value.clone(), span),
            ExprKind::Quantity(value, unit) => self.with_unit(value, unit, span),
            ExprKind::Name(name) => self.name(name),
            ExprKind::Postfix(base, list) => self.postfix(base, list),
            ExprKind::Array(list) => self.array(list),
            ExprKind::Neg(inner) => {
                let value = self.eval(inner);
                self.negative(value, span)
            }
            ExprKind::Sum(terms) => {
                let parts = self.parts(terms);
                self.sum(parts, span)
            }
            ExprKind::Product(factors) => {
                let parts = self.parts(factors);
                self.product(parts)
            }
            ExprKind::Power(base, exponent) => self.power(base, exponent, span),
            ExprKind::Call(name, arguments) => self.call(name, arguments, span),
            ExprKind::Norm(inner) => self.norm(inner, &ratio(1, 1), span),
            ExprKind::Derivative(inner) => {
                let value = self.eval(inner);
                self.derivative(value, inner.span, span)
            }
            ExprKind::SumOver(sum) => self.sum_over(sum, span),
        }
    }

    fn parts(&mut self, list: &'a [(bool, ast::Expr)]) -> Vec<Part<'a>> {
        list.iter()
            .map(|(inverse, e)| Part { value: self.eval(e), span: e.span, inverse: *inverse })
            .collect()
    }

    fn literal(&mut self, value: BigRational, span: Span) -> Value<'a> {
        let zero = num_traits::Zero::is_zero(&value);
        let id = self.arena.number(value, span);
        Value::Scalar(Scalar { id, dimension: (!zero).then_some(Dimension::NONE) })
    }

    fn with_unit(&mut self, value: &BigRational, unit: &Name, span: Span) -> Value<'a> {
        if units::find(&unit.text).is_none() {
            let help = closest(&unit.text, units::UNITS.iter().map(|u| u.name)).map_or_else(
                || format!("for a product write `*{}`", unit.text),
                |n| format!("did you mean `{n}`?"),
            );
            self.sink.push(
                Diagnostic::error(
                    codes::E0207,
                    unit.span,
                    format!("there is no unit `{}`", unit.text),
                )
                .label("letters directly behind a number are its unit")
                .help(help),
            );
            return Value::Poison;
        }
        if is_ambiguous(self, &unit.text) {
            let n = units::decimal(value);
            self.sink.push(
                Diagnostic::error(
                    codes::E0105,
                    span,
                    format!("`{n}{0}` is a quantity in `{0}`, but `{0}` is a name here", unit.text),
                )
                .label("unit or factor?")
                .help(format!("write `{n}*{}` for the product", unit.text)),
            );
            return Value::Poison;
        }
        let Value::Scalar(factor) = self.unit_constant(&unit.text, unit.span) else {
            return Value::Poison;
        };
        let number = self.arena.number(value.clone(), span);
        if num_traits::Zero::is_zero(value) {
            return Value::Scalar(Scalar { id: number, dimension: factor.dimension });
        }
        Value::Scalar(Scalar {
            id: self.scale(number, &unit.text, factor, span),
            dimension: factor.dimension,
        })
    }

    /// `number` times a unit; for degrees the number is folded with the 1/180.
    fn scale(
        &mut self,
        number: crate::model::ExprId,
        unit: &str,
        factor: Scalar,
        span: Span,
    ) -> crate::model::ExprId {
        if unit != "deg" {
            return self.arena.mul(number, factor.id, span);
        }
        let share = self.arena.number(ratio(1, 180), span);
        let turns = self.arena.mul(number, share, span);
        let pi = self.arena.push(Expr::Pi, span);
        self.arena.mul(turns, pi, span)
    }

    /// A unit as a constant in SI units.
    fn unit_constant(&mut self, name: &str, span: Span) -> Value<'a> {
        let Some(unit) = units::find(name) else { return Value::Poison };
        let one = self.arena.number(unit.factor(), span);
        let id = if name == "deg" { self.degree(span) } else { one };
        Value::Scalar(Scalar { id, dimension: Some(unit.dimension) })
    }

    fn degree(&mut self, span: Span) -> crate::model::ExprId {
        let share = self.arena.number(ratio(1, 180), span);
        let pi = self.arena.push(Expr::Pi, span);
        self.arena.mul(share, pi, span)
    }

    fn name(&mut self, name: &Name) -> Value<'a> {
        let key = (name.text.clone(), None);
        if let Some(Binding { value, .. }) = self.find(&key) {
            let value = value.clone();
            self.mark_used(&value);
            return value;
        }
        match name.text.as_str() {
            "pi" => {
                let id = self.arena.push(Expr::Pi, name.span);
                Value::Scalar(Scalar { id, dimension: Some(Dimension::NONE) })
            }
            text if units::find(text).is_some() => self.unit_constant(text, name.span),
            _ => {
                self.unknown(name, None);
                Value::Poison
            }
        }
    }

    /// Remembers which parameters are used.
    fn mark_used(&mut self, value: &Value<'a>) {
        let list: Vec<Scalar> = match value {
            Value::Scalar(s) => vec![*s],
            Value::Array(a) => a.entries.clone(),
            Value::Matrix(m) => m.iter().flatten().copied().collect(),
            _ => return,
        };
        for scalar in list {
            if let Expr::Parameter(id) = self.arena.expr(scalar.id) {
                self.used_parameters.insert(id.0);
            }
        }
    }

    fn postfix(&mut self, base: &'a ast::Expr, list: &'a [Postfix]) -> Value<'a> {
        let mut rest = list.iter();
        let mut span = base.span;
        let mut value = match (&base.kind, list.first()) {
            (ExprKind::Name(name), Some(Postfix::Index(index))) => {
                rest.next();
                span = span.to(index.span);
                self.indexed(name, index)
            }
            _ => self.eval(base),
        };
        while let Some(postfix) = rest.next() {
            match (postfix, rest.clone().next()) {
                // `left.p[2]`: a declaration with an index inside an instance.
                (Postfix::Member(name), Some(Postfix::Index(index)))
                    if is_indexed(self, &value, name) =>
                {
                    rest.next();
                    let Some(i) = self.whole(index, "an index") else { return Value::Poison };
                    value = self.indexed_member(&value, name, i);
                    span = span.to(index.span);
                }
                (Postfix::Member(name), _) => {
                    value = self.member(value, name, span);
                    span = span.to(name.span);
                }
                (Postfix::Index(index), _) => {
                    let Some(i) = self.whole(index, "an index") else { return Value::Poison };
                    let name = Name { text: i.to_string(), span: index.span };
                    value = self.member(value, &name, span);
                    span = span.to(index.span);
                }
            }
        }
        value
    }

    fn indexed_member(&mut self, value: &Value<'a>, name: &Name, i: i64) -> Value<'a> {
        let Value::Instance(instance) = value else { return Value::Poison };
        let names = &self.scopes[instance.scope].names;
        if let Some(binding) = names.get(&(name.text.clone(), Some(i))) {
            return binding.value.clone();
        }
        let known: Vec<String> = names.keys().map(plain_path).collect();
        let shown = Name { text: format!("{}[{i}]", name.text), span: name.span };
        self.no_member(value, &shown, &known);
        Value::Poison
    }

    /// `name[i]`: a declaration with an index, or an entry of a vector.
    fn indexed(&mut self, name: &'a Name, index: &'a ast::Expr) -> Value<'a> {
        let Some(i) = self.whole(index, "an index") else { return Value::Poison };
        if let Some(binding) = self.find(&(name.text.clone(), Some(i))) {
            let value = binding.value.clone();
            self.mark_used(&value);
            return value;
        }
        match self.find(&(name.text.clone(), None)).map(|b| b.value.clone()) {
            Some(value @ (Value::Array(_) | Value::Poison | Value::Instance(_))) => {
                let member = Name { text: i.to_string(), span: index.span };
                self.member(value, &member, name.span)
            }
            _ => {
                self.unknown(name, Some(i));
                Value::Poison
            }
        }
    }

    fn member(&mut self, value: Value<'a>, name: &Name, base: Span) -> Value<'a> {
        let known: Vec<String> = match &value {
            Value::Poison => return Value::Poison,
            Value::Array(a) => {
                if let Some(i) = a.labels.iter().position(|l| *l == name.text) {
                    return Value::Scalar(a.entries[i]);
                }
                a.labels.to_vec()
            }
            Value::Vector(v) => {
                if let Some(axis) = ["x", "y", "z"].iter().position(|l| *l == name.text) {
                    return self.component_of(&v.clone(), axis, base.to(name.span));
                }
                ["x", "y", "z"].map(str::to_owned).to_vec()
            }
            Value::Matrix(m) => {
                if let Some((i, j)) = entry(&name.text) {
                    let value = Value::Scalar(m[i][j]);
                    self.mark_used(&value);
                    return value;
                }
                ["xx", "yy", "zz", "xy", "xz", "yz"].map(str::to_owned).to_vec()
            }
            Value::Body(body) => match name.text.as_str() {
                "mass" => return Value::Scalar(body.mass),
                "com" => return Value::Vector(body.com.clone()),
                "frame" => return Value::Frame(body.frame),
                _ => ["mass", "com", "frame"].map(str::to_owned).to_vec(),
            },
            Value::Instance(instance) => {
                let names = &self.scopes[instance.scope].names;
                let key = (name.text.clone(), None);
                if let Some(binding) = names.get(&key) {
                    return binding.value.clone();
                }
                names.keys().map(plain_path).collect()
            }
            _ => Vec::new(),
        };
        self.no_member(&value, name, &known);
        Value::Poison
    }

    fn no_member(&mut self, value: &Value<'a>, name: &Name, known: &[String]) {
        let mut diagnostic = Diagnostic::error(
            codes::E0204,
            name.span,
            format!("{} has no member `{}`", value.kind(), name.text),
        )
        .label("unknown member");
        if !known.is_empty() {
            let list: Vec<String> = known.iter().take(12).map(|k| format!("`.{k}`")).collect();
            diagnostic = diagnostic.note(format!("its members are {}", list.join(", ")));
        }
        let close = closest(&name.text, known.iter().map(String::as_str))
            .map(|n| format!("did you mean `.{n}`?"));
        self.sink.push(diagnostic.maybe_help(close));
    }

    fn array(&mut self, list: &'a [ast::Expr]) -> Value<'a> {
        let mut entries = Vec::with_capacity(list.len());
        let mut broken = list.is_empty();
        for expr in list {
            match self.scalar(expr, "an entry of an array") {
                Some(scalar) => entries.push(scalar),
                None => broken = true,
            }
        }
        if broken {
            return Value::Poison;
        }
        let labels = default_labels(entries.len());
        let spans = list.iter().map(|e| e.span).collect();
        Value::Array(Array { entries, labels, spans })
    }

    fn power(&mut self, base: &'a ast::Expr, exponent: &'a ast::Expr, span: Span) -> Value<'a> {
        let Some(power) = self.exponent(base, exponent) else {
            self.eval(base);
            return Value::Poison;
        };
        if let ExprKind::Norm(inner) = &base.kind {
            return self.norm(inner, &power, span);
        }
        let Some(scalar) = self.scalar(base, "the base of a power") else { return Value::Poison };
        self.raise(scalar, &power, span)
    }

    /// `scalar^power`, with its dimension.
    pub(super) fn raise(&mut self, scalar: Scalar, power: &BigRational, span: Span) -> Value<'a> {
        let negative = *power < ratio(0, 1);
        if negative && self.arena.is_zero(scalar.id) {
            return self.division_by_zero(span);
        }
        let Some(dimension) = scalar.dimension.map_or(Some(None), |d| d.power(power).map(Some))
        else {
            return self.exponent_overflow(span);
        };
        let id = self.arena.power(scalar.id, power.clone(), span);
        Value::Scalar(Scalar {
            id,
            dimension: dimension.or((!self.arena.is_zero(id)).then_some(Dimension::NONE)),
        })
    }

    pub(super) fn exponent_overflow(&mut self, span: Span) -> Value<'a> {
        self.sink.push(
            Diagnostic::error(
                codes::E0306,
                span,
                "the dimension of this has exponents beyond reason",
            )
            .label("no physical quantity has such a dimension"),
        );
        Value::Poison
    }

    pub(super) fn division_by_zero(&mut self, span: Span) -> Value<'a> {
        self.sink.push(
            Diagnostic::error(codes::E0305, span, "division by zero")
                .label("the divisor is exactly zero")
                .help("remove the term, or divide by a parameter"),
        );
        Value::Poison
    }

    fn exponent(&mut self, base: &'a ast::Expr, expr: &'a ast::Expr) -> Option<BigRational> {
        let value = self.eval(expr);
        let scalar = self.as_scalar(&value, expr.span, "an exponent")?;
        let number = self.arena.as_number(scalar.id).cloned();
        if let Some(number) = number.filter(|_| scalar.dimension.is_none_or(Dimension::is_none)) {
            if number.numer().bits() <= 10 && number.denom().bits() <= 10 {
                return Some(number);
            }
            self.sink.push(Diagnostic::error(
                codes::E0306,
                expr.span,
                "this exponent is out of range",
            ));
            return None;
        }
        let found = scalar.dimension.filter(|d| !d.is_none());
        let label = found.map_or_else(
            || "not a number known while the file is read".to_owned(),
            |d| format!("this is {}", d.describe()),
        );
        self.sink.push(
            Diagnostic::error(codes::E0303, expr.span, "an exponent is a constant number")
                .label(label)
                .also(base.span, "the dimension of the power follows from the exponent")
                .help("for a number `a` write `exp(x*ln(a))`"),
        );
        None
    }
}

/// Row and column of `xy`.
fn entry(text: &str) -> Option<(usize, usize)> {
    let axis = |b: u8| b"xyz".iter().position(|a| *a == b);
    match text.as_bytes() {
        [a, b] => Some((axis(*a)?, axis(*b)?)),
        _ => None,
    }
}

/// Whether an instance declares the name with indices only.
fn is_indexed(resolver: &Resolver<'_>, value: &Value<'_>, name: &Name) -> bool {
    let Value::Instance(instance) = value else { return false };
    let names = &resolver.scopes[instance.scope].names;
    !names.contains_key(&(name.text.clone(), None))
}
