//! Polynomials with exact coefficients; their sums and products.

use super::monomial::Monomial;
use crate::{Graph, Id};

/// Terms by rising monomial; the coefficients are nonzero values of a graph.
pub(crate) type Polynomial = Vec<(Monomial, Id)>;

/// `a + factor·b`.
pub(crate) fn add_scaled(
    graph: &mut Graph,
    a: &[(Monomial, Id)],
    b: &[(Monomial, Id)],
    factor: Id,
) -> Polynomial {
    let mut sum = Vec::with_capacity(a.len() + b.len());
    let (mut i, mut j) = (0, 0);
    while i < a.len() || j < b.len() {
        let left = a.get(i).map(|term| term.0);
        let right = b.get(j).map(|term| term.0);
        let take_left = left.is_some_and(|l| right.is_none_or(|r| l <= r));
        let take_right = right.is_some_and(|r| left.is_none_or(|l| r <= l));
        let mut coefficient = graph.zero();
        let mut monomial = Monomial::ONE;
        if take_left {
            (monomial, coefficient) = a[i];
            i += 1;
        }
        if take_right {
            let scaled = graph.mul(factor, b[j].1);
            monomial = b[j].0;
            coefficient = graph.add(coefficient, scaled);
            j += 1;
        }
        if !graph.is_zero(coefficient) {
            sum.push((monomial, coefficient));
        }
    }
    sum
}

/// Sorts terms and adds those of one monomial.
pub(crate) fn collect(graph: &mut Graph, mut terms: Vec<(Monomial, Id)>) -> Polynomial {
    terms.sort_unstable();
    let mut sum: Polynomial = Vec::with_capacity(terms.len());
    for (monomial, coefficient) in terms {
        match sum.last_mut() {
            Some(last) if last.0 == monomial => last.1 = graph.add(last.1, coefficient),
            _ => sum.push((monomial, coefficient)),
        }
    }
    sum.retain(|term| !graph.is_zero(term.1));
    sum
}

/// Pairs of variables with x² + y² = 1, of which `.0` is reduced: x² → 1 − y².
pub(crate) type Circle = (usize, usize);

/// Terms reduced by the circles: no first variable is left squared. `None` when an exponent overflows.
pub(crate) fn reduce(
    graph: &mut Graph,
    circles: &[Circle],
    terms: Vec<(Monomial, Id)>,
) -> Option<Vec<(Monomial, Id)>> {
    let mut done = Vec::with_capacity(terms.len());
    let mut open = terms;
    while let Some((monomial, coefficient)) = open.pop() {
        let Some(&(x, y)) = circles.iter().find(|circle| monomial.exponent(circle.0) >= 2) else {
            done.push((monomial, coefficient));
            continue;
        };
        let rest = monomial.with_exponent(x, monomial.exponent(x) - 2);
        let squared = rest.times(Monomial::variable(y))?.times(Monomial::variable(y))?;
        open.push((rest, coefficient));
        open.push((squared, graph.neg(coefficient)));
    }
    Some(done)
}
