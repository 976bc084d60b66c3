//! Scalars of the emitted code.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use num_traits::{One, Zero};

/// A scalar that emitted code can compute with: f64, f32, dual numbers, lanes of several samples.
/// No ordering: emitted code is branch-free.
///
/// f32 and f64 call the `libm` crate on every target, so that host and microcontroller agree to the
/// last bit. Sine and cosine of f32 are computed here, in single precision alone.
pub trait Real:
    Copy
    + PartialEq
    + Debug
    + 'static
    + Zero
    + One
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// The nearest value to a double.
    fn from_f64(value: f64) -> Self;
    /// Sine and cosine, radians.
    fn sin_cos(self) -> (Self, Self);
    /// Square root.
    fn sqrt(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Arc sine.
    fn asin(self) -> Self;
    /// Arc cosine.
    fn acos(self) -> Self;
    /// Arc tangent.
    fn atan(self) -> Self;
    /// Angle of the point (x, self) = (x, y).
    fn atan2(self, x: Self) -> Self;
}

/// A scalar with an order, for planners and controllers.
pub trait Ordered: Real + PartialOrd {
    /// As a double.
    fn to_f64(self) -> f64;
    /// In single precision.
    fn to_f32(self) -> f32 {
        self.to_f64() as f32
    }
    /// From single precision.
    fn from_f32(value: f32) -> Self {
        Self::from_f64(f64::from(value))
    }
    /// From an integer: correctly rounded up to 2³¹, within one unit in the last place beyond.
    fn from_i64(value: i64) -> Self {
        Self::from_f64(value as f64)
    }
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool {
        self.to_f64().is_finite()
    }
    /// Magnitude; NaN stays NaN.
    fn abs(self) -> Self {
        if self < Self::zero() { -self } else { self }
    }
    /// Distance from one to the next larger value: the unit that tolerances are counted in.
    fn epsilon() -> Self {
        let half = Self::from_f64(0.5);
        let mut epsilon = Self::one();
        while Self::one() + epsilon * half > Self::one() {
            epsilon *= half;
        }
        epsilon
    }
}

/// By instructions for 32 bits: those for 64 are missing where only singles have hardware.
#[inline]
fn single(value: i64) -> f32 {
    let low = value as i32;
    let high = ((value >> 32) as i32).saturating_add(i32::from(low < 0));
    high as f32 * 4_294_967_296.0 + low as f32
}

#[inline]
const fn double(value: i64) -> f64 {
    value as f64
}

macro_rules! float {
    ($t:ty, $from_i64:ident, $sincos:path, $sqrt:ident, $exp:ident, $ln:ident, $asin:ident, $acos:ident, $atan:ident, $atan2:ident) => {
        impl Real for $t {
            #[inline]
            #[allow(clippy::cast_possible_truncation)]
            fn from_f64(value: f64) -> Self {
                value as $t
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                $sincos(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                libm::$sqrt(self)
            }
            #[inline]
            fn exp(self) -> Self {
                libm::$exp(self)
            }
            #[inline]
            fn ln(self) -> Self {
                libm::$ln(self)
            }
            #[inline]
            fn asin(self) -> Self {
                libm::$asin(self)
            }
            #[inline]
            fn acos(self) -> Self {
                libm::$acos(self)
            }
            #[inline]
            fn atan(self) -> Self {
                libm::$atan(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                libm::$atan2(self, x)
            }
        }
        impl Ordered for $t {
            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn to_f32(self) -> f32 {
                self as f32
            }
            #[inline]
            fn from_f32(value: f32) -> Self {
                Self::from(value)
            }
            #[inline]
            fn from_i64(value: i64) -> Self {
                $from_i64(value)
            }
            #[inline]
            fn is_finite(self) -> bool {
                <$t>::is_finite(self)
            }
            #[inline]
            fn epsilon() -> Self {
                <$t>::EPSILON
            }
        }
    };
}

float!(f64, double, libm::sincos, sqrt, exp, log, asin, acos, atan, atan2);
float!(f32, single, crate::sine::sin_cos, sqrtf, expf, logf, asinf, acosf, atanf, atan2f);

#[cfg(test)]
mod tests {
    use super::{Ordered, single};

    #[test]
    fn integers_in_single_precision_are_within_a_unit_in_the_last_place() {
        for value in [0, 1, -1, 16_777_217, -16_777_219, i32::MAX.into(), i32::MIN.into()] {
            assert_eq!(single(value).to_bits(), (value as f32).to_bits(), "{value}");
        }
        for shift in 31..63 {
            for offset in [-12_345_678_901_i64, -1, 0, 1, 987_654_321] {
                let value = (1_i64 << shift) + offset;
                for value in [value, -value] {
                    let error = f64::from(f32::from_i64(value)) - value as f64;
                    assert!(
                        error.abs() <= (value as f64).abs() * f64::from(f32::EPSILON),
                        "{value}"
                    );
                }
            }
        }
        assert!(single(i64::MAX) > 9.2e18 && single(i64::MIN) < -9.2e18);
    }
}
