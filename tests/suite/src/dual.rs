//! Dual numbers: a value with its derivative in one direction, exact to the last bit or two.

use num_traits::{One, Zero};
use shapebot_dynamics::nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Ordered, Real};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

thread_local! {
    /// Numbers that the next conversions are to meet, and what they become instead.
    static REPLACEMENTS: RefCell<VecDeque<(f64, f64)>> = const { RefCell::new(VecDeque::new()) };
}

/// A value and its slope in one direction; ordered by value.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// Its derivative.
    pub slope: f64,
}

impl Dual {
    /// A value that does not move.
    #[must_use]
    pub const fn constant(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }

    /// f(x) with f′(x) = `derivative`.
    fn chain(self, value: f64, derivative: f64) -> Self {
        Self { value, slope: self.slope * derivative }
    }
}

/// Builds something whose first conversions from doubles are the numbers on the left, and gives it those
/// on the right: sets the parameters of generated code one by one without knowing the fields' names.
///
/// # Panics
///
/// If other numbers are converted, or fewer.
pub fn with_replaced<R>(numbers: &[(f64, f64)], build: impl FnOnce() -> R) -> R {
    REPLACEMENTS.with_borrow_mut(|queue| *queue = numbers.iter().copied().collect());
    let built = build();
    let left = REPLACEMENTS.with_borrow_mut(std::mem::take);
    assert!(left.is_empty(), "{} numbers were not asked for", left.len());
    built
}

/// A vector that stands still.
#[must_use]
pub fn at_rest<const N: usize>(x: &SVector<f64, N>) -> SVector<Dual, N> {
    x.map(Dual::constant)
}

/// A vector that moves with a velocity.
#[must_use]
pub fn moving<const N: usize>(x: &SVector<f64, N>, velocity: &SVector<f64, N>) -> SVector<Dual, N> {
    x.zip_map(velocity, |value, slope| Dual { value, slope })
}

/// A vector whose entry `k` moves with unit speed.
#[must_use]
pub fn along<const N: usize>(x: &SVector<f64, N>, k: usize) -> SVector<Dual, N> {
    moving(x, &SVector::from_fn(|i, _| f64::from(u8::from(i == k))))
}

/// The slopes of all entries.
#[must_use]
pub fn slopes<const R: usize, const C: usize>(matrix: &SMatrix<Dual, R, C>) -> SMatrix<f64, R, C> {
    matrix.map(|entry| entry.slope)
}

/// The Jacobian of a vector function: column k is the slope with argument entry k moving.
pub fn jacobian<const M: usize, const N: usize>(
    x: &SVector<f64, N>,
    mut function: impl FnMut(&SVector<Dual, N>) -> SVector<Dual, M>,
) -> SMatrix<f64, M, N> {
    let mut out = SMatrix::<f64, M, N>::zeros();
    for k in 0..N {
        out.set_column(k, &slopes(&function(&along(x, k))));
    }
    out
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            slope: self.slope * other.value + self.value * other.slope,
        }
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

macro_rules! assign {
    ($($trait:ident $method:ident $op:tt),*) => {$(
        impl $trait for Dual {
            fn $method(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    )*};
}
assign!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /);

impl Zero for Dual {
    fn zero() -> Self {
        Self::constant(0.0)
    }
    fn is_zero(&self) -> bool {
        *self == Self::zero()
    }
}

impl One for Dual {
    fn one() -> Self {
        Self::constant(1.0)
    }
}

impl Real for Dual {
    fn from_f64(value: f64) -> Self {
        let Some((expected, replacement)) = REPLACEMENTS.with_borrow_mut(VecDeque::pop_front)
        else {
            return Self::constant(value);
        };
        assert_eq!(value.to_bits(), expected.to_bits(), "{value} is converted, not {expected}");
        Self::constant(replacement)
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = Real::sin_cos(self.value);
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    fn sqrt(self) -> Self {
        let root = Real::sqrt(self.value);
        self.chain(root, 0.5 / root)
    }
    fn exp(self) -> Self {
        let value = Real::exp(self.value);
        self.chain(value, value)
    }
    fn ln(self) -> Self {
        self.chain(Real::ln(self.value), 1.0 / self.value)
    }
    fn asin(self) -> Self {
        let cos = Real::sqrt(1.0 - self.value * self.value);
        self.chain(Real::asin(self.value), 1.0 / cos)
    }
    fn acos(self) -> Self {
        let sin = Real::sqrt(1.0 - self.value * self.value);
        self.chain(Real::acos(self.value), -1.0 / sin)
    }
    fn atan(self) -> Self {
        self.chain(Real::atan(self.value), 1.0 / (1.0 + self.value * self.value))
    }
    fn atan2(self, x: Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        Self {
            value: Real::atan2(self.value, x.value),
            slope: (self.slope * x.value - self.value * x.slope) / square,
        }
    }
}

impl Ordered for Dual {
    fn to_f64(self) -> f64 {
        self.value
    }
    fn epsilon() -> Self {
        Self::constant(f64::EPSILON)
    }
}

#[cfg(test)]
mod tests {
    use super::{Dual, jacobian, with_replaced};
    use shapebot_dynamics::Real;
    use shapebot_dynamics::nalgebra::{Vector1, Vector2};

    /// Central differences of a function of one dual number.
    fn difference(function: fn(Dual) -> Dual, x: f64) -> f64 {
        let h = 1e-6;
        (function(Dual::constant(x + h)).value - function(Dual::constant(x - h)).value) / (2.0 * h)
    }

    #[test]
    fn slopes_are_those_of_central_differences() {
        let one = Dual::constant(1.0);
        let functions: [fn(Dual) -> Dual; 11] = [
            |x| Real::sin_cos(x).0,
            |x| Real::sin_cos(x).1,
            Real::sqrt,
            Real::exp,
            Real::ln,
            Real::asin,
            Real::acos,
            Real::atan,
            |x| Real::atan2(x, Dual::constant(0.7)),
            |x| Real::atan2(Dual::constant(0.7), x),
            |x| x * x / (x + Dual::constant(1.0)) - x,
        ];
        assert_eq!(one * one, one);
        for (index, function) in functions.into_iter().enumerate() {
            let slope = function(Dual { value: 0.37, slope: 1.0 });
            let expected = difference(function, 0.37);
            assert!((slope.slope - expected).abs() < 1e-8, "function {index}");
        }
    }

    #[test]
    fn columns_of_a_jacobian_belong_to_arguments() {
        let x = Vector2::new(3.0, 5.0);
        let found = jacobian(&x, |v| Vector1::new(v[0] * v[0] + v[0] * v[1]));
        assert_eq!((found[0], found[1]), (11.0, 3.0));
    }

    #[test]
    fn numbers_are_replaced_in_their_order_once() {
        let pair = || [Dual::from_f64(1.0), Dual::from_f64(2.0)];
        assert_eq!(with_replaced(&[(1.0, 5.0)], pair), [5.0, 2.0].map(Dual::constant));
        assert_eq!(pair(), [1.0, 2.0].map(Dual::constant));
    }
}
