//! From one state of motion to another.

use super::{Derivatives, DesiredMotion, at_rest, check_duration, check_point, in_time};
use crate::Error;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// Degree of a polynomial with four derivatives given at both ends.
const DEGREE: usize = 9;

/// The polynomial of ninth degree between two states: position, velocity, acceleration, jerk and snap
/// of both ends are met. Between two rests it is the paper's nonic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transfer<T: Ordered, const NX: usize> {
    /// Powers of τ, and of 1 − τ: each is used on its own half, where little cancels.
    halves: [[SVector<T, NX>; DEGREE + 1]; 2],
    duration: T,
}

impl<T: Ordered, const NX: usize> Transfer<T, NX> {
    /// # Errors
    ///
    /// A derivative that is not finite, a duration that is not positive and finite.
    pub fn new(
        from: &Derivatives<T, NX>,
        to: &Derivatives<T, NX>,
        duration: T,
    ) -> Result<Self, Error> {
        for derivative in from {
            check_point("derivatives at the start", derivative)?;
        }
        for derivative in to {
            check_point("derivatives at the goal", derivative)?;
        }
        check_duration(duration)?;
        let points = control_points(from, to, duration);
        let mut mirrored = points;
        mirrored.reverse();
        Ok(Self { halves: [powers(points), powers(mirrored)], duration })
    }

    /// From a position and velocity to another, without acceleration, jerk and snap at both ends: two
    /// of them meet with four continuous derivatives.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn between(
        from: [SVector<T, NX>; 2],
        to: [SVector<T, NX>; 2],
        duration: T,
    ) -> Result<Self, Error> {
        let cruising = |[position, velocity]: [SVector<T, NX>; 2]| {
            let mut derivatives = at_rest(position);
            derivatives[1] = velocity;
            derivatives
        };
        Self::new(&cruising(from), &cruising(to), duration)
    }
}

/// Bézier points with given derivatives at both ends: the first five belong to the start.
pub(super) fn control_points<T: Ordered, const NX: usize>(
    from: &Derivatives<T, NX>,
    to: &Derivatives<T, NX>,
    duration: T,
) -> [SVector<T, NX>; DEGREE + 1] {
    let mut points = [SVector::zeros(); DEGREE + 1];
    for k in 0..DEGREE.div_ceil(2) {
        points[k] = near_end(from, k, duration);
        points[DEGREE - k] = near_end(to, k, -duration);
    }
    points
}

/// From Bernstein to powers: c_k = C(n, k) Δᵏb_0.
fn powers<T: Ordered, const NX: usize>(
    mut points: [SVector<T, NX>; DEGREE + 1],
) -> [SVector<T, NX>; DEGREE + 1] {
    let mut binomial = T::one();
    for k in 0..DEGREE {
        for i in (k + 1..=DEGREE).rev() {
            let before = points[i - 1];
            points[i] -= before;
        }
        points[k] *= binomial;
        binomial *= T::from_f64((DEGREE - k) as f64 / (k + 1) as f64);
    }
    points[DEGREE] *= binomial;
    points
}

/// Value of a polynomial: even and odd powers apart, so that neither chain waits for the other.
#[inline]
fn value<T: Ordered, const NX: usize>(
    coefficients: &[SVector<T, NX>; DEGREE + 1],
    x: T,
) -> SVector<T, NX> {
    let (square, zero) = (x * x, SVector::zeros());
    let (mut even, mut odd) = (zero, zero);
    for k in (0..DEGREE.div_ceil(2)).rev() {
        even = even * square + coefficients[2 * k];
        odd = odd * square + coefficients[2 * k + 1];
    }
    even + odd * x
}

/// Value and four derivatives of a polynomial.
fn evaluate<T: Ordered, const NX: usize>(
    coefficients: &[SVector<T, NX>; DEGREE + 1],
    x: T,
) -> Derivatives<T, NX> {
    // Horner with derivatives: entry r collects the r-th over r!.
    let mut taylor = [SVector::zeros(); 5];
    for coefficient in coefficients.iter().rev() {
        for r in (1..5).rev() {
            taylor[r] = taylor[r] * x + taylor[r - 1];
        }
        taylor[0] = taylor[0] * x + coefficient;
    }
    taylor[0] = value(coefficients, x);
    for (derivative, factorial) in taylor.iter_mut().zip([1.0, 1.0, 2.0, 6.0, 24.0]) {
        *derivative *= T::from_f64(factorial);
    }
    taylor
}

/// b_k = Σ_j C(k, j) (n−j)!/n! hʲ x⁽ʲ⁾.
fn near_end<T: Ordered, const NX: usize>(
    derivatives: &Derivatives<T, NX>,
    k: usize,
    duration: T,
) -> SVector<T, NX> {
    let mut point = SVector::zeros();
    let mut factor = T::one();
    for (j, derivative) in derivatives.iter().enumerate().take(k + 1) {
        point += derivative * factor;
        let ratio = (k - j) as f64 / ((j + 1) * (DEGREE - j)) as f64;
        factor *= duration * T::from_f64(ratio);
    }
    point
}

impl<T: Ordered, const NX: usize> DesiredMotion<T, NX> for Transfer<T, NX> {
    fn duration(&self) -> T {
        self.duration
    }

    fn derivatives(&self, t: T) -> Derivatives<T, NX> {
        if t < T::zero() {
            return at_rest(self.halves[0][0]);
        }
        if t > self.duration {
            return at_rest(self.halves[1][0]);
        }
        let tau = t / self.duration;
        if tau <= T::from_f64(0.5) {
            return in_time(evaluate(&self.halves[0], tau), self.duration);
        }
        let mut x = evaluate(&self.halves[1], T::one() - tau);
        x[1] = -x[1];
        x[3] = -x[3];
        in_time(x, self.duration)
    }

    fn position(&self, t: T) -> SVector<T, NX> {
        let tau = t / self.duration;
        let (half, near) = if tau <= T::from_f64(0.5) {
            (&self.halves[0], tau)
        } else {
            (&self.halves[1], T::one() - tau)
        };
        let near = if near < T::zero() { T::zero() } else { near };
        value(half, near)
    }
}

/// Standing still for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest<T: Ordered, const NX: usize> {
    at: SVector<T, NX>,
    duration: T,
}

impl<T: Ordered, const NX: usize> Rest<T, NX> {
    /// # Errors
    ///
    /// A position that is not finite, a duration that is not positive and finite.
    pub fn new(at: SVector<T, NX>, duration: T) -> Result<Self, Error> {
        check_point("position", &at)?;
        check_duration(duration)?;
        Ok(Self { at, duration })
    }
}

impl<T: Ordered, const NX: usize> DesiredMotion<T, NX> for Rest<T, NX> {
    fn duration(&self) -> T {
        self.duration
    }

    fn derivatives(&self, _: T) -> Derivatives<T, NX> {
        at_rest(self.at)
    }

    fn position(&self, _: T) -> SVector<T, NX> {
        self.at
    }
}
