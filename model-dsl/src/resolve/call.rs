//! Functions, rotations, indexed sums.

use super::Resolver;
use super::scope::Level;
use super::value::{Scalar, Value};
use crate::Span;
use crate::ast::{self, Loop, Name};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::model::{Axis, Dimension, Expr, Function, Vector};
use crate::suggest::closest;
use crate::units::ratio;
use std::rc::Rc;

const SMOOTH: &[(&str, Function)] = &[
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("asin", Function::Asin),
    ("acos", Function::Acos),
    ("atan", Function::Atan),
    ("sinh", Function::Sinh),
    ("cosh", Function::Cosh),
    ("tanh", Function::Tanh),
    ("exp", Function::Exp),
    ("ln", Function::Ln),
];

const GEOMETRIC: &[&str] =
    &["sqrt", "atan2", "rot_x", "rot_y", "rot_z", "dot", "cross", "omega", "diag", "sym", "sum"];

/// Refused functions and what to write instead.
const ROUGH: &[(&str, &str)] = &[
    ("abs", "write `sqrt(x^2 + eps^2)` for a smooth absolute value"),
    (
        "min",
        "a smooth function such as `ln(exp(a) + exp(b))` may do, or the case distinction belongs into the controller",
    ),
    (
        "max",
        "a smooth function such as `ln(exp(a) + exp(b))` may do, or the case distinction belongs into the controller",
    ),
    ("sign", "use `tanh(x/eps)`; dry friction of the plant is declared with `friction`"),
    ("signum", "use `tanh(x/eps)`; dry friction of the plant is declared with `friction`"),
    ("sgn", "use `tanh(x/eps)`; dry friction of the plant is declared with `friction`"),
    ("step", "use `tanh(x/eps)`"),
    ("heaviside", "use `tanh(x/eps)`"),
    ("clamp", "limits of a motor are declared with `limit`"),
    ("sat", "limits of a motor are declared with `limit`"),
    ("floor", "angles need no wrapping: all functions of the language are smooth"),
    ("ceil", "angles need no wrapping: all functions of the language are smooth"),
    ("round", "angles need no wrapping: all functions of the language are smooth"),
    ("mod", "angles need no wrapping: all functions of the language are smooth"),
    ("if", "one set of equations holds everywhere; switching belongs into the controller"),
    ("select", "one set of equations holds everywhere; switching belongs into the controller"),
];

impl<'a> Resolver<'a> {
    pub(super) fn call(
        &mut self,
        name: &'a Name,
        arguments: &'a [ast::Expr],
        span: Span,
    ) -> Value<'a> {
        let text = name.text.as_str();
        if let Some((_, function)) = SMOOTH.iter().find(|(n, _)| *n == text) {
            return self.smooth(*function, text, arguments, span);
        }
        let axis = match text {
            "rot_x" => Axis::X,
            "rot_y" => Axis::Y,
            "rot_z" => Axis::Z,
            _ => return self.special(name, arguments, span),
        };
        let Some([angle]) = self.exactly::<1>(text, arguments, span) else { return Value::Poison };
        let Some(scalar) = self.scalar(angle, "an angle") else { return Value::Poison };
        let good = self.dimensionless(scalar, text, angle.span);
        let rates = self.arena.depends(scalar.id).rates;
        if good && self.no_rates(rates, angle.span, "a rotation") {
            return Value::Rotation(Rc::new(vec![(axis, scalar.id)]));
        }
        Value::Poison
    }

    fn special(&mut self, name: &'a Name, arguments: &'a [ast::Expr], span: Span) -> Value<'a> {
        match name.text.as_str() {
            "sqrt" => {
                let Some([inner]) = self.exactly::<1>("sqrt", arguments, span) else {
                    return Value::Poison;
                };
                let Some(scalar) = self.scalar(inner, "the argument of `sqrt`") else {
                    return Value::Poison;
                };
                let Some(dimension) =
                    scalar.dimension.map_or(Some(None), |d| d.power(&ratio(1, 2)).map(Some))
                else {
                    return self.exponent_overflow(span);
                };
                let id = self.arena.push(Expr::Call(Function::Sqrt, vec![scalar.id]), span);
                Value::Scalar(Scalar { id, dimension })
            }
            "atan2" => self.atan2(arguments, span),
            "dot" => self.dot(arguments, span),
            "cross" => self.cross(arguments, span),
            "omega" => self.omega(arguments, span),
            "diag" => self.matrix("diag", arguments, span),
            "sym" => self.matrix("sym", arguments, span),
            _ => self.no_function(name, arguments),
        }
    }

    fn no_function(&mut self, name: &'a Name, arguments: &'a [ast::Expr]) -> Value<'a> {
        let text = name.text.as_str();
        if let Some((_, help)) = ROUGH.iter().find(|(n, _)| *n == text) {
            self.sink.push(
                Diagnostic::error(
                    codes::E0209,
                    name.span,
                    format!("`{text}` is refused: it is not smooth"),
                )
                .label("no derivative where it kinks or jumps")
                .note("the planner needs Jacobians of the equations of motion everywhere")
                .help(*help),
            );
            return Value::Poison;
        }
        let mut diagnostic =
            Diagnostic::error(codes::E0208, name.span, format!("there is no function `{text}`"));
        diagnostic = match self.find(&(name.text.clone(), None)).map(|b| b.value.clone()) {
            Some(Value::Component(..)) => diagnostic
                .label("a component")
                .help(format!("make an instance with a statement `part = {text}(…);`")),
            Some(_) if arguments.len() == 1 => diagnostic
                .label("a name, not a function")
                .help(format!("write every product out: `{text}*(…)`")),
            Some(_) => diagnostic.label("a name, not a function"),
            None => {
                let known = SMOOTH.iter().map(|(n, _)| *n).chain(GEOMETRIC.iter().copied());
                let alias = match text {
                    "log" => Some("`ln`"),
                    "arctan" => Some("`atan`"),
                    "arcsin" => Some("`asin`"),
                    "arccos" => Some("`acos`"),
                    "norm" => Some("`|v|`"),
                    "pow" => Some("`x^y`"),
                    "deriv" | "diff" | "dt" => Some("`d/dt(…)`"),
                    _ => None,
                };
                let close = closest(text, known).map(|n| format!("did you mean `{n}`?"));
                diagnostic
                    .label("unknown function")
                    .maybe_help(close)
                    .maybe_help(alias.map(|a| format!("write {a}")))
            }
        };
        self.sink.push(diagnostic);
        Value::Poison
    }

    /// The arguments, if there are as many as wanted.
    fn exactly<const N: usize>(
        &mut self,
        name: &str,
        list: &'a [ast::Expr],
        span: Span,
    ) -> Option<[&'a ast::Expr; N]> {
        let refs: Vec<&'a ast::Expr> = list.iter().collect();
        if let Ok(array) = refs.try_into() {
            return Some(array);
        }
        let plural = if N == 1 { "" } else { "s" };
        self.sink.push(
            Diagnostic::error(codes::E0407, span, format!("`{name}` takes {N} argument{plural}"))
                .label(format!("{} given", list.len())),
        );
        None
    }

    fn smooth(
        &mut self,
        function: Function,
        name: &str,
        list: &'a [ast::Expr],
        span: Span,
    ) -> Value<'a> {
        let Some([inner]) = self.exactly::<1>(name, list, span) else { return Value::Poison };
        let Some(scalar) = self.scalar(inner, &format!("the argument of `{name}`")) else {
            return Value::Poison;
        };
        if !self.dimensionless(scalar, name, inner.span) {
            return Value::Poison;
        }
        let id = self.arena.push(Expr::Call(function, vec![scalar.id]), span);
        Value::Scalar(Scalar { id, dimension: Some(Dimension::NONE) })
    }

    fn dimensionless(&mut self, scalar: Scalar, name: &str, span: Span) -> bool {
        let Some(found) = scalar.dimension.filter(|d| !d.is_none()) else { return true };
        let mut diagnostic = Diagnostic::error(codes::E0302, span, format!("`{name}` needs a number or an angle"))
            .label(format!("this is {}", found.describe()))
            .note("the power series of the function would add powers of this, which are unlike quantities");
        if let Some(quantity) = found.quantity() {
            diagnostic = diagnostic.help(format!("divide by another {quantity}"));
        }
        self.sink.push(diagnostic);
        false
    }

    fn atan2(&mut self, list: &'a [ast::Expr], span: Span) -> Value<'a> {
        let Some([y, x]) = self.exactly::<2>("atan2", list, span) else { return Value::Poison };
        let (a, b) = (
            self.scalar(y, "the first argument of `atan2`"),
            self.scalar(x, "the second argument of `atan2`"),
        );
        let (Some(a), Some(b)) = (a, b) else { return Value::Poison };
        if self.common(&[(a, y.span), (b, x.span)]).is_none() {
            return Value::Poison;
        }
        let id = self.arena.push(Expr::Call(Function::Atan2, vec![a.id, b.id]), span);
        Value::Scalar(Scalar { id, dimension: Some(Dimension::NONE) })
    }

    /// Reports scalars of unlike dimension.
    pub(super) fn common(&mut self, list: &[(Scalar, Span)]) -> Option<()> {
        let known = list.iter().find_map(|(s, at)| s.dimension.map(|d| (d, *at)));
        let Some((wanted, first)) = known else { return Some(()) };
        for (scalar, span) in list {
            if let Some(found) = scalar.dimension.filter(|d| *d != wanted) {
                self.sink.push(
                    Diagnostic::error(codes::E0301, *span, "these are unlike quantities")
                        .label(found.describe())
                        .also(first, wanted.describe()),
                );
                return None;
            }
        }
        Some(())
    }

    fn dot(&mut self, list: &'a [ast::Expr], span: Span) -> Value<'a> {
        let Some([a, b]) = self.exactly::<2>("dot", list, span) else { return Value::Poison };
        let result = match (self.eval(a), self.eval(b)) {
            (Value::Array(x), Value::Array(y)) if x.entries.len() == y.entries.len() => {
                self.dot_arrays(&x, &y, span)
            }
            (Value::Array(x), Value::Array(y)) => {
                return self.lengths(a.span, x.entries.len(), b.span, y.entries.len());
            }
            (x, y) => match (self.as_vector(&x, a.span), self.as_vector(&y, b.span)) {
                (Some(x), Some(y)) => self.dot_vectors(&x, &y, span),
                _ => None,
            },
        };
        result.map_or(Value::Poison, Value::Scalar)
    }

    fn cross(&mut self, list: &'a [ast::Expr], span: Span) -> Value<'a> {
        let Some([a, b]) = self.exactly::<2>("cross", list, span) else { return Value::Poison };
        let (x, y) = (self.eval(a), self.eval(b));
        let (Some(x), Some(y)) = (self.as_vector(&x, a.span), self.as_vector(&y, b.span)) else {
            return Value::Poison;
        };
        let dimension = match (x.dimension, y.dimension) {
            (Some(p), Some(q)) => p.times(q),
            _ => None,
        };
        let id = self.arena.push_vector(Vector::Cross(x.id, y.id), span);
        Value::Vector(super::value::Geometric { id, dimension, terms: None })
    }

    fn omega(&mut self, list: &'a [ast::Expr], span: Span) -> Value<'a> {
        let Some([inner]) = self.exactly::<1>("omega", list, span) else { return Value::Poison };
        let Some(frame) = self.frame_of(inner) else { return Value::Poison };
        let id = self.arena.push_vector(Vector::AngularVelocity(frame), span);
        let dimension = Some(Dimension::whole(0, 0, -1));
        Value::Vector(super::value::Geometric { id, dimension, terms: None })
    }

    /// `diag(xx, yy, zz)` or `sym(xx, yy, zz, xy, xz, yz)`.
    fn matrix(&mut self, name: &str, list: &'a [ast::Expr], span: Span) -> Value<'a> {
        let count = if name == "diag" { 3 } else { 6 };
        if list.len() != count {
            self.sink.push(
                Diagnostic::error(codes::E0407, span, format!("`{name}` takes {count} arguments"))
                    .label(format!("{} given", list.len())),
            );
            return Value::Poison;
        }
        let mut entries = Vec::with_capacity(6);
        for expr in list {
            let Some(scalar) = self.scalar(expr, "an entry of a matrix") else {
                return Value::Poison;
            };
            entries.push((scalar, expr.span));
        }
        if self.common(&entries).is_none() {
            return Value::Poison;
        }
        let zero = Scalar { id: self.arena.number(ratio(0, 1), span), dimension: None };
        let at = |i: usize| entries.get(i).map_or(zero, |e| e.0);
        let (xy, xz, yz) = (at(3), at(4), at(5));
        Value::Matrix(Rc::new([[at(0), xy, xz], [xy, at(1), yz], [xz, yz, at(2)]]))
    }

    pub(super) fn sum_over(&mut self, sum: &'a Loop<ast::Expr>, span: Span) -> Value<'a> {
        let Some(range) = self.range(&sum.from, &sum.to, sum.inclusive) else {
            return Value::Poison;
        };
        let mut parts = Vec::new();
        for i in range {
            if !self.expand(span) {
                return Value::Poison;
            }
            let outer = self.scope;
            let prefix = self.scopes[outer].prefix.clone();
            self.scope = self.enter(Level::Repetition, outer, prefix);
            self.bind_index(&sum.variable, i);
            let value = self.eval(&sum.body);
            self.scope = outer;
            self.scopes.pop();
            parts.push(super::expr::Part { value, span: sum.body.span, inverse: false });
        }
        if parts.is_empty() {
            let id = self.arena.number(ratio(0, 1), span);
            return Value::Scalar(Scalar { id, dimension: None });
        }
        self.sum(parts, span)
    }
}
