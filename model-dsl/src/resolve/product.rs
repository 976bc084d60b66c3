//! Sums and products over scalars, arrays, vectors, frames and rotations.

use super::Resolver;
use super::expr::Part;
use super::value::{Array, Scalar, Value};
use crate::Span;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::model::{Dimension, Vector};
use std::rc::Rc;

impl<'a> Resolver<'a> {
    pub(super) fn negative(&mut self, value: Value<'a>, span: Span) -> Value<'a> {
        match value {
            Value::Scalar(s) => Value::Scalar(Scalar { id: self.arena.neg(s.id, span), ..s }),
            Value::Array(a) => {
                let entries = a
                    .entries
                    .iter()
                    .map(|s| Scalar { id: self.arena.neg(s.id, span), ..*s })
                    .collect();
                Value::Array(Array { entries, ..a })
            }
            Value::Vector(v) => {
                let minus = self.arena.number(crate::units::ratio(-1, 1), span);
                let factor = Scalar { id: minus, dimension: Some(Dimension::NONE) };
                self.scaled(factor, &v, span)
            }
            Value::Poison => Value::Poison,
            other => self.kinds(
                span,
                "a negative is taken of a scalar, an array or a vector",
                &[(span, &other)],
                None,
            ),
        }
    }

    /// Reports kinds that do not go together.
    pub(super) fn kinds(
        &mut self,
        span: Span,
        title: &str,
        parts: &[(Span, &Value<'a>)],
        help: Option<&str>,
    ) -> Value<'a> {
        let mut diagnostic =
            Diagnostic::error(codes::E0402, span, title).maybe_help(help.map(str::to_owned));
        for (i, (at, value)) in parts.iter().enumerate() {
            let text = format!("this is {}", value.kind());
            if i + 1 == parts.len() {
                diagnostic.span = *at;
                diagnostic = diagnostic.label(text);
            } else {
                diagnostic = diagnostic.also(*at, text);
            }
        }
        self.sink.push(diagnostic);
        Value::Poison
    }

    pub(super) fn sum(&mut self, parts: Vec<Part<'a>>, span: Span) -> Value<'a> {
        if parts.iter().any(|p| matches!(p.value, Value::Poison)) {
            return Value::Poison;
        }
        let kind = |p: &Part<'a>| match &p.value {
            Value::Scalar(_) => 0,
            Value::Array(_) => 1,
            Value::Vector(_) => 2,
            _ => 3,
        };
        let highest = parts.iter().map(kind).max().unwrap_or(3);
        let fits = |p: &Part<'a>| kind(p) == highest || (highest == 2 && kind(p) == 1);
        let Some(first) = parts.first().filter(|_| highest < 3 && parts.iter().all(fits)) else {
            let odd = parts
                .iter()
                .find(|p| kind(p) == 3)
                .or_else(|| parts.iter().find(|p| !fits(p)))
                .unwrap_or(&parts[0]);
            let other = parts.iter().find(|p| !std::ptr::eq(*p, odd)).unwrap_or(odd);
            return self.kinds(
                span,
                "these kinds cannot be added",
                &[(other.span, &other.value), (odd.span, &odd.value)],
                None,
            );
        };
        match first.value {
            _ if highest == 2 => self.vector_sum(&parts, span),
            Value::Array(_) => self.array_sum(&parts),
            _ => self.scalar_sum(parts),
        }
    }

    fn scalar_sum(&mut self, parts: Vec<Part<'a>>) -> Value<'a> {
        let list = parts.iter().filter_map(|p| match p.value {
            Value::Scalar(s) => Some((s, p.span, p.inverse)),
            _ => None,
        });
        match self.add_scalars(list.collect()) {
            Some(sum) => Value::Scalar(sum),
            None => Value::Poison,
        }
    }

    /// Adds up; every term whose dimension differs from the first one's is reported.
    pub(super) fn add_scalars(&mut self, list: Vec<(Scalar, Span, bool)>) -> Option<Scalar> {
        let (mut sum, start, _) = *list.first()?;
        let mut known = sum.dimension.map(|d| (d, start));
        let mut good = true;
        for (term, span, minus) in list.into_iter().skip(1) {
            match (known, term.dimension) {
                (Some((d, at)), Some(other)) if d != other => {
                    self.unlike(at, d, span, other, minus);
                    good = false;
                }
                (None, Some(d)) => known = Some((d, span)),
                _ => {}
            }
            let whole = start.to(span);
            sum.id = if minus {
                self.arena.sub(sum.id, term.id, whole)
            } else {
                self.arena.add(sum.id, term.id, whole)
            };
        }
        good.then_some(Scalar { id: sum.id, dimension: known.map(|k| k.0) })
    }

    fn unlike(&mut self, left: Span, a: Dimension, right: Span, b: Dimension, minus: bool) {
        let title = if minus {
            "unlike quantities cannot be subtracted"
        } else {
            "unlike quantities cannot be added"
        };
        let ratio = a.over(b).map(|r| r.si());
        self.sink.push(
            Diagnostic::error(codes::E0301, right, title)
                .label(b.describe())
                .also(left, a.describe())
                .maybe_help(ratio.map(|r| format!("the two differ by a factor of dimension {r}; look for a missing or an extra factor"))),
        );
    }

    fn array_sum(&mut self, parts: &[Part<'a>]) -> Value<'a> {
        let arrays: Vec<(&Array, Span, bool)> = parts
            .iter()
            .filter_map(|p| {
                if let Value::Array(a) = &p.value { Some((a, p.span, p.inverse)) } else { None }
            })
            .collect();
        let Some((first, at, _)) = arrays.first() else { return Value::Poison };
        if let Some((odd, span, _)) =
            arrays.iter().find(|(a, ..)| a.entries.len() != first.entries.len())
        {
            return self.lengths(*at, first.entries.len(), *span, odd.entries.len());
        }
        let mut entries = Vec::with_capacity(first.entries.len());
        for i in 0..first.entries.len() {
            let column =
                arrays.iter().map(|(a, span, minus)| (a.entries[i], *span, *minus)).collect();
            match self.add_scalars(column) {
                Some(sum) => entries.push(sum),
                None => return Value::Poison,
            }
        }
        Value::Array(Array::new(entries, first.labels.clone()))
    }

    pub(super) fn lengths(&mut self, left: Span, a: usize, right: Span, b: usize) -> Value<'a> {
        self.sink.push(
            Diagnostic::error(
                codes::E0406,
                right,
                "arrays of different lengths do not go together",
            )
            .label(format!("{b} entries"))
            .also(left, format!("{a} entries")),
        );
        Value::Poison
    }

    fn vector_sum(&mut self, parts: &[Part<'a>], span: Span) -> Value<'a> {
        let mut list = Vec::with_capacity(parts.len());
        let mut known: Option<(Dimension, Span)> = None;
        for part in parts {
            let Some(mut vector) = self.as_vector(&part.value, part.span) else {
                return Value::Poison;
            };
            match (known, vector.dimension) {
                (Some((d, at)), Some(other)) if d != other => {
                    self.unlike(at, d, part.span, other, part.inverse);
                    return Value::Poison;
                }
                (None, Some(d)) => known = Some((d, part.span)),
                _ => {}
            }
            if part.inverse {
                let Value::Vector(minus) = self.negative(Value::Vector(vector), part.span) else {
                    return Value::Poison;
                };
                vector = minus;
            }
            list.push(vector);
        }
        let terms = list.iter().map(|v| v.terms.clone()).collect::<Option<Vec<_>>>();
        let terms = terms.map(|t| Rc::new(t.iter().flat_map(|t| t.iter().cloned()).collect()));
        self.arena.charge(terms.as_ref().map_or(0, |t: &Rc<Vec<_>>| t.len()), span);
        let id = self.arena.push_vector(Vector::Sum(list.iter().map(|v| v.id).collect()), span);
        Value::Vector(super::value::Geometric { id, dimension: known.map(|k| k.0), terms })
    }

    pub(super) fn product(&mut self, parts: Vec<Part<'a>>) -> Value<'a> {
        let mut iter = parts.into_iter();
        let Some(first) = iter.next() else { return Value::Poison };
        let (mut value, mut span) = (first.value, first.span);
        for part in iter {
            value = if part.inverse {
                self.quotient(value, span, part.value, part.span)
            } else {
                self.times(value, span, part.value, part.span)
            };
            span = span.to(part.span);
        }
        value
    }

    fn times(&mut self, left: Value<'a>, at: Span, right: Value<'a>, by: Span) -> Value<'a> {
        let span = at.to(by);
        match (left, right) {
            (Value::Poison, _) | (_, Value::Poison) => Value::Poison,
            (Value::Scalar(a), Value::Scalar(b)) => {
                self.mul(a, b, span).map_or(Value::Poison, Value::Scalar)
            }
            (Value::Scalar(a), Value::Array(v)) | (Value::Array(v), Value::Scalar(a)) => {
                self.scale_array(a, &v, span)
            }
            (Value::Scalar(a), Value::Vector(v)) | (Value::Vector(v), Value::Scalar(a)) => {
                self.scaled(a, &v, span)
            }
            (Value::Scalar(a), Value::Matrix(m)) | (Value::Matrix(m), Value::Scalar(a)) => {
                self.scale_matrix(a, &m, span)
            }
            (Value::Frame(f), Value::Rotation(r)) => Value::Turned(f, r),
            (Value::Turned(f, a), Value::Rotation(b)) => {
                Value::Turned(f, Rc::new(a.iter().chain(b.iter()).copied().collect()))
            }
            (Value::Rotation(a), Value::Rotation(b)) => {
                Value::Rotation(Rc::new(a.iter().chain(b.iter()).copied().collect()))
            }
            (Value::Frame(f), Value::Array(v)) => self.in_frame(f, &v, by, span),
            (Value::Turned(f, r), Value::Array(v)) => {
                let frame = self.unnamed_frame(f, &r, at);
                self.in_frame(frame, &v, by, span)
            }
            (a, b) => {
                let help = product_help(&a, &b);
                self.kinds(span, "these kinds cannot be multiplied", &[(at, &a), (by, &b)], help)
            }
        }
    }

    fn quotient(&mut self, left: Value<'a>, at: Span, right: Value<'a>, by: Span) -> Value<'a> {
        let span = at.to(by);
        let divisor = match right {
            Value::Scalar(s) => s,
            Value::Poison => return Value::Poison,
            other => {
                return self.kinds(span, "a divisor is a scalar", &[(by, &other)], None);
            }
        };
        if self.arena.is_zero(divisor.id) {
            return self.division_by_zero(by);
        }
        match left {
            Value::Scalar(a) => self.div(a, divisor, span).map_or(Value::Poison, Value::Scalar),
            Value::Poison => Value::Poison,
            other => {
                let one = Scalar {
                    id: self.arena.number(crate::units::ratio(1, 1), by),
                    dimension: Some(Dimension::NONE),
                };
                match self.div(one, divisor, by) {
                    Some(inverse) => self.times(other, at, Value::Scalar(inverse), by),
                    None => Value::Poison,
                }
            }
        }
    }

    pub(super) fn mul(&mut self, a: Scalar, b: Scalar, span: Span) -> Option<Scalar> {
        let dimension = match (a.dimension, b.dimension) {
            (Some(x), Some(y)) => match x.times(y) {
                Some(d) => Some(d),
                None => {
                    self.exponent_overflow(span);
                    return None;
                }
            },
            _ => None,
        };
        Some(Scalar { id: self.arena.mul(a.id, b.id, span), dimension })
    }

    fn div(&mut self, a: Scalar, b: Scalar, span: Span) -> Option<Scalar> {
        let dimension = match (a.dimension, b.dimension) {
            (Some(x), Some(y)) => match x.over(y) {
                Some(d) => Some(d),
                None => {
                    self.exponent_overflow(span);
                    return None;
                }
            },
            _ => None,
        };
        Some(Scalar { id: self.arena.div(a.id, b.id, span), dimension })
    }

    fn scale_array(&mut self, factor: Scalar, array: &Array, span: Span) -> Value<'a> {
        let mut entries = Vec::with_capacity(array.entries.len());
        for entry in &array.entries {
            let Some(product) = self.mul(factor, *entry, span) else { return Value::Poison };
            entries.push(product);
        }
        Value::Array(Array::new(entries, array.labels.clone()))
    }

    fn scale_matrix(&mut self, factor: Scalar, matrix: &[[Scalar; 3]; 3], span: Span) -> Value<'a> {
        let mut out = *matrix;
        for entry in out.iter_mut().flatten() {
            let Some(product) = self.mul(factor, *entry, span) else { return Value::Poison };
            *entry = product;
        }
        Value::Matrix(Rc::new(out))
    }
}

fn product_help(a: &Value<'_>, b: &Value<'_>) -> Option<&'static str> {
    match (a, b) {
        (Value::Array(_) | Value::Vector(_), Value::Array(_) | Value::Vector(_)) => {
            Some("write `dot(a, b)` for the scalar product, `cross(a, b)` for the vector product")
        }
        (Value::Frame(_) | Value::Turned(..), Value::Frame(_) | Value::Turned(..)) => Some(
            "a frame contains its parents already; turn one frame with `rot_x`, `rot_y`, `rot_z`",
        ),
        (Value::Scalar(_), Value::Frame(_) | Value::Turned(..)) => {
            Some("put the factor behind the vector or into its entries: `body*[0, 0, 2*l]`")
        }
        (Value::Frame(_) | Value::Turned(..), Value::Vector(_)) => Some(
            "a vector knows its frame already; multiply a frame with plain components `[a, b, c]`",
        ),
        (Value::Rotation(_), _) => Some(
            "a rotation turns a frame: write `world * rot_y(a)`, then multiply with components",
        ),
        (_, Value::Rotation(_)) => {
            Some("a rotation stands behind the frame that it turns: `world * rot_y(a)`")
        }
        _ => None,
    }
}
