//! Interval arithmetic with outward rounding, and proofs by subdivision that a value never vanishes.
//!
//! Every enclosure is widened by at least one unit in the last place after each operation, functions of
//! the platform's mathematical library by four. A claim is made only from enclosures: what the budget
//! does not settle is reported as undecided, never as true.

mod branch;
mod tape;

pub use branch::{Verdict, prove_nonzero};
pub use tape::Tape;

use crate::Unary;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::{Add, Mul, Neg, Sub};

/// All reals between two doubles, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
}

impl Interval {
    /// All reals: also the answer where a function is not defined on the whole argument.
    pub const ENTIRE: Self = Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
    /// Nothing but zero.
    pub const ZERO: Self = Self::point(0.0);

    /// One number.
    #[must_use]
    pub const fn point(value: f64) -> Self {
        Self { lower: value, upper: value }
    }

    /// The numbers from `lower` to `upper`, in either order; everything if one of them is no number.
    #[must_use]
    pub fn new(lower: f64, upper: f64) -> Self {
        if lower.is_nan() || upper.is_nan() {
            return Self::ENTIRE;
        }
        Self { lower: lower.min(upper), upper: lower.max(upper) }
    }

    /// A number of which only the nearest double is known.
    #[must_use]
    pub fn around(nearest: f64) -> Self {
        outward(nearest, nearest, 1)
    }

    /// Whether zero is outside.
    #[must_use]
    pub fn excludes_zero(self) -> bool {
        self.lower > 0.0 || self.upper < 0.0
    }

    /// Whether both ends are finite.
    #[must_use]
    pub fn is_bounded(self) -> bool {
        self.lower.is_finite() && self.upper.is_finite()
    }

    /// Distance between the ends.
    #[must_use]
    pub fn width(self) -> f64 {
        self.upper - self.lower
    }

    /// A number near the middle, always inside.
    #[must_use]
    pub fn middle(self) -> f64 {
        if self.is_bounded() {
            (0.5 * self.lower + 0.5 * self.upper).clamp(self.lower, self.upper)
        } else {
            0.0_f64.clamp(self.lower, self.upper)
        }
    }

    /// Largest absolute value.
    #[must_use]
    pub fn magnitude(self) -> f64 {
        self.lower.abs().max(self.upper.abs())
    }

    /// What both contain; `self` if rounding left nothing.
    #[must_use]
    pub fn intersect(self, other: Self) -> Self {
        let (lower, upper) = (self.lower.max(other.lower), self.upper.min(other.upper));
        if lower <= upper { Self { lower, upper } } else { self }
    }

    /// Square.
    #[must_use]
    pub fn square(self) -> Self {
        let (a, b) = (self.lower * self.lower, self.upper * self.upper);
        if self.excludes_zero() {
            outward(a.min(b), a.max(b), 1)
        } else {
            Self { lower: 0.0, upper: a.max(b).next_up() }
        }
    }

    /// Quotient; everything if the divisor contains zero.
    #[must_use]
    pub fn quotient(self, divisor: Self) -> Self {
        if !divisor.excludes_zero() {
            return Self::ENTIRE;
        }
        let (a, b, c, d) = (self.lower, self.upper, divisor.lower, divisor.upper);
        hull([a / c, a / d, b / c, b / d])
    }

    /// A function of one argument; everything where it is not defined on the whole interval.
    #[must_use]
    pub fn apply(self, function: Unary) -> Self {
        let monotone = |f: fn(f64) -> f64| outward(f(self.lower), f(self.upper), 4);
        match function {
            Unary::Sin => (self - Self::around(FRAC_PI_2)).cosine(),
            Unary::Cos => self.cosine(),
            Unary::Sqrt if self.lower < 0.0 => Self::ENTIRE,
            Unary::Sqrt => {
                let root = monotone(f64::sqrt);
                Self { lower: root.lower.max(0.0), ..root }
            }
            Unary::Exp => {
                let power = monotone(f64::exp);
                Self { lower: power.lower.max(0.0), ..power }
            }
            Unary::Ln if self.lower <= 0.0 => Self::ENTIRE,
            Unary::Ln => monotone(f64::ln),
            Unary::Asin | Unary::Acos if self.lower < -1.0 || self.upper > 1.0 => Self::ENTIRE,
            Unary::Asin => monotone(f64::asin),
            Unary::Acos => outward(self.upper.acos(), self.lower.acos(), 4),
            Unary::Atan => monotone(f64::atan),
        }
    }

    fn cosine(self) -> Self {
        const FAR: f64 = 1e6;
        if self.width() >= TAU || self.magnitude() > FAR {
            return Self { lower: -1.0, upper: 1.0 };
        }
        // Multiples of π inside, with a margin for the rounding of π itself.
        let margin = 1e-9;
        let first = ((self.lower - margin) / PI).ceil();
        let last = ((self.upper + margin) / PI).floor();
        let mut result = outward(
            self.lower.cos().min(self.upper.cos()),
            self.lower.cos().max(self.upper.cos()),
            4,
        );
        let even = |k: f64| k.rem_euclid(2.0) == 0.0;
        if first <= last {
            let (two, first_even) = (last > first, even(first));
            if two || first_even {
                result.upper = 1.0;
            }
            if two || !first_even {
                result.lower = -1.0;
            }
        }
        Self { lower: result.lower.max(-1.0), upper: result.upper.min(1.0) }
    }

    /// Angle of the points (x, y) with `self` the y.
    #[must_use]
    pub fn atan2(self, x: Self) -> Self {
        let quarter = Self::around(FRAC_PI_2);
        if x.lower > 0.0 {
            self.quotient(x).apply(Unary::Atan)
        } else if self.lower > 0.0 {
            quarter - x.quotient(self).apply(Unary::Atan)
        } else if self.upper < 0.0 {
            -quarter - x.quotient(self).apply(Unary::Atan)
        } else {
            Self { lower: -PI.next_up(), upper: PI.next_up() }
        }
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        outward(self.lower + other.lower, self.upper + other.upper, 1)
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        outward(self.lower - other.upper, self.upper - other.lower, 1)
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self { lower: -self.upper, upper: -self.lower }
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self == Self::ZERO || other == Self::ZERO {
            return Self::ZERO;
        }
        let (a, b, c, d) = (self.lower, self.upper, other.lower, other.upper);
        hull([a * c, a * d, b * c, b * d])
    }
}

/// A function of one argument in doubles.
fn rounded(function: Unary, x: f64) -> f64 {
    match function {
        Unary::Sqrt => x.sqrt(),
        Unary::Sin => x.sin(),
        Unary::Cos => x.cos(),
        Unary::Exp => x.exp(),
        Unary::Ln => x.ln(),
        Unary::Asin => x.asin(),
        Unary::Acos => x.acos(),
        Unary::Atan => x.atan(),
    }
}

/// From the least to the greatest of four products. An infinite end times zero is zero there.
fn hull(corners: [f64; 4]) -> Interval {
    let (mut lower, mut upper) = (f64::INFINITY, f64::NEG_INFINITY);
    for corner in corners {
        let value = if corner.is_nan() { 0.0 } else { corner };
        lower = lower.min(value);
        upper = upper.max(value);
    }
    outward(lower, upper, 1)
}

/// Both ends moved outward by a number of units in the last place.
fn outward(lower: f64, upper: f64, units: u8) -> Interval {
    if lower.is_nan() || upper.is_nan() {
        return Interval::ENTIRE;
    }
    let (mut lower, mut upper) = (lower, upper);
    for _ in 0..units {
        lower = lower.next_down();
        upper = upper.next_up();
    }
    Interval { lower, upper }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::pseudo_random;

    /// Uniform in −1 to 1.
    fn uniform(key: &[u64]) -> f64 {
        #[allow(clippy::cast_precision_loss)]
        let fraction = pseudo_random(key).value() as f64 / (1_u64 << 61) as f64;
        2.0 * fraction - 1.0
    }

    #[test]
    fn enclosures_hold_every_value_of_the_function() {
        let functions = [
            Unary::Sin,
            Unary::Cos,
            Unary::Exp,
            Unary::Atan,
            Unary::Sqrt,
            Unary::Ln,
            Unary::Asin,
            Unary::Acos,
        ];
        for seed in 0..2000 {
            let (a, b) = (8.0 * uniform(&[seed, 0]), 2.0 * uniform(&[seed, 1]));
            let x = Interval::new(a, a + b);
            let t = 0.5 * (1.0 + uniform(&[seed, 2]));
            let inside = (x.lower + t * x.width()).clamp(x.lower, x.upper);
            for function in functions {
                let (image, value) = (x.apply(function), rounded(function, inside));
                assert!(
                    image == Interval::ENTIRE || (image.lower <= value && value <= image.upper),
                    "{function:?} of {x:?} at {inside}: {value} outside {image:?}"
                );
            }
            let y = Interval::new(uniform(&[seed, 3]), 4.0 * uniform(&[seed, 4]));
            let product = x * y;
            let corner = x.upper * y.lower;
            assert!(product.lower < corner && corner < product.upper);
            let angle = x.atan2(y);
            let sample = inside.atan2(y.middle());
            assert!(angle.lower <= sample && sample <= angle.upper);
        }
    }

    #[test]
    fn quotients_by_intervals_with_zero_are_undecided() {
        let numerator = Interval::point(1.0);
        assert_eq!(numerator.quotient(Interval::new(-1.0, 1.0)), Interval::ENTIRE);
        assert!(numerator.quotient(Interval::new(0.5, 1.0)).upper < 2.001);
    }
}
