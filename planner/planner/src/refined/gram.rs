//! JᵀJ of the fixed linearisation: assembled once per plan.

use super::banded::Banded;
use super::basis::{Basis, ORDER, SpanBasis};
use super::problem::{Linearised, second_derivatives};
use super::window::Window;
use nalgebra::SMatrix;
use shapebot_dynamics::Ordered;

/// Σ σᵏ over the samples of a span.
type Powers<T> = [T; 2 * ORDER - 1];

/// Adds the samples of all spans to the normal equations.
pub(crate) fn assemble<T: Ordered, const NX: usize, const POINTS: usize>(
    basis: &Basis<T>,
    window: &Window<T>,
    linear: &Linearised<T, NX>,
    normal: &mut Banded<T, NX, POINTS>,
) {
    normal.clear();
    let mut powers: Powers<T> = [T::zero(); 2 * ORDER - 1];
    let mut current = 0;
    for (span, sigma) in window.places().take(window.count) {
        if span != current {
            add_span(basis.span(current), current, &powers, window.span_length(), linear, normal);
            powers = [T::zero(); 2 * ORDER - 1];
            current = span;
        }
        let mut power = T::one();
        for sum in &mut powers {
            *sum += power;
            power *= sigma;
        }
    }
    add_span(basis.span(current), current, &powers, window.span_length(), linear, normal);
}

/// Block (i, j) is Σ (b_i − τ²b̈_i)ᵀ JᵀJ (b_j − τ²b̈_j).
fn add_span<T: Ordered, const NX: usize, const POINTS: usize>(
    basis: &SpanBasis<T>,
    span: usize,
    powers: &Powers<T>,
    length: T,
    linear: &Linearised<T, NX>,
    normal: &mut Banded<T, NX, POINTS>,
) {
    let curvature = second_derivatives(basis, length);
    let metric = linear.jacobian.transpose() * linear.jacobian;
    if let Some(lag) = scalar(&linear.output) {
        // τ² is a number: one function per control point instead of two.
        let mut functions = *basis;
        for (function, bent) in functions.iter_mut().zip(&curvature) {
            for (entry, &bent) in function.iter_mut().zip(bent) {
                *entry -= lag * bent;
            }
        }
        let left = weighted(&functions, powers);
        for i in 0..ORDER {
            for j in 0..=i {
                normal.add(span + i, i - j, &(metric * dot(&left[i], &functions[j])));
            }
        }
        return;
    }
    let once = metric * linear.output;
    let twice = linear.output.transpose() * once;
    let (left, bent) = (weighted(basis, powers), weighted(&curvature, powers));
    for i in 0..ORDER {
        for j in 0..=i {
            let plain = dot(&left[i], &basis[j]);
            let (right, lower) = (dot(&left[i], &curvature[j]), dot(&bent[i], &basis[j]));
            let block = metric * plain - once * right - once.transpose() * lower
                + twice * dot(&bent[i], &curvature[j]);
            normal.add(span + i, i - j, &block);
        }
    }
}

/// `[i][l]`: Σ over the samples of function i times σˡ.
fn weighted<T: Ordered, const N: usize>(
    functions: &[[T; N]; ORDER],
    powers: &Powers<T>,
) -> [[T; ORDER]; ORDER] {
    let mut sums = [[T::zero(); ORDER]; ORDER];
    for (sum, function) in sums.iter_mut().zip(functions) {
        for (k, &coefficient) in function.iter().enumerate() {
            for l in 0..ORDER {
                sum[l] += coefficient * powers[k + l];
            }
        }
    }
    sums
}

fn dot<T: Ordered, const N: usize>(a: &[T; ORDER], b: &[T; N]) -> T {
    let mut sum = T::zero();
    for k in 0..N.min(ORDER) {
        sum += a[k] * b[k];
    }
    sum
}

/// The number that a matrix is a multiple of the identity by.
fn scalar<T: Ordered, const NX: usize>(matrix: &SMatrix<T, NX, NX>) -> Option<T> {
    let first = *matrix.iter().next()?;
    (*matrix == SMatrix::<T, NX, NX>::from_diagonal_element(first)).then_some(first)
}

/// What a 1 × 1 or diagonal matrix has on its diagonal; `None` for another.
pub(crate) fn diagonal<T: Ordered, const NX: usize>(
    matrix: &SMatrix<T, NX, NX>,
) -> Option<[T; NX]> {
    let largest = crate::linear_algebra::largest(matrix.iter().copied());
    for i in 0..NX {
        for j in 0..NX {
            if i != j && matrix[(i, j)].abs() > largest * T::epsilon().sqrt() {
                return None;
            }
        }
    }
    Some(core::array::from_fn(|i| matrix[(i, i)]))
}
