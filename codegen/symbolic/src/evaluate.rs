//! Numerical values of a graph, in doubles.

use crate::{Graph, Id, Node, Symbol, Unary};
use num_rational::BigRational;
use num_traits::ToPrimitive;

/// The double nearest to an exact number.
#[must_use]
pub fn nearest(value: &BigRational) -> f64 {
    value.to_f64().unwrap_or(f64::NAN)
}

/// Values of `ids` where `value_of` gives the symbols' values.
#[must_use]
pub fn evaluate(graph: &Graph, ids: &[Id], value_of: &dyn Fn(Symbol) -> f64) -> Vec<f64> {
    let order = crate::needed(graph, ids, |_| false);
    let mut values = vec![f64::NAN; order.last().map_or(0, |id| id.index() + 1)];
    for id in order {
        let v = |x: Id| values[x.index()];
        let value = match *graph.node(id) {
            Node::Constant(ref c) => nearest(c),
            Node::Pi => std::f64::consts::PI,
            Node::Symbol(symbol) => value_of(symbol),
            Node::Add(a, b) => v(a) + v(b),
            Node::Sub(a, b) => v(a) - v(b),
            Node::Mul(a, b) => v(a) * v(b),
            Node::Div(a, b) => v(a) / v(b),
            Node::Neg(a) => -v(a),
            Node::Unary(function, a) => apply(function, v(a)),
            Node::Atan2(y, x) => v(y).atan2(v(x)),
        };
        values[id.index()] = value;
    }
    ids.iter().map(|id| values[id.index()]).collect()
}

fn apply(function: Unary, x: f64) -> f64 {
    match function {
        Unary::Sqrt => x.sqrt(),
        Unary::Sin => x.sin(),
        Unary::Cos => x.cos(),
        Unary::Exp => x.exp(),
        Unary::Ln => x.ln(),
        Unary::Asin => x.asin(),
        Unary::Acos => x.acos(),
        Unary::Atan => x.atan(),
    }
}
