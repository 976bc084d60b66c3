//! The smooth step: the polynomial that goes from 0 to 1 with the most derivatives zero at both ends.

use crate::Error;
use shapebot_dynamics::Ordered;

/// Largest m of a degree 2m + 1.
const MAX_HALF: usize = 8;

/// The polynomial s of odd degree n = 2m + 1 with s(0) = 0, s(1) = 1 and m derivatives zero at both
/// ends. The paper's "nonic" is degree 9; degree 9 is also the lowest whose fourth derivative, and
/// with it the shape acceleration, is zero at the ends.
///
/// No coefficient is rounded and no term cancels against another:
///
/// ```text
/// s(τ)  = τ^(m+1) Σ_k C(m+k, k) (1−τ)^k,   k = 0 … m
/// s′(τ) = n!/(m!)² (τ (1−τ))^m
/// ```
///
/// so the derivatives up to the m-th are exactly zero at both ends, and s is exactly 0 and 1 there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SmoothStep {
    half: usize,
    /// C(m+k, k).
    binomials: [u32; MAX_HALF + 1],
    /// n!/(m!)² = (2m+1) C(2m, m).
    slope: u32,
}

impl SmoothStep {
    /// Smallest degree: three zero derivatives.
    pub const MIN_DEGREE: usize = 7;
    /// Largest degree.
    pub const MAX_DEGREE: usize = 2 * MAX_HALF + 1;

    /// The smooth step of an odd degree from 7 to 17.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for any other degree.
    pub fn new(degree: usize) -> Result<Self, Error> {
        if degree.is_multiple_of(2) || !(Self::MIN_DEGREE..=Self::MAX_DEGREE).contains(&degree) {
            return Err(Error::Invalid {
                field: "degree",
                value: degree as f64,
                expected: "an odd number from 7 to 17",
            });
        }
        let half = degree / 2;
        let mut binomials = [0; MAX_HALF + 1];
        let (mut binomial, mut k) = (1_u32, 0_u32);
        for entry in binomials.iter_mut().take(half + 1) {
            *entry = binomial;
            k += 1;
            binomial = binomial * (half as u32 + k) / k;
        }
        let slope = degree as u32 * binomials[half];
        Ok(Self { half, binomials, slope })
    }

    /// Degree of the polynomial.
    pub const fn degree(&self) -> usize {
        2 * self.half + 1
    }

    /// s at τ, which is limited to 0 ≤ τ ≤ 1.
    pub fn value<T: Ordered>(&self, tau: T) -> T {
        let (zero, one) = (T::zero(), T::one());
        if tau <= zero {
            return zero;
        }
        if tau >= one {
            return one;
        }
        power(tau, self.half + 1) * self.sum(one - tau)
    }

    /// Σ_k C(m+k, k) restᵏ.
    fn sum<T: Ordered>(&self, rest: T) -> T {
        let binomials = self.binomials.iter().take(self.half + 1).rev();
        binomials.fold(T::zero(), |sum, &binomial| sum * rest + T::from_f64(f64::from(binomial)))
    }

    /// s and its first four derivatives at τ, which is limited to 0 ≤ τ ≤ 1.
    pub fn derivatives<T: Ordered>(&self, tau: T) -> [T; 5] {
        let (zero, one) = (T::zero(), T::one());
        let tau = if tau < zero {
            zero
        } else if tau > one {
            one
        } else {
            tau
        };
        let number = |n: usize| T::from_f64(n as f64);
        let m = self.half;

        let sum = self.sum(one - tau);
        // s′ = c u^m with u = τ(1−τ), u′ = 1 − 2τ, u″ = −2.
        let c = T::from_f64(f64::from(self.slope));
        let u = tau * (one - tau);
        let du = one - tau - tau;
        let u3 = power(u, m - 3);
        let (u2, u1) = (u3 * u, u3 * u * u);
        let (first, second, third) =
            (number(m), number(m * (m - 1)), number(m * (m - 1) * (m - 2)));
        [
            power(tau, m + 1) * sum,
            c * u1 * u,
            c * first * u1 * du,
            c * (second * u2 * du * du - number(2) * first * u1),
            c * (third * u3 * du * du * du - number(6) * second * u2 * du),
        ]
    }
}

fn power<T: Ordered>(base: T, exponent: usize) -> T {
    (0..exponent).fold(T::one(), |product, _| product * base)
}
