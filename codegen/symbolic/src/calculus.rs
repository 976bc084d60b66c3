//! Derivatives: forward (tangents) and reverse (gradients) sweeps over the shared graph.

use crate::{Graph, Id, Node, Symbol, Unary};
use std::collections::HashMap;

/// A forward sweep that remembers what it has differentiated, so that several values share one.
#[derive(Clone, Debug)]
pub struct Tangent {
    seeds: HashMap<Symbol, Id>,
    known: HashMap<Id, Id>,
}

impl Tangent {
    /// The directional derivative in which each listed symbol moves at the given rate.
    #[must_use]
    pub fn new(seeds: impl IntoIterator<Item = (Symbol, Id)>) -> Self {
        Self { seeds: seeds.into_iter().collect(), known: HashMap::new() }
    }

    /// The partial derivative by one symbol.
    #[must_use]
    pub fn partial(graph: &Graph, symbol: Symbol) -> Self {
        Self::new([(symbol, graph.one())])
    }

    /// Derivative of a value.
    pub fn of(&mut self, graph: &mut Graph, id: Id) -> Id {
        for step in needed(graph, &[id], |x| self.known.contains_key(&x)) {
            let derivative = self.step(graph, step);
            self.known.insert(step, derivative);
        }
        self.known[&id]
    }

    fn step(&self, graph: &mut Graph, id: Id) -> Id {
        let d = |x: Id| self.known[&x];
        match graph.node(id).clone() {
            Node::Constant(_) | Node::Pi => graph.zero(),
            Node::Symbol(symbol) => self.seeds.get(&symbol).copied().unwrap_or(graph.zero()),
            Node::Add(a, b) => graph.add(d(a), d(b)),
            Node::Sub(a, b) => graph.sub(d(a), d(b)),
            Node::Neg(a) => graph.neg(d(a)),
            Node::Mul(a, b) => {
                let left = graph.mul(d(a), b);
                let right = graph.mul(a, d(b));
                graph.add(left, right)
            }
            Node::Div(a, b) => {
                // (a/b)' = (a' − (a/b) b')/b
                let change = graph.mul(id, d(b));
                let top = graph.sub(d(a), change);
                graph.div(top, b)
            }
            Node::Unary(function, a) => {
                if graph.is_zero(d(a)) {
                    return graph.zero();
                }
                let slope = slope(graph, function, a, id);
                graph.mul(slope, d(a))
            }
            Node::Atan2(y, x) => {
                let (by_y, by_x) = atan2_slopes(graph, y, x);
                let left = graph.mul(by_y, d(y));
                let right = graph.mul(by_x, d(x));
                graph.add(left, right)
            }
        }
    }
}

/// Reverse sweep: derivatives of Σ seedᵢ·outputᵢ by each symbol, seeds held constant.
pub fn gradient(graph: &mut Graph, outputs: &[(Id, Id)], symbols: &[Symbol]) -> Vec<Id> {
    let roots: Vec<Id> = outputs.iter().map(|&(output, _)| output).collect();
    let order = needed(graph, &roots, |_| false);
    let wanted = depends_on(graph, &order, symbols);
    let mut adjoint: HashMap<Id, Id> = HashMap::new();
    for &(output, seed) in outputs {
        accumulate(graph, &mut adjoint, output, seed);
    }
    for &id in order.iter().rev() {
        let Some(&bar) = adjoint.get(&id) else { continue };
        for (operand, factor) in local_slopes(graph, id) {
            if wanted.contains_key(&operand) {
                let part = graph.mul(bar, factor);
                accumulate(graph, &mut adjoint, operand, part);
            }
        }
    }
    symbols
        .iter()
        .map(|&symbol| {
            let id = graph.symbol(symbol);
            adjoint.get(&id).copied().unwrap_or(graph.zero())
        })
        .collect()
}

/// A value with symbols (or any other values) replaced by others.
pub fn substitute(graph: &mut Graph, ids: &[Id], replacement: &HashMap<Id, Id>) -> Vec<Id> {
    let mut known = replacement.clone();
    for id in needed(graph, ids, |x| replacement.contains_key(&x)) {
        let image = rebuild(graph, id, &|x| known[&x]);
        known.insert(id, image);
    }
    ids.iter().map(|id| known[id]).collect()
}

/// Copies values of one graph into another.
#[must_use]
pub fn transfer(from: &Graph, ids: &[Id], into: &mut Graph) -> Vec<Id> {
    let mut known: HashMap<Id, Id> = HashMap::new();
    for id in needed(from, ids, |_| false) {
        let image = rebuild_node(into, from.node(id), &|x| known[&x]);
        if let Some(name) = from.label_of(id) {
            into.label(image, name);
        }
        known.insert(id, image);
    }
    ids.iter().map(|id| known[id]).collect()
}

fn rebuild(graph: &mut Graph, id: Id, image: &dyn Fn(Id) -> Id) -> Id {
    let node = graph.node(id).clone();
    rebuild_node(graph, &node, image)
}

fn rebuild_node(graph: &mut Graph, node: &Node, image: &dyn Fn(Id) -> Id) -> Id {
    match *node {
        Node::Constant(ref value) => graph.constant(value.clone()),
        Node::Pi => graph.pi(),
        Node::Symbol(symbol) => graph.symbol(symbol),
        Node::Add(a, b) => graph.add(image(a), image(b)),
        Node::Sub(a, b) => graph.sub(image(a), image(b)),
        Node::Mul(a, b) => graph.mul(image(a), image(b)),
        Node::Div(a, b) => graph.div(image(a), image(b)),
        Node::Neg(a) => graph.neg(image(a)),
        Node::Unary(function, a) => graph.unary(function, image(a)),
        Node::Atan2(y, x) => graph.atan2(image(y), image(x)),
    }
}

/// All values that `ids` need, operands first, without those for which `stop` holds.
#[must_use]
pub fn needed(graph: &Graph, ids: &[Id], stop: impl Fn(Id) -> bool) -> Vec<Id> {
    let mut seen = vec![false; ids.iter().map(|id| id.index() + 1).max().unwrap_or(0)];
    let mut stack: Vec<Id> = ids.to_vec();
    let mut order = Vec::new();
    while let Some(id) = stack.pop() {
        if seen[id.index()] || stop(id) {
            continue;
        }
        seen[id.index()] = true;
        order.push(id);
        stack.extend(graph.node(id).operands().into_iter().flatten());
    }
    // Operands have smaller indices than the nodes that use them.
    order.sort_unstable();
    order
}

/// Symbols that a value is written in.
#[must_use]
pub fn symbols_of(graph: &Graph, ids: &[Id]) -> std::collections::BTreeSet<Symbol> {
    needed(graph, ids, |_| false)
        .into_iter()
        .filter_map(|id| match graph.node(id) {
            Node::Symbol(symbol) => Some(*symbol),
            _ => None,
        })
        .collect()
}

fn depends_on(graph: &Graph, order: &[Id], symbols: &[Symbol]) -> HashMap<Id, ()> {
    let mut wanted = HashMap::new();
    for &id in order {
        let own = matches!(graph.node(id), Node::Symbol(s) if symbols.contains(s));
        let inherited =
            graph.node(id).operands().into_iter().flatten().any(|x| wanted.contains_key(&x));
        if own || inherited {
            wanted.insert(id, ());
        }
    }
    wanted
}

fn accumulate(graph: &mut Graph, adjoint: &mut HashMap<Id, Id>, id: Id, part: Id) {
    let sum = match adjoint.get(&id) {
        Some(&old) => graph.add(old, part),
        None => part,
    };
    adjoint.insert(id, sum);
}

/// Partial derivatives of a node by its operands.
fn local_slopes(graph: &mut Graph, id: Id) -> Vec<(Id, Id)> {
    let one = graph.one();
    match graph.node(id).clone() {
        Node::Constant(_) | Node::Pi | Node::Symbol(_) => Vec::new(),
        Node::Add(a, b) => vec![(a, one), (b, one)],
        Node::Sub(a, b) => {
            let minus = graph.integer(-1);
            vec![(a, one), (b, minus)]
        }
        Node::Neg(a) => vec![(a, graph.integer(-1))],
        Node::Mul(a, b) => vec![(a, b), (b, a)],
        Node::Div(a, b) => {
            let inverse = graph.div(one, b);
            let ratio = graph.mul(id, inverse);
            vec![(a, inverse), (b, graph.neg(ratio))]
        }
        Node::Unary(function, a) => vec![(a, slope(graph, function, a, id))],
        Node::Atan2(y, x) => {
            let (by_y, by_x) = atan2_slopes(graph, y, x);
            vec![(y, by_y), (x, by_x)]
        }
    }
}

/// Derivative of a function of one argument at `x`, where its value is `value`.
fn slope(graph: &mut Graph, function: Unary, x: Id, value: Id) -> Id {
    let one = graph.one();
    match function {
        Unary::Sin => graph.cos(x),
        Unary::Cos => {
            let sine = graph.sin(x);
            graph.neg(sine)
        }
        Unary::Exp => value,
        Unary::Ln => graph.div(one, x),
        Unary::Sqrt => {
            let double = graph.add(value, value);
            graph.div(one, double)
        }
        Unary::Asin | Unary::Acos => {
            let square = graph.mul(x, x);
            let rest = graph.sub(one, square);
            let root = graph.unary(Unary::Sqrt, rest);
            let positive = graph.div(one, root);
            if function == Unary::Asin { positive } else { graph.neg(positive) }
        }
        Unary::Atan => {
            let square = graph.mul(x, x);
            let bottom = graph.add(one, square);
            graph.div(one, bottom)
        }
    }
}

/// ∂atan2(y, x)/∂y = x/r² and ∂/∂x = −y/r².
fn atan2_slopes(graph: &mut Graph, y: Id, x: Id) -> (Id, Id) {
    let (yy, xx) = (graph.mul(y, y), graph.mul(x, x));
    let square = graph.add(yy, xx);
    let by_y = graph.div(x, square);
    let ratio = graph.div(y, square);
    (by_y, graph.neg(ratio))
}
