//! Geometric vectors: norms, rates, components, positions.

use super::Resolver;
use super::value::{Array, Geometric, Scalar, Value};
use crate::Span;
use crate::ast;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::model::{Axis, Dimension, Expr, ExprId, Frame, FrameId, FrameVector, Position, Vector};
use crate::units::ratio;
use num_rational::BigRational;
use num_traits::ToPrimitive;
use std::collections::BTreeMap;
use std::rc::Rc;

impl<'a> Resolver<'a> {
    /// A vector; three bare components count as components along the world's axes.
    pub(super) fn as_vector(&mut self, value: &Value<'a>, span: Span) -> Option<Geometric> {
        match value {
            Value::Vector(v) => Some(v.clone()),
            Value::Array(a) if a.entries.len() == 3 => {
                match self.in_frame(FrameId::WORLD, a, span, span) {
                    Value::Vector(v) => Some(v),
                    _ => None,
                }
            }
            Value::Poison => None,
            other => {
                self.sink.push(
                    Diagnostic::error(codes::E0403, span, "a vector of space is needed here")
                        .label(format!("this is {}", other.kind()))
                        .help("write three components `[x, y, z]`, or `frame*[x, y, z]`"),
                );
                None
            }
        }
    }

    /// `frame * [a, b, c]`
    pub(super) fn in_frame(
        &mut self,
        frame: FrameId,
        array: &Array,
        at: Span,
        span: Span,
    ) -> Value<'a> {
        let [a, b, c] = array.entries[..] else {
            let count = array.entries.len();
            self.sink.push(
                Diagnostic::error(codes::E0403, at, "a vector in a frame has three components")
                    .label(format!("{count} entries"))
                    .help("write `frame*[x, y, z]`; in a planar model set y to 0"),
            );
            return Value::Poison;
        };
        let spans: Vec<Span> = (0..3).map(|i| array.spans.get(i).copied().unwrap_or(at)).collect();
        let Some(dimension) = self.common_dimension(&array.entries, &spans) else {
            return Value::Poison;
        };
        let vector = FrameVector { frame, entries: [a.id, b.id, c.id] };
        let id = self.arena.push_vector(Vector::InFrame(vector.clone()), span);
        Value::Vector(Geometric { id, dimension, terms: Some(Rc::new(vec![vector])) })
    }

    /// The dimension that all have; reports unlike ones.
    fn common_dimension(&mut self, list: &[Scalar], spans: &[Span]) -> Option<Option<Dimension>> {
        let mut known: Option<(Dimension, Span)> = None;
        for (scalar, span) in list.iter().zip(spans) {
            match (known, scalar.dimension) {
                (Some((d, at)), Some(other)) if d != other => {
                    self.sink.push(
                        Diagnostic::error(
                            codes::E0301,
                            *span,
                            "the components of a vector are quantities of one kind",
                        )
                        .label(other.describe())
                        .also(at, d.describe()),
                    );
                    return None;
                }
                (None, Some(d)) => known = Some((d, *span)),
                _ => {}
            }
        }
        Some(known.map(|k| k.0))
    }

    /// `factor * vector`, on its terms as well.
    pub(super) fn scaled(&mut self, factor: Scalar, vector: &Geometric, span: Span) -> Value<'a> {
        let dimension = match (factor.dimension, vector.dimension) {
            (Some(a), Some(b)) => match a.times(b) {
                Some(d) => Some(d),
                None => return self.exponent_overflow(span),
            },
            _ => None,
        };
        let terms = vector.terms.as_ref().map(|list| {
            let scale = |t: &FrameVector, arena: &mut super::Arena| FrameVector {
                frame: t.frame,
                entries: t.entries.map(|e| arena.mul(factor.id, e, span)),
            };
            Rc::new(list.iter().map(|t| scale(t, &mut self.arena)).collect::<Vec<_>>())
        });
        let id = self.arena.push_vector(Vector::Scaled(factor.id, vector.id), span);
        Value::Vector(Geometric { id, dimension, terms })
    }

    /// `|v|^power`
    pub(super) fn norm(
        &mut self,
        inner: &'a ast::Expr,
        power: &BigRational,
        span: Span,
    ) -> Value<'a> {
        let value = self.eval(inner);
        let half = power / ratio(2, 1);
        let squared = match &value {
            Value::Poison => return Value::Poison,
            Value::Scalar(s) if half.is_integer() => return self.raise(*s, power, span),
            Value::Scalar(_) => return self.absolute(span),
            Value::Array(a) => self.dot_arrays(a, a, span),
            Value::Vector(v) => self.dot_vectors(v, v, span),
            other => {
                return self.kinds(
                    span,
                    "a norm is taken of a vector or an array",
                    &[(inner.span, other)],
                    None,
                );
            }
        };
        match squared {
            Some(scalar) => self.raise(scalar, &half, span),
            None => Value::Poison,
        }
    }

    fn absolute(&mut self, span: Span) -> Value<'a> {
        self.sink.push(
            Diagnostic::error(codes::E0209, span, "the absolute value of a scalar is refused")
                .label("not differentiable at zero")
                .note("the planner needs Jacobians of the equations of motion everywhere")
                .help("write a square where one is meant: `x^2`, or `sqrt(x^2 + eps^2)` for a smooth one"),
        );
        Value::Poison
    }

    pub(super) fn dot_arrays(&mut self, a: &Array, b: &Array, span: Span) -> Option<Scalar> {
        let mut terms = Vec::with_capacity(a.entries.len());
        for (x, y) in a.entries.iter().zip(&b.entries) {
            let product = if x.id == y.id {
                match self.raise(*x, &ratio(2, 1), span) {
                    Value::Scalar(s) => s,
                    _ => return None,
                }
            } else {
                self.mul(*x, *y, span)?
            };
            if !self.arena.is_zero(product.id) {
                terms.push((product, span, false));
            }
        }
        if terms.is_empty() {
            let id = self.arena.number(ratio(0, 1), span);
            return Some(Scalar { id, dimension: None });
        }
        self.add_scalars(terms)
    }

    pub(super) fn dot_vectors(
        &mut self,
        a: &Geometric,
        b: &Geometric,
        span: Span,
    ) -> Option<Scalar> {
        let dimension = match (a.dimension, b.dimension) {
            (Some(x), Some(y)) => Some(x.times(y)?),
            _ => None,
        };
        Some(Scalar { id: self.arena.push(Expr::Dot(a.id, b.id), span), dimension })
    }

    pub(super) fn derivative(&mut self, value: Value<'a>, inner: Span, span: Span) -> Value<'a> {
        match value {
            Value::Scalar(s) => self.scalar_rate(s, span).map_or(Value::Poison, Value::Scalar),
            Value::Array(a) => {
                let entries: Option<Vec<Scalar>> =
                    a.entries.iter().map(|s| self.scalar_rate(*s, span)).collect();
                entries.map_or(Value::Poison, |entries| Value::Array(Array::new(entries, a.labels)))
            }
            Value::Vector(v) => {
                let Some(dimension) = rate_dimension(v.dimension) else {
                    return self.exponent_overflow(span);
                };
                let id = self.arena.push_vector(Vector::TimeDerivative(v.id), span);
                Value::Vector(Geometric { id, dimension, terms: None })
            }
            Value::Poison => Value::Poison,
            other => {
                let help = matches!(other, Value::Frame(_) | Value::Turned(..))
                    .then_some("the angular velocity of a frame is `omega(frame)`");
                self.kinds(
                    span,
                    "a rate is taken of a scalar, an array or a vector",
                    &[(inner, &other)],
                    help,
                )
            }
        }
    }

    fn scalar_rate(&mut self, scalar: Scalar, span: Span) -> Option<Scalar> {
        if self.arena.as_number(scalar.id).is_some() {
            let id = self.arena.number(ratio(0, 1), span);
            return Some(Scalar { id, dimension: None });
        }
        let Some(dimension) = rate_dimension(scalar.dimension) else {
            self.exponent_overflow(span);
            return None;
        };
        if self.arena.depends(scalar.id).rates {
            self.sink.push(
                Diagnostic::error(codes::E0508, span, "a rate of a rate is an acceleration")
                    .label("differentiated twice")
                    .note("energies, actuators and outputs are functions of coordinates and their first rates"),
            );
            return None;
        }
        Some(Scalar { id: self.arena.push(Expr::TimeDerivative(scalar.id), span), dimension })
    }

    pub(super) fn component_of(
        &mut self,
        vector: &Geometric,
        axis: usize,
        span: Span,
    ) -> Value<'a> {
        if let Some(terms) =
            vector.terms.as_ref().filter(|t| t.iter().all(|t| t.frame == FrameId::WORLD))
        {
            let id = self.add_entries(terms.iter().map(|t| t.entries[axis]).collect(), span);
            return Value::Scalar(Scalar { id, dimension: vector.dimension });
        }
        let axis = axis.to_u8().unwrap_or(0);
        let id = self.arena.push(Expr::Component(vector.id, axis), span);
        Value::Scalar(Scalar { id, dimension: vector.dimension })
    }

    /// Adds up what is not literally zero.
    fn add_entries(&mut self, list: Vec<ExprId>, span: Span) -> ExprId {
        let mut sum: Option<ExprId> = None;
        for entry in list {
            sum = Some(match sum {
                None => entry,
                Some(_) if self.arena.is_zero(entry) => continue,
                Some(s) if self.arena.is_zero(s) => entry,
                Some(s) => self.arena.add(s, entry, span),
            });
        }
        sum.unwrap_or_else(|| self.arena.number(ratio(0, 1), span))
    }

    /// A place in space: terms of one frame merged, parents first.
    pub(super) fn position(
        &mut self,
        value: &Value<'a>,
        span: Span,
        what: &str,
    ) -> Option<(Position, Geometric)> {
        let vector = self.as_vector(value, span)?;
        if !self.demand_dimension(vector.dimension, Dimension::LENGTH, None, span, what) {
            return None;
        }
        let Some(terms) = vector.terms.clone() else {
            self.sink.push(
                Diagnostic::error(codes::E0405, span, format!("{what} is a sum of components in frames"))
                    .label("this holds a cross product, a rate or an angular velocity")
                    .note("the kinematic tree is kept as a tree: every position is a sum of `frame*[a, b, c]`")
                    .help("write the components out in a frame"),
            );
            return None;
        };
        let mut rates = false;
        let mut merged: BTreeMap<FrameId, [Vec<ExprId>; 3]> = BTreeMap::new();
        for term in terms.iter() {
            let columns = merged.entry(term.frame).or_default();
            for (column, entry) in columns.iter_mut().zip(term.entries) {
                rates |= self.arena.depends(entry).rates;
                column.push(entry);
            }
        }
        if !self.no_rates(rates, span, what) {
            return None;
        }
        let terms: Vec<FrameVector> = merged
            .into_iter()
            .map(|(frame, columns)| FrameVector {
                frame,
                entries: columns.map(|c| self.add_entries(c, span)),
            })
            .collect();
        Some((Position { terms }, vector))
    }

    /// Registers a frame and returns its id.
    pub(super) fn new_frame(
        &mut self,
        name: String,
        parent: FrameId,
        turns: &[(Axis, ExprId)],
        span: Span,
    ) -> FrameId {
        self.arena.push_frame(Some(parent), turns.iter().map(|t| t.1));
        self.frames.push(Frame { name, parent: Some(parent), rotations: turns.to_vec(), span });
        FrameId(u32::try_from(self.frames.len() - 1).unwrap_or(u32::MAX))
    }

    pub(super) fn unnamed_frame(
        &mut self,
        parent: FrameId,
        turns: &[(Axis, ExprId)],
        span: Span,
    ) -> FrameId {
        let existing =
            self.frames.iter().position(|f| f.parent == Some(parent) && f.rotations == turns);
        if let Some(i) = existing {
            return FrameId(u32::try_from(i).unwrap_or(u32::MAX));
        }
        let name = format!("unnamed_{}", self.frames.len());
        self.new_frame(name, parent, turns, span)
    }
}

fn rate_dimension(dimension: Option<Dimension>) -> Option<Option<Dimension>> {
    match dimension {
        None => Some(None),
        Some(d) => d.over(Dimension::TIME).map(Some),
    }
}
