//! Clamped B-splines of degree seven on equal spans.
//!
//! The flat output z has degree seven, so that the virtual acceleration u = z̈ is a clamped quintic.
//! On a span each of the eight basis functions is a polynomial in σ, the fraction of the span that has
//! passed. Except near the ends all spans are alike: at most fifteen of them are distinct.

use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// Degree of z.
pub(crate) const DEGREE: usize = 7;
/// Basis functions that are not zero on a span.
pub(crate) const ORDER: usize = DEGREE + 1;
/// Spans that differ from each other: seven at each end, and the rest.
const DISTINCT: usize = 2 * DEGREE + 1;

/// `[i][k]` is the coefficient of σᵏ in the i-th basis function of a span.
pub(crate) type SpanBasis<T> = [[T; ORDER]; ORDER];

/// The basis functions of all spans.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Basis<T> {
    spans: usize,
    distinct: [SpanBasis<T>; DISTINCT],
}

impl<T: Ordered> Basis<T> {
    /// No spans.
    pub(crate) fn empty() -> Self {
        Self { spans: 0, distinct: [[[T::zero(); ORDER]; ORDER]; DISTINCT] }
    }

    pub(crate) fn new(spans: usize) -> Self {
        let mut basis = Self { spans, ..Self::empty() };
        for (index, entry) in basis.distinct.iter_mut().enumerate().take(spans) {
            let span =
                if spans > DISTINCT && index > DEGREE { spans + index - DISTINCT } else { index };
            *entry = span_basis(spans, span);
        }
        basis
    }

    /// Makes this the basis of `spans` spans, if it is not.
    pub(crate) fn prepare(&mut self, spans: usize) {
        if self.spans != spans {
            *self = Self::new(spans);
        }
    }

    pub(crate) fn span(&self, span: usize) -> &SpanBasis<T> {
        let index = if self.spans <= DISTINCT || span <= DEGREE {
            span
        } else if span + DEGREE >= self.spans {
            span + DISTINCT - self.spans
        } else {
            DEGREE
        };
        &self.distinct[index.min(DISTINCT - 1)]
    }

    /// The first control points of a curve whose derivatives by σ at the start are given, as many as
    /// there are derivatives. Those of the end follow by symmetry: odd derivatives change their sign.
    pub(crate) fn end_points<const NX: usize, const N: usize>(
        &self,
        derivatives: &[SVector<T, NX>; N],
    ) -> [SVector<T, NX>; N] {
        let first = &self.distinct[0];
        let mut points = [SVector::zeros(); N];
        let mut factorial = T::one();
        for order in 0..N.min(ORDER) {
            if order > 1 {
                factorial *= T::from_f64(order as f64);
            }
            let mut rest = derivatives[order] / factorial;
            for k in 0..order {
                rest -= points[k] * first[k][order];
            }
            points[order] = rest / first[order][order];
        }
        points
    }
}

/// Cox and de Boor's recursion on polynomials in σ.
fn span_basis<T: Ordered>(spans: usize, span: usize) -> SpanBasis<T> {
    // Knot k relative to the span's start, in spans: whole numbers.
    let knot = |k: usize| {
        let absolute = k.saturating_sub(DEGREE).min(spans);
        T::from_f64(absolute as f64 - span as f64)
    };
    let mut basis = [[T::zero(); ORDER]; ORDER];
    basis[0][0] = T::one();
    for degree in 1..=DEGREE {
        let mut raised = [[T::zero(); ORDER]; ORDER];
        for r in 0..degree {
            // Function r of the lower degree begins at knot `start`.
            let start = span + DEGREE + 1 + r - degree;
            let (left, right) = (knot(start), knot(start + degree));
            let width = right - left;
            for k in 0..degree {
                let coefficient = basis[r][k] / width;
                raised[r][k] += coefficient * right;
                raised[r][k + 1] -= coefficient;
                raised[r + 1][k] -= coefficient * left;
                raised[r + 1][k + 1] += coefficient;
            }
        }
        basis = raised;
    }
    basis
}

/// Σ cₖ σᵏ.
pub(crate) fn horner<T: Ordered, const NX: usize>(
    coefficients: &[SVector<T, NX>],
    sigma: T,
) -> SVector<T, NX> {
    coefficients.iter().rev().fold(SVector::zeros(), |sum, c| sum * sigma + c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector1;

    fn value(basis: &SpanBasis<f64>, i: usize, sigma: f64) -> f64 {
        basis[i].iter().rev().fold(0.0, |sum, c| sum * sigma + c)
    }

    #[test]
    fn basis_functions_are_a_partition_of_unity_and_join_smoothly() {
        for spans in [1, 2, 5, 14, 15, 16, 17, 40] {
            let basis = Basis::<f64>::new(spans);
            for span in 0..spans {
                for sigma in [0.0, 0.3, 1.0] {
                    let sum: f64 = (0..ORDER).map(|i| value(basis.span(span), i, sigma)).sum();
                    assert!((sum - 1.0).abs() < 1e-13, "{spans} {span} {sigma}: {sum}");
                }
                if span + 1 < spans {
                    for i in 1..ORDER {
                        let before = value(basis.span(span), i, 1.0);
                        let after = value(basis.span(span + 1), i - 1, 0.0);
                        assert!((before - after).abs() < 1e-13, "{spans} {span} {i}");
                    }
                }
            }
        }
    }

    #[test]
    fn end_points_reproduce_the_derivatives_asked_for() {
        let basis = Basis::<f64>::new(9);
        let asked = [1.0, -2.0, 0.5, 3.0, -7.0].map(Vector1::new);
        let points = basis.end_points(&asked);
        let first = basis.span(0);
        let mut factorial = 1.0;
        for order in 0..5 {
            factorial *= (order as f64).max(1.0);
            let found: f64 = (0..5).map(|i| points[i][0] * first[i][order]).sum();
            assert!((found * factorial - asked[order][0]).abs() < 1e-12, "{order}");
        }
    }
}
