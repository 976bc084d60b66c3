//! The memory of the refined planner.

use super::basis::{Basis, ORDER, horner};
use super::gram::Normal;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// Everything that the refined planner stores: `POINTS` control points and what it takes to fit them.
/// It does not grow with the samples of a motion.
///
/// The caller owns it, on the stack or in a `static`; a plan borrows it. A curve of s spans has s + 7
/// control points: four spans per second are plenty.
#[derive(Clone, Debug)]
pub struct Workspace<T: Ordered, const NX: usize, const POINTS: usize> {
    pub(crate) basis: Basis<T>,
    /// Control points of the flat output z.
    pub(crate) points: [SVector<T, NX>; POINTS],
    pub(crate) gradient: [SVector<T, NX>; POINTS],
    pub(crate) steps: [SVector<T, NX>; POINTS],
    pub(crate) normal: Normal<T, NX, POINTS>,
}

impl<T: Ordered, const NX: usize, const POINTS: usize> Workspace<T, NX, POINTS> {
    /// An empty workspace.
    pub fn new() -> Self {
        Self {
            basis: Basis::empty(),
            points: [SVector::zeros(); POINTS],
            gradient: [SVector::zeros(); POINTS],
            steps: [SVector::zeros(); POINTS],
            normal: Normal::empty(),
        }
    }
}

impl<T: Ordered, const NX: usize, const POINTS: usize> Default for Workspace<T, NX, POINTS> {
    fn default() -> Self {
        Self::new()
    }
}

/// z and u = z̈ on one span, as polynomials in σ; derivatives by time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpanCurve<T: Ordered, const NX: usize> {
    flat: [SVector<T, NX>; ORDER],
    acceleration: [SVector<T, NX>; ORDER - 2],
    rate: [SVector<T, NX>; ORDER - 3],
    second: [SVector<T, NX>; ORDER - 4],
}

impl<T: Ordered, const NX: usize> SpanCurve<T, NX> {
    /// `length`: of a span, seconds.
    pub(crate) fn new(basis: &Basis<T>, points: &[SVector<T, NX>], span: usize, length: T) -> Self {
        let number = |n: usize| T::from_f64(n as f64);
        let mut flat = [SVector::zeros(); ORDER];
        // Relative to one of the points: the functions sum to one, and little cancels.
        let middle = points.get(span + ORDER / 2).copied().unwrap_or_else(SVector::zeros);
        for (functions, point) in basis.span(span).iter().zip(points.iter().skip(span)) {
            let point = point - middle;
            for (entry, &coefficient) in flat.iter_mut().zip(functions) {
                *entry += point * coefficient;
            }
        }
        flat[0] += middle;
        let per_second = T::one() / length;
        let squared = per_second * per_second;
        let acceleration: [_; ORDER - 2] =
            core::array::from_fn(|k| flat[k + 2] * (number((k + 1) * (k + 2)) * squared));
        let rate: [_; ORDER - 3] =
            core::array::from_fn(|k| acceleration[k + 1] * (number(k + 1) * per_second));
        let second = core::array::from_fn(|k| rate[k + 1] * (number(k + 1) * per_second));
        Self { flat, acceleration, rate, second }
    }

    /// z.
    #[inline]
    pub(crate) fn flat(&self, sigma: T) -> SVector<T, NX> {
        horner(&self.flat, sigma)
    }

    /// u, u̇, ü.
    #[inline]
    pub(crate) fn acceleration(&self, sigma: T) -> [SVector<T, NX>; 3] {
        [horner(&self.acceleration, sigma), horner(&self.rate, sigma), horner(&self.second, sigma)]
    }

    /// ż, for a span of `length` seconds.
    pub(crate) fn flat_rate(&self, sigma: T, length: T) -> SVector<T, NX> {
        let slopes: [_; ORDER - 1] =
            core::array::from_fn(|k| self.flat[k + 1] * T::from_f64((k + 1) as f64));
        horner(&slopes, sigma) / length
    }
}
