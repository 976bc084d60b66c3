//! Arithmetic modulo the Mersenne prime p = 2⁶¹ − 1.
//!
//! An expression's residue at random points stands for the expression itself (Schwartz–Zippel): two
//! expressions of degree d that differ agree at a random point with probability at most d/p.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};

/// The modulus 2⁶¹ − 1.
pub const MODULUS: u64 = (1 << 61) - 1;

/// An element of the field of integers modulo [`MODULUS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Residue(u64);

impl Residue {
    /// Zero.
    pub const ZERO: Self = Self(0);
    /// One.
    pub const ONE: Self = Self(1);

    /// Any 64-bit pattern, reduced.
    #[must_use]
    pub const fn new(value: u64) -> Self {
        Self(value % MODULUS)
    }

    /// The canonical representative.
    #[must_use]
    pub const fn value(self) -> u64 {
        self.0
    }

    /// Sum.
    #[must_use]
    pub const fn add(self, other: Self) -> Self {
        let sum = self.0 + other.0;
        Self(if sum >= MODULUS { sum - MODULUS } else { sum })
    }

    /// Negative.
    #[must_use]
    pub const fn neg(self) -> Self {
        Self(if self.0 == 0 { 0 } else { MODULUS - self.0 })
    }

    /// Difference.
    #[must_use]
    pub const fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }

    /// Product.
    #[must_use]
    #[allow(clippy::cast_possible_truncation)]
    pub const fn mul(self, other: Self) -> Self {
        let wide = self.0 as u128 * other.0 as u128;
        let folded = (wide & MODULUS as u128) as u64 + (wide >> 61) as u64;
        Self(if folded >= MODULUS { folded - MODULUS } else { folded })
    }

    /// Power with a non-negative exponent.
    #[must_use]
    pub fn pow(self, mut exponent: u64) -> Self {
        let (mut base, mut result) = (self, Self::ONE);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = result.mul(base);
            }
            base = base.mul(base);
            exponent >>= 1;
        }
        result
    }

    /// Multiplicative inverse; `None` for zero.
    #[must_use]
    pub fn inverse(self) -> Option<Self> {
        (self.0 != 0).then(|| self.pow(MODULUS - 2))
    }

    /// The square root that is itself a square, for a square. Since p ≡ 3 (mod 4) exactly one of ±r
    /// is a square, which makes √a·√b = √(ab) hold, as for positive reals.
    #[must_use]
    pub fn sqrt(self) -> Option<Self> {
        let root = self.pow(u64::midpoint(MODULUS, 1) / 2);
        (root.mul(root) == self).then_some(root)
    }

    /// Residue of a rational; `None` when p divides the denominator.
    #[must_use]
    pub fn from_rational(value: &BigRational) -> Option<Self> {
        let numerator = Self::from_integer(value.numer());
        let denominator = Self::from_integer(value.denom());
        Some(numerator.mul(denominator.inverse()?))
    }

    fn from_integer(value: &BigInt) -> Self {
        let magnitude = (value.abs() % BigInt::from(MODULUS)).to_u64().unwrap_or(0);
        if value.is_negative() { Self(magnitude).neg() } else { Self(magnitude) }
    }

    /// The fraction n/d with |n|, d below 2¹⁵ that has this residue, if there is one. One residue in
    /// 2³⁰ is such a fraction by chance, so that a large number is not taken for a small one.
    #[must_use]
    pub fn small_fraction(self) -> Option<(i64, i64)> {
        const BOUND: i128 = 1 << 15;
        let (mut r0, mut r1) = (i128::from(MODULUS), i128::from(self.0));
        let (mut t0, mut t1) = (0_i128, 1_i128);
        while r1 >= BOUND {
            let quotient = r0 / r1;
            (r0, r1) = (r1, r0 - quotient * r1);
            (t0, t1) = (t1, t0 - quotient * t1);
        }
        if t1 == 0 || t1.abs() >= BOUND {
            return None;
        }
        let sign = t1.signum();
        Some((i64::try_from(r1 * sign).ok()?, i64::try_from(t1 * sign).ok()?))
    }
}

/// A point of the unit circle over the field: (cos, sin) with cos² + sin² = 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitPoint {
    /// Cosine.
    pub cos: Residue,
    /// Sine.
    pub sin: Residue,
}

impl UnitPoint {
    /// Angle zero.
    pub const IDENTITY: Self = Self { cos: Residue::ONE, sin: Residue::ZERO };
    /// A quarter turn.
    pub const QUARTER: Self = Self { cos: Residue::ZERO, sin: Residue::ONE };

    /// The point with half-angle tangent `t`. −1 is no square modulo p, so 1 + t² never vanishes.
    #[must_use]
    pub fn from_half_tangent(t: Residue) -> Self {
        let square = t.mul(t);
        let scale = Residue::ONE.add(square).inverse().unwrap_or(Residue::ONE);
        Self { cos: Residue::ONE.sub(square).mul(scale), sin: t.add(t).mul(scale) }
    }

    /// Sum of the angles.
    #[must_use]
    pub fn compose(self, other: Self) -> Self {
        Self {
            cos: self.cos.mul(other.cos).sub(self.sin.mul(other.sin)),
            sin: self.sin.mul(other.cos).add(self.cos.mul(other.sin)),
        }
    }

    /// Integer multiple of the angle.
    #[must_use]
    pub fn multiple(self, count: i64) -> Self {
        let mut base = if count < 0 { Self { cos: self.cos, sin: self.sin.neg() } } else { self };
        let (mut left, mut result) = (count.unsigned_abs(), Self::IDENTITY);
        while left > 0 {
            if left & 1 == 1 {
                result = result.compose(base);
            }
            base = base.compose(base);
            left >>= 1;
        }
        result
    }
}

/// A fixed pseudo-random function (splitmix64 over its inputs): the same point in every run.
#[must_use]
pub fn pseudo_random(inputs: &[u64]) -> Residue {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    for &input in inputs {
        state = mix(state ^ input).wrapping_add(0x9e37_79b9_7f4a_7c15);
    }
    Residue::new(mix(state))
}

const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_undoes_multiplication() {
        for seed in 1..50 {
            let x = pseudo_random(&[seed]);
            assert_eq!(x.mul(x.inverse().unwrap()), Residue::ONE);
        }
    }

    #[test]
    fn half_of_all_elements_have_square_roots_and_roots_multiply() {
        let squares: Vec<_> =
            (0..200).map(|i| pseudo_random(&[i])).filter(|x| x.sqrt().is_some()).collect();
        assert!((70..130).contains(&squares.len()));
        for pair in squares.windows(2) {
            let product = pair[0].mul(pair[1]);
            assert_eq!(product.sqrt(), Some(pair[0].sqrt().unwrap().mul(pair[1].sqrt().unwrap())));
        }
    }

    #[test]
    fn unit_points_obey_the_addition_theorem() {
        let p = UnitPoint::from_half_tangent(pseudo_random(&[7]));
        assert_eq!(p.cos.mul(p.cos).add(p.sin.mul(p.sin)), Residue::ONE);
        assert_eq!(p.multiple(3), p.compose(p).compose(p));
        assert_eq!(p.multiple(-2).compose(p.multiple(2)), UnitPoint::IDENTITY);
    }

    #[test]
    fn small_fractions_are_recovered() {
        for (n, d) in [(1_i64, 2_i64), (-3, 7), (0, 1), (1058, 10_000)] {
            let value = BigRational::new(n.into(), d.into());
            let (rn, rd) = Residue::from_rational(&value).unwrap().small_fraction().unwrap();
            assert_eq!(BigRational::new(rn.into(), rd.into()), value);
        }
    }
}
