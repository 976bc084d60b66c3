//! Bézier curves in output space (Eq. 37).

use super::{Derivatives, DesiredMotion, at_rest, check_duration, check_point, in_time};
use crate::Error;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// Largest degree of a [`Bezier`]. Up to here no power underflows, in single precision either.
pub const MAX_BEZIER_DEGREE: usize = 64;

/// A Bézier curve, run through uniformly in time: Eq. 37 with t₁ = t / duration.
///
/// The control points stay with the caller. A point repeated r times at an end puts the motion at
/// rest there up to derivative r − 1: five equal points at both ends make it rest to rest in all that
/// the planner uses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bezier<'a, T: Ordered, const NX: usize> {
    points: &'a [SVector<T, NX>],
    duration: T,
}

impl<'a, T: Ordered, const NX: usize> Bezier<'a, T, NX> {
    /// A curve of degree `points.len() − 1` through output space (metres) in `duration` seconds.
    ///
    /// # Errors
    ///
    /// Fewer than two points, more than [`MAX_BEZIER_DEGREE`] + 1, a coordinate that is not finite, a
    /// duration that is not positive and finite.
    pub fn new(points: &'a [SVector<T, NX>], duration: T) -> Result<Self, Error> {
        if !(2..=MAX_BEZIER_DEGREE + 1).contains(&points.len()) {
            return Err(Error::Invalid {
                field: "number of control points",
                value: points.len() as f64,
                expected: "from 2 to 65",
            });
        }
        for point in points {
            check_point("coordinates of a control point", point)?;
        }
        check_duration(duration)?;
        Ok(Self { points, duration })
    }

    /// A curve whose parts were checked already.
    pub(super) const fn unchecked(points: &'a [SVector<T, NX>], duration: T) -> Self {
        Self { points, duration }
    }

    /// Degree of the curve.
    pub const fn degree(&self) -> usize {
        self.points.len().saturating_sub(1)
    }

    /// The k-th control point, counted from the end if `reversed`.
    fn point(&self, k: usize, reversed: bool) -> SVector<T, NX> {
        let k = if reversed { self.degree().saturating_sub(k) } else { k };
        self.points.get(k).copied().unwrap_or_else(SVector::zeros)
    }

    /// The r-th forward difference of the control points at k, r ≤ 4.
    fn difference(&self, r: usize, k: usize, reversed: bool) -> SVector<T, NX> {
        let mut table = [SVector::zeros(); 5];
        for (i, entry) in table.iter_mut().enumerate().take(r + 1) {
            *entry = self.point(k + i, reversed);
        }
        for level in 0..r {
            for i in 0..r - level {
                table[i] = table[i + 1] - table[i];
            }
        }
        table[0]
    }

    /// The r-th derivative with respect to τ ≤ ½: n!/(n−r)! Σ_k C(n−r, k) τᵏ (1−τ)ⁿ⁻ʳ⁻ᵏ Δʳp_k.
    fn derivative(&self, r: usize, tau: T, reversed: bool) -> SVector<T, NX> {
        let number = |n: usize| T::from_f64(n as f64);
        if r > self.degree() {
            return SVector::zeros();
        }
        let degree = self.degree() - r;
        let rest = T::one() - tau;
        let ratio = tau / rest;
        let mut bernstein = (0..degree).fold(T::one(), |product, _| product * rest);
        let mut sum = SVector::zeros();
        for k in 0..=degree {
            sum += self.difference(r, k, reversed) * bernstein;
            bernstein *= ratio * number(degree - k) / number(k + 1);
        }
        (0..r).fold(sum, |scaled, i| scaled * number(self.degree() - i))
    }
}

impl<T: Ordered, const NX: usize> DesiredMotion<T, NX> for Bezier<'_, T, NX> {
    fn duration(&self) -> T {
        self.duration
    }

    fn derivatives(&self, t: T) -> Derivatives<T, NX> {
        if t < T::zero() {
            return at_rest(self.point(0, false));
        }
        if t > self.duration {
            return at_rest(self.point(0, true));
        }
        // From the nearer end, so that neither power of the Bernstein polynomials vanishes early.
        let tau = t / self.duration;
        let reversed = tau > T::from_f64(0.5);
        let near = if reversed { T::one() - tau } else { tau };
        let mut x = core::array::from_fn(|r| self.derivative(r, near, reversed));
        if reversed {
            x[1] = -x[1];
            x[3] = -x[3];
        }
        in_time(x, self.duration)
    }

    fn position(&self, t: T) -> SVector<T, NX> {
        if t < T::zero() {
            return self.point(0, false);
        }
        if t > self.duration {
            return self.point(0, true);
        }
        let tau = t / self.duration;
        let reversed = tau > T::from_f64(0.5);
        self.derivative(0, if reversed { T::one() - tau } else { tau }, reversed)
    }
}
