//! Dual numbers: a value and its derivative in one direction.

use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use num_traits::{One, Zero};
use shapebot_dynamics::Real;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T> {
    pub value: T,
    pub slope: T,
}

impl<T: Real> Dual<T> {
    pub fn constant(value: T) -> Self {
        Self { value, slope: T::zero() }
    }

    /// f(x) with f′(x) = `derivative`.
    fn chain(self, value: T, derivative: T) -> Self {
        Self { value, slope: self.slope * derivative }
    }
}

impl<T: Real> Add for Dual<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl<T: Real> Sub for Dual<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl<T: Real> Mul for Dual<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let slope = self.slope * other.value + self.value * other.slope;
        Self { value: self.value * other.value, slope }
    }
}

impl<T: Real> Div for Dual<T> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

impl<T: Real> Neg for Dual<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

macro_rules! assign {
    ($($trait:ident $method:ident $op:tt),*) => {$(
        impl<T: Real> $trait for Dual<T> {
            fn $method(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    )*};
}
assign!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /);

impl<T: Real> Zero for Dual<T> {
    fn zero() -> Self {
        Self::constant(T::zero())
    }
    fn is_zero(&self) -> bool {
        *self == Self::zero()
    }
}

impl<T: Real> One for Dual<T> {
    fn one() -> Self {
        Self::constant(T::one())
    }
}

impl<T: Real> Real for Dual<T> {
    fn from_f64(value: f64) -> Self {
        Self::constant(T::from_f64(value))
    }
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.value.sin_cos();
        (self.chain(s, c), self.chain(c, -s))
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, T::one() / (root + root))
    }
    fn exp(self) -> Self {
        self.chain(self.value.exp(), self.value.exp())
    }
    fn ln(self) -> Self {
        self.chain(self.value.ln(), T::one() / self.value)
    }
    fn asin(self) -> Self {
        let x = self.value;
        self.chain(x.asin(), T::one() / (T::one() - x * x).sqrt())
    }
    fn acos(self) -> Self {
        let x = self.value;
        self.chain(x.acos(), -T::one() / (T::one() - x * x).sqrt())
    }
    fn atan(self) -> Self {
        let x = self.value;
        self.chain(x.atan(), T::one() / (T::one() + x * x))
    }
    fn atan2(self, x: Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        let slope = (self.slope * x.value - self.value * x.slope) / square;
        Self { value: self.value.atan2(x.value), slope }
    }
}
