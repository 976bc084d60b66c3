//! Parameters and constant values.

use super::Resolver;
use super::scope::identifier;
use super::value::{Array, Scalar, Value, default_labels};
use crate::Span;
use crate::ast::{self, Bounds, WrittenUnit};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::model::{Expr, Function, Parameter, ParameterId, Range, Unit};
use num_traits::{One, ToPrimitive};
use std::rc::Rc;

impl<'a> Resolver<'a> {
    pub(super) fn params(&mut self, list: &'a [ast::Parameter]) {
        for parameter in list {
            let value = self.parameter(parameter);
            self.bind((parameter.name.text.clone(), None), value, parameter.name.span);
        }
    }

    fn parameter(&mut self, parameter: &'a ast::Parameter) -> Value<'a> {
        let value = self.eval(&parameter.value);
        let Some(unit) = self.unit(&parameter.unit) else { return Value::Poison };
        let range = parameter.range.as_ref().and_then(|b| self.bounds(b, &unit));
        let make = |resolver: &mut Self, suffix: &str, scalar: Scalar| {
            resolver.scalar_parameter(parameter, &unit, range, suffix, scalar)
        };
        match value {
            Value::Poison => Value::Poison,
            Value::Scalar(s) => make(self, "", s).map_or(Value::Poison, Value::Scalar),
            Value::Array(a) if a.entries.len() <= 3 => {
                let labels = default_labels(a.entries.len());
                let entries: Option<Vec<Scalar>> = labels
                    .iter()
                    .zip(&a.entries)
                    .map(|(l, s)| make(self, &format!(".{l}"), *s))
                    .collect();
                entries.map_or(Value::Poison, |entries| Value::Array(Array::new(entries, labels)))
            }
            Value::Matrix(m) => self.matrix_parameter(parameter, &m, make),
            other => {
                self.sink.push(
                    Diagnostic::error(
                        codes::E0507,
                        parameter.value.span,
                        "a parameter is a number, up to three numbers, or a matrix",
                    )
                    .label(format!("this is {}", other.kind())),
                );
                Value::Poison
            }
        }
    }

    fn matrix_parameter(
        &mut self,
        parameter: &ast::Parameter,
        matrix: &[[Scalar; 3]; 3],
        make: impl Fn(&mut Self, &str, Scalar) -> Option<Scalar>,
    ) -> Value<'a> {
        let is_symmetric_call =
            matches!(&parameter.value.kind, ast::ExprKind::Call(n, _) if n.text == "sym");
        let mut out = *matrix;
        let places: &[(usize, usize, &str)] = &[
            (0, 0, ".xx"),
            (1, 1, ".yy"),
            (2, 2, ".zz"),
            (0, 1, ".xy"),
            (0, 2, ".xz"),
            (1, 2, ".yz"),
        ];
        for (i, j, suffix) in &places[..if is_symmetric_call { 6 } else { 3 }] {
            let Some(scalar) = make(self, suffix, matrix[*i][*j]) else { return Value::Poison };
            out[*i][*j] = scalar;
            out[*j][*i] = scalar;
        }
        Value::Matrix(Rc::new(out))
    }

    fn scalar_parameter(
        &mut self,
        parameter: &ast::Parameter,
        unit: &Unit,
        range: Option<Range>,
        suffix: &str,
        scalar: Scalar,
    ) -> Option<Scalar> {
        let span = parameter.value.span;
        let (value, number) = self.in_unit(scalar, unit, span, "the value of a parameter")?;
        let path = format!("{}{suffix}", parameter.name.text);
        if let Some(r) = range.filter(|r| number < r.lower || number > r.upper) {
            self.sink.push(
                Diagnostic::error(
                    codes::E0504,
                    span,
                    format!("the value of `{path}` lies outside its own range"),
                )
                .label(format!("{number} in SI units"))
                .also(
                    parameter.range.as_ref().map_or(span, |b| b.span),
                    format!("{} to {}", r.lower, r.upper),
                )
                .help("widen the range, or correct the value"),
            );
            return None;
        }
        let name = identifier(&path);
        self.claim("quantities", &name, parameter.name.span);
        let id = ParameterId(u32::try_from(self.parameters.len()).unwrap_or(u32::MAX));
        self.parameters.push(Parameter {
            name,
            path,
            unit: unit.clone(),
            value,
            value_f64: number,
            range,
            docs: parameter.docs.clone(),
            span: parameter.span,
        });
        let expr = self.arena.push(Expr::Parameter(id), parameter.name.span);
        self.parameter_ids.push(expr);
        Some(Scalar { id: expr, dimension: Some(unit.dimension) })
    }

    /// A declared unit; `deg` and poison are not usable.
    pub(super) fn unit(&mut self, unit: &WrittenUnit) -> Option<Unit> {
        if unit.degrees {
            self.sink.push(
                Diagnostic::error(codes::E0310, unit.span, "angles are declared in `rad`")
                    .label("degrees are not a rational multiple of the radian")
                    .help("write `rad` here and give values as `30deg`"),
            );
            return None;
        }
        unit.unit.clone()
    }

    /// A constant of parameters' kind in SI units: plain numbers count in the declared unit.
    fn in_unit(
        &mut self,
        scalar: Scalar,
        unit: &Unit,
        span: Span,
        what: &str,
    ) -> Option<(crate::model::ExprId, f64)> {
        let depends = self.arena.depends(scalar.id);
        if depends.parameters || !depends.is_constant() {
            self.sink.push(
                Diagnostic::error(codes::E0507, span, format!("{what} is made of numbers alone"))
                    .label("this depends on a parameter or a coordinate")
                    .help("name derived quantities with `let` outside of `params`"),
            );
            return None;
        }
        let mut id = scalar.id;
        let plain = scalar.dimension.is_none_or(crate::model::Dimension::is_none);
        if plain && !unit.scale.is_one() {
            let scale = self.arena.number(unit.scale.clone(), span);
            id = self.arena.mul(id, scale, span);
        } else if !plain && !self.demand(scalar, unit.dimension, span, what) {
            return None;
        }
        let number = self.number(id).filter(|v| v.is_finite());
        if number.is_none() {
            self.sink.push(
                Diagnostic::error(codes::E0507, span, format!("{what} is not a finite number"))
                    .label("this overflows, or is undefined"),
            );
        }
        Some((id, number?))
    }

    pub(super) fn bounds(&mut self, bounds: &'a Bounds, unit: &Unit) -> Option<Range> {
        let lower = self.scalar(&bounds.lower, "the end of a range");
        let upper = self.scalar(&bounds.upper, "the end of a range");
        let (_, lower) = self.in_unit(lower?, unit, bounds.lower.span, "the end of a range")?;
        let (_, upper) = self.in_unit(upper?, unit, bounds.upper.span, "the end of a range")?;
        if lower < upper {
            return Some(Range { lower, upper });
        }
        self.sink.push(
            Diagnostic::error(codes::E0505, bounds.span, "this range is empty")
                .label(format!("from {lower} to {upper} in SI units"))
                .help(if lower > upper {
                    "exchange the two ends"
                } else {
                    "leave the range out, or widen it"
                }),
        );
        None
    }

    /// Value of a constant expression at the model's own parameters.
    pub(super) fn number(&self, id: crate::model::ExprId) -> Option<f64> {
        let get = |i: &crate::model::ExprId| self.number(*i);
        Some(match self.arena.expr(id) {
            Expr::Number(value) => value.to_f64()?,
            Expr::Pi => std::f64::consts::PI,
            Expr::Parameter(p) => self.parameters.get(p.0 as usize)?.value_f64,
            Expr::Add(a, b) => get(a)? + get(b)?,
            Expr::Sub(a, b) => get(a)? - get(b)?,
            Expr::Mul(a, b) => get(a)? * get(b)?,
            Expr::Div(a, b) => get(a)? / get(b)?,
            Expr::Neg(a) => -get(a)?,
            Expr::Power(a, e) => get(a)?.powf(e.to_f64()?),
            Expr::Call(Function::Atan2, list) => get(list.first()?)?.atan2(get(list.get(1)?)?),
            Expr::Call(function, list) => apply(*function, get(list.first()?)?),
            Expr::Coordinate(_) | Expr::TimeDerivative(_) | Expr::Dot(..) | Expr::Component(..) => {
                return None;
            }
        })
    }
}

fn apply(function: Function, x: f64) -> f64 {
    match function {
        Function::Sin => x.sin(),
        Function::Cos => x.cos(),
        Function::Tan => x.tan(),
        Function::Asin => x.asin(),
        Function::Acos => x.acos(),
        Function::Atan | Function::Atan2 => x.atan(),
        Function::Sinh => x.sinh(),
        Function::Cosh => x.cosh(),
        Function::Tanh => x.tanh(),
        Function::Sqrt => x.sqrt(),
        Function::Exp => x.exp(),
        Function::Ln => x.ln(),
    }
}
