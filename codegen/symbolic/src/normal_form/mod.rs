//! The trigonometric normal form: polynomials in the coordinates, rates, sines and cosines, with
//! s² → 1 − c² (or c² → 1 − s², where that leaves fewer terms).
//!
//! What depends on parameters alone is a coefficient: numbers of the model in one case, symbols that
//! are folded before the first evaluation in the other.

mod expand;
mod monomial;
mod polynomial;

use crate::{Graph, Id, Node};
use monomial::Monomial;
use polynomial::{Circle, Polynomial};

pub use expand::expand;
pub(crate) use expand::fixed_image;

/// A variable of the polynomials.
#[derive(Clone, Debug)]
pub(crate) enum Atom {
    /// An input, or the sine or cosine of an angle: a value of the graph of coefficients. The form of
    /// an angle is kept, since the graph relates angles by it.
    Given(Id),
    /// Another function of polynomials; the node's own operands are of the source graph.
    Function(Node, Vec<usize>),
}

/// Values as polynomials in shared variables.
#[derive(Clone, Debug)]
pub struct Polynomials {
    /// Holds the coefficients, values of parameters alone, and the atoms that are given.
    pub(crate) coefficients: Graph,
    pub(crate) atoms: Vec<Atom>,
    pub(crate) values: Vec<Polynomial>,
    /// The values asked for; the other ones are operands of functions.
    pub(crate) roots: Vec<usize>,
    circles: Vec<Circle>,
}

impl Polynomials {
    /// Number of terms of all values together, operands of functions included.
    #[must_use]
    pub fn terms(&self) -> usize {
        self.values.iter().map(Vec::len).sum()
    }

    /// Terms of one value: coefficient and variables, each variable as often as it is a factor.
    pub(crate) fn expanded(&self, value: usize) -> impl Iterator<Item = (Id, Vec<usize>)> {
        self.values[value].iter().map(|&(monomial, coefficient)| (coefficient, monomial.factors()))
    }

    /// Turns each circle's direction around where that leaves fewer terms.
    pub(crate) fn choose_directions(&mut self) {
        for index in 0..self.circles.len() {
            let (x, y) = self.circles[index];
            let mut circles = self.circles.clone();
            circles[index] = (y, x);
            if let Some(values) = self.reduced(&circles)
                && values.iter().map(Vec::len).sum::<usize>() < self.terms()
            {
                self.values = values;
                self.circles = circles;
            }
        }
    }

    fn reduced(&mut self, circles: &[Circle]) -> Option<Vec<Polynomial>> {
        let graph = &mut self.coefficients;
        let one_value = |value: &Polynomial| {
            let terms = polynomial::reduce(graph, circles, value.clone())?;
            Some(polynomial::collect(graph, terms))
        };
        self.values.iter().map(one_value).collect()
    }

    /// The values as sums of products, term by term, in a new graph.
    #[must_use]
    pub fn rebuild(&self) -> (Graph, Vec<Id>) {
        crate::optimise::emit_polynomials(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Symbol;

    #[test]
    fn squares_of_sine_and_cosine_cancel() {
        let mut graph = Graph::new();
        let (x, p) = (graph.symbol(Symbol::Coordinate(0)), graph.symbol(Symbol::Parameter(0)));
        let rate = graph.symbol(Symbol::Rate(0));
        let (s, c) = (graph.sin(x), graph.cos(x));
        let (a, b) = (graph.mul(s, rate), graph.mul(c, rate));
        let (aa, bb) = (graph.mul(a, a), graph.mul(b, b));
        let (paa, qbb) = (graph.mul(p, aa), graph.mul(p, bb));
        let part = graph.add(paa, rate);
        let sum = graph.add(part, qbb);
        let polynomials = expand(&graph, &[sum], 100).unwrap();
        assert_eq!(polynomials.values[polynomials.roots[0]].len(), 2);
        let (rebuilt, ids) = polynomials.rebuild();
        assert!(graph.same_value(sum, &rebuilt, ids[0]));
    }

    #[test]
    fn the_direction_with_fewer_terms_is_taken() {
        let mut graph = Graph::new();
        let x = graph.symbol(Symbol::Coordinate(0));
        let rates: Vec<Id> = (0..3).map(|i| graph.symbol(Symbol::Rate(i))).collect();
        let s = graph.sin(x);
        let ss = graph.mul(s, s);
        let products: Vec<Id> = rates.iter().map(|&rate| graph.mul(ss, rate)).collect();
        let polynomials = expand(&graph, &products, 100).unwrap();
        assert_eq!(polynomials.terms(), 3);
    }

    #[test]
    fn too_many_terms_give_none() {
        let mut graph = Graph::new();
        let mut product = graph.one();
        for i in 0..20 {
            let (a, b) = (graph.symbol(Symbol::Rate(2 * i)), graph.symbol(Symbol::Rate(2 * i + 1)));
            let sum = graph.add(a, b);
            product = graph.mul(product, sum);
        }
        assert!(expand(&graph, &[product], 5000).is_none());
    }
}
