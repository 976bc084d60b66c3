//! From the graph to polynomials.

use super::polynomial::{Circle, Polynomial, add_scaled, collect, reduce};
use super::{Atom, Monomial, Polynomials};
use crate::{Graph, Id, Node, Unary, transfer};
use std::collections::HashMap;

/// Expands values to polynomials. `None` if one of them needs more than `budget` terms on the way, if
/// all of them together need more than 16 times that, or if there are more than 64 variables.
#[must_use]
pub fn expand(graph: &Graph, ids: &[Id], budget: usize) -> Option<Polynomials> {
    let order = crate::needed(graph, ids, |_| false);
    let mut expander = Expander::new(graph, budget);
    for &id in &order {
        let value = expander.value(id)?;
        expander.known.insert(id, value);
    }
    expander.finish(ids)
}

struct Expander<'a> {
    source: &'a Graph,
    coefficients: Graph,
    atoms: Vec<Atom>,
    circles: Vec<Circle>,
    /// First variable of the sine and cosine of an angle.
    circular: HashMap<Id, usize>,
    /// Operands of functions, whose polynomials are wanted too.
    inner: Vec<Id>,
    known: HashMap<Id, Polynomial>,
    fixed: HashMap<Id, Id>,
    budget: usize,
    work: usize,
}

impl<'a> Expander<'a> {
    fn new(source: &'a Graph, budget: usize) -> Self {
        Self {
            source,
            coefficients: Graph::new(),
            atoms: Vec::new(),
            circles: Vec::new(),
            circular: HashMap::new(),
            inner: Vec::new(),
            known: HashMap::new(),
            fixed: HashMap::new(),
            budget,
            work: 16 * budget,
        }
    }

    fn value(&mut self, id: Id) -> Option<Polynomial> {
        if let Some(coefficient) =
            fixed_image(self.source, &mut self.coefficients, |x| self.fixed.get(&x).copied(), id)
        {
            self.fixed.insert(id, coefficient);
            let zero = self.coefficients.is_zero(coefficient);
            return Some(if zero { Vec::new() } else { vec![(Monomial::ONE, coefficient)] });
        }
        let value = match *self.source.node(id) {
            Node::Add(a, b) => self.sum(a, b, 1),
            Node::Sub(a, b) => self.sum(a, b, -1),
            Node::Neg(a) => {
                let minus = self.coefficients.integer(-1);
                add_scaled(&mut self.coefficients, &[], &self.known[&a], minus)
            }
            Node::Mul(a, b) => self.product(a, b)?,
            Node::Div(a, b) if self.fixed.contains_key(&b) => {
                let one = self.coefficients.one();
                let inverse = self.coefficients.div(one, self.fixed[&b]);
                add_scaled(&mut self.coefficients, &[], &self.known[&a], inverse)
            }
            Node::Unary(function @ (Unary::Sin | Unary::Cos), angle) => {
                self.circular(function, angle)?
            }
            ref node => self.atom(node.clone())?,
        };
        self.work = self.work.checked_sub(value.len())?;
        (value.len() <= self.budget).then_some(value)
    }

    fn sum(&mut self, a: Id, b: Id, sign: i64) -> Polynomial {
        let factor = self.coefficients.integer(sign);
        add_scaled(&mut self.coefficients, &self.known[&a], &self.known[&b], factor)
    }

    fn product(&mut self, a: Id, b: Id) -> Option<Polynomial> {
        let (left, right) = (&self.known[&a], &self.known[&b]);
        self.work = self.work.checked_sub(left.len() * right.len())?;
        let mut terms = Vec::with_capacity(left.len() * right.len());
        for &(m, x) in left {
            for &(n, y) in right {
                terms.push((m.times(n)?, self.coefficients.mul(x, y)));
            }
        }
        let reduced = reduce(&mut self.coefficients, &self.circles, terms)?;
        Some(collect(&mut self.coefficients, reduced))
    }

    fn circular(&mut self, function: Unary, angle: Id) -> Option<Polynomial> {
        let offset = usize::from(function == Unary::Cos);
        let first = match self.circular.get(&angle) {
            Some(&first) => first,
            None => {
                let first = self.atoms.len();
                let image = transfer(self.source, &[angle], &mut self.coefficients)[0];
                let (sine, cosine) = (self.coefficients.sin(image), self.coefficients.cos(image));
                self.atoms.extend([sine, cosine].map(Atom::Given));
                self.circles.push((first, first + 1));
                self.circular.insert(angle, first);
                first
            }
        };
        self.variable(first + offset)
    }

    fn atom(&mut self, node: Node) -> Option<Polynomial> {
        let operands: Vec<usize> =
            node.operands().into_iter().flatten().map(|x| self.operand(x)).collect();
        let atom = match node {
            Node::Symbol(symbol) => Atom::Given(self.coefficients.symbol(symbol)),
            _ => Atom::Function(node, operands),
        };
        self.atoms.push(atom);
        self.variable(self.atoms.len() - 1)
    }

    fn operand(&mut self, id: Id) -> usize {
        let known = self.inner.iter().position(|&x| x == id);
        known.unwrap_or_else(|| {
            self.inner.push(id);
            self.inner.len() - 1
        })
    }

    fn variable(&self, index: usize) -> Option<Polynomial> {
        let there = index < Monomial::VARIABLES && self.atoms.len() <= Monomial::VARIABLES;
        there.then(|| vec![(Monomial::variable(index), self.coefficients.one())])
    }

    fn finish(self, ids: &[Id]) -> Option<Polynomials> {
        let first_root = self.inner.len();
        let all = self.inner.iter().chain(ids);
        let mut polynomials = Polynomials {
            values: all.map(|id| self.known[id].clone()).collect(),
            roots: (first_root..first_root + ids.len()).collect(),
            coefficients: self.coefficients,
            atoms: self.atoms,
            circles: self.circles,
        };
        polynomials.choose_directions();
        (polynomials.terms() <= 16 * self.budget).then_some(polynomials)
    }
}

/// The image of a value of parameters alone in the graph of coefficients, `None` for any other value.
/// `known` gives the images of the operands that have one.
pub(crate) fn fixed_image(
    source: &Graph,
    target: &mut Graph,
    known: impl Fn(Id) -> Option<Id>,
    id: Id,
) -> Option<Id> {
    let node = source.node(id);
    if matches!(node, Node::Symbol(symbol) if !matches!(symbol, crate::Symbol::Parameter(_))) {
        return None;
    }
    let [a, b] = node.operands().map(|operand| operand.map(&known));
    if a == Some(None) || b == Some(None) {
        return None;
    }
    Some(match (node, a.flatten(), b.flatten()) {
        (Node::Constant(value), ..) => target.constant(value.clone()),
        (Node::Pi, ..) => target.pi(),
        (Node::Symbol(symbol), ..) => target.symbol(*symbol),
        (Node::Neg(_), Some(x), _) => target.neg(x),
        (Node::Unary(function, _), Some(x), _) => target.unary(*function, x),
        (Node::Add(..), Some(x), Some(y)) => target.add(x, y),
        (Node::Sub(..), Some(x), Some(y)) => target.sub(x, y),
        (Node::Mul(..), Some(x), Some(y)) => target.mul(x, y),
        (Node::Div(..), Some(x), Some(y)) => target.div(x, y),
        (Node::Atan2(..), Some(x), Some(y)) => target.atan2(x, y),
        _ => return None,
    })
}
