//! A value of the graph laid out for repeated evaluation over boxes.

use super::{Interval, rounded};
use crate::{Graph, Id, Node, Symbol, Unary, nearest, needed};
use std::collections::HashMap;

#[derive(Clone, Copy, Debug)]
enum Step {
    Constant(f64, Interval),
    Input(usize),
    Add(usize, usize),
    Sub(usize, usize),
    Mul(usize, usize),
    Square(usize),
    Div(usize, usize),
    Neg(usize),
    Unary(Unary, usize),
    Atan2(usize, usize),
}

/// Values of a graph in evaluation order, each operand by its position.
#[derive(Clone, Debug)]
pub struct Tape {
    steps: Vec<Step>,
    inputs: Vec<Symbol>,
    results: Vec<usize>,
}

impl Tape {
    /// Lays out what `ids` need.
    #[must_use]
    pub fn new(graph: &Graph, ids: &[Id]) -> Self {
        let mut place: HashMap<Id, usize> = HashMap::new();
        let mut tape = Self { steps: Vec::new(), inputs: Vec::new(), results: Vec::new() };
        for id in needed(graph, ids, |_| false) {
            let step = tape.step(graph.node(id), &place);
            place.insert(id, tape.steps.len());
            tape.steps.push(step);
        }
        tape.results = ids.iter().map(|id| place[id]).collect();
        tape
    }

    fn step(&mut self, node: &Node, place: &HashMap<Id, usize>) -> Step {
        match *node {
            Node::Constant(ref value) => {
                let double = nearest(value);
                let exact = num_rational::BigRational::from_float(double).as_ref() == Some(value);
                let enclosure =
                    if exact { Interval::point(double) } else { Interval::around(double) };
                Step::Constant(double, enclosure)
            }
            Node::Pi => {
                let double = std::f64::consts::PI;
                Step::Constant(double, Interval::around(double))
            }
            Node::Symbol(symbol) => {
                self.inputs.push(symbol);
                Step::Input(self.inputs.len() - 1)
            }
            Node::Add(a, b) => Step::Add(place[&a], place[&b]),
            Node::Sub(a, b) => Step::Sub(place[&a], place[&b]),
            Node::Mul(a, b) if a == b => Step::Square(place[&a]),
            Node::Mul(a, b) => Step::Mul(place[&a], place[&b]),
            Node::Div(a, b) => Step::Div(place[&a], place[&b]),
            Node::Neg(a) => Step::Neg(place[&a]),
            Node::Unary(function, a) => Step::Unary(function, place[&a]),
            Node::Atan2(y, x) => Step::Atan2(place[&y], place[&x]),
        }
    }

    /// The symbols it is written in, in the order in which their values are to be given.
    #[must_use]
    pub fn inputs(&self) -> &[Symbol] {
        &self.inputs
    }

    /// Number of steps.
    #[must_use]
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Whether there is nothing to evaluate.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Results in doubles, rounded as they fall.
    #[must_use]
    pub fn at(&self, inputs: &[f64]) -> Vec<f64> {
        let mut v: Vec<f64> = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            let value = match *step {
                Step::Constant(double, _) => double,
                Step::Input(i) => inputs[i],
                Step::Add(a, b) => v[a] + v[b],
                Step::Sub(a, b) => v[a] - v[b],
                Step::Mul(a, b) => v[a] * v[b],
                Step::Square(a) => v[a] * v[a],
                Step::Div(a, b) => v[a] / v[b],
                Step::Neg(a) => -v[a],
                Step::Unary(function, a) => rounded(function, v[a]),
                Step::Atan2(y, x) => v[y].atan2(v[x]),
            };
            v.push(value);
        }
        self.results.iter().map(|&place| v[place]).collect()
    }

    /// Enclosures of the results over a box.
    #[must_use]
    pub fn over(&self, inputs: &[Interval]) -> Vec<Interval> {
        let v = self.sweep(inputs);
        self.results.iter().map(|&place| v[place]).collect()
    }

    fn sweep(&self, inputs: &[Interval]) -> Vec<Interval> {
        let mut v: Vec<Interval> = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            let value = match *step {
                Step::Constant(_, enclosure) => enclosure,
                Step::Input(i) => inputs[i],
                Step::Add(a, b) => v[a] + v[b],
                Step::Sub(a, b) => v[a] - v[b],
                Step::Mul(a, b) => v[a] * v[b],
                Step::Square(a) => v[a].square(),
                Step::Div(a, b) => v[a].quotient(v[b]),
                Step::Neg(a) => -v[a],
                Step::Unary(function, a) => v[a].apply(function),
                Step::Atan2(y, x) => v[y].atan2(v[x]),
            };
            v.push(value);
        }
        v
    }

    /// Enclosure of the first result and of its derivatives by all inputs over a box.
    #[must_use]
    pub fn with_slopes(&self, inputs: &[Interval]) -> (Interval, Vec<Interval>) {
        let v = self.sweep(inputs);
        let root = self.results[0];
        let mut bar: Vec<Option<Interval>> = vec![None; v.len()];
        bar[root] = Some(Interval::point(1.0));
        let mut slopes = vec![Interval::ZERO; self.inputs.len()];
        for place in (0..=root).rev() {
            let Some(own) = bar[place] else { continue };
            if let Step::Input(i) = self.steps[place] {
                slopes[i] = own;
            }
            for (operand, factor) in self.factors(place, &v).into_iter().flatten() {
                let part = own * factor;
                bar[operand] = Some(bar[operand].map_or(part, |sum| sum + part));
            }
        }
        (v[root], slopes)
    }

    /// Enclosures of the partial derivatives of one step by its operands.
    fn factors(&self, place: usize, v: &[Interval]) -> [Option<(usize, Interval)>; 2] {
        let one = Interval::point(1.0);
        match self.steps[place] {
            Step::Constant(..) | Step::Input(_) => [None, None],
            Step::Add(a, b) => [Some((a, one)), Some((b, one))],
            Step::Sub(a, b) => [Some((a, one)), Some((b, -one))],
            Step::Mul(a, b) => [Some((a, v[b])), Some((b, v[a]))],
            Step::Square(a) => [Some((a, v[a] + v[a])), None],
            Step::Div(a, b) => {
                let inverse = one.quotient(v[b]);
                [Some((a, inverse)), Some((b, -(v[place] * inverse)))]
            }
            Step::Neg(a) => [Some((a, -one)), None],
            Step::Unary(function, a) => [Some((a, slope(function, v[a], v[place]))), None],
            Step::Atan2(y, x) => {
                let square = v[x].square() + v[y].square();
                [Some((y, v[x].quotient(square))), Some((x, -(v[y].quotient(square))))]
            }
        }
    }
}

fn slope(function: Unary, x: Interval, value: Interval) -> Interval {
    let one = Interval::point(1.0);
    match function {
        Unary::Sin => x.apply(Unary::Cos),
        Unary::Cos => -x.apply(Unary::Sin),
        Unary::Exp => value,
        Unary::Ln => one.quotient(x),
        Unary::Sqrt => one.quotient(value + value),
        Unary::Asin => one.quotient((one - x.square()).apply(Unary::Sqrt)),
        Unary::Acos => -one.quotient((one - x.square()).apply(Unary::Sqrt)),
        Unary::Atan => one.quotient(one + x.square()),
    }
}
