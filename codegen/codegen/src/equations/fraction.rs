//! Quotients of polynomials in lowest terms, and small systems of equations between them.

use super::polynomial::{Polynomial, Ring, TooLarge};
use num_traits::Signed;

/// A rational function. The denominator has coprime integer coefficients with a positive leading one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fraction {
    pub(super) numerator: Polynomial,
    pub(super) denominator: Polynomial,
}

impl Fraction {
    pub(super) fn of(ring: &Ring, numerator: Polynomial) -> Self {
        Self { numerator, denominator: ring.one() }
    }

    pub(super) fn is_zero(&self) -> bool {
        self.numerator.is_zero()
    }

    /// Number of terms above and below the line.
    pub(super) fn size(&self) -> usize {
        self.numerator.terms.len() + self.denominator.terms.len()
    }

    /// Lowest terms.
    pub(super) fn new(ring: &Ring, numerator: &Polynomial, denominator: &Polynomial) -> Self {
        let divisor = ring.gcd(numerator, denominator);
        let (top, bottom) = match (numerator.divided_by(&divisor), denominator.divided_by(&divisor))
        {
            (Some(top), Some(bottom)) => (top, bottom),
            _ => (numerator.clone(), denominator.clone()),
        };
        let mut content = bottom.content();
        if bottom.terms.values().next_back().is_some_and(Signed::is_negative) {
            content = -content;
        }
        let scale = content.recip();
        Self { numerator: top.scaled(&scale), denominator: bottom.scaled(&scale) }
    }

    pub(super) fn neg(&self) -> Self {
        Self { numerator: self.numerator.neg(), denominator: self.denominator.clone() }
    }

    pub(super) fn add(&self, ring: &Ring, other: &Self) -> Result<Self, TooLarge> {
        if self.denominator == other.denominator {
            let sum = self.numerator.add(&other.numerator);
            if self.denominator == ring.one() {
                return Ok(Self::of(ring, sum));
            }
            return Ok(Self::new(ring, &sum, &self.denominator));
        }
        let common = ring.gcd(&self.denominator, &other.denominator);
        let own = self.denominator.divided_by(&common).unwrap_or_else(|| self.denominator.clone());
        let theirs =
            other.denominator.divided_by(&common).unwrap_or_else(|| other.denominator.clone());
        let left = ring.mul(&self.numerator, &theirs)?;
        let right = ring.mul(&other.numerator, &own)?;
        let bottom = ring.mul(&self.denominator, &theirs)?;
        Ok(Self::new(ring, &left.add(&right), &bottom))
    }

    pub(super) fn mul(&self, ring: &Ring, other: &Self) -> Result<Self, TooLarge> {
        let one = ring.one();
        let top = ring.mul(&self.numerator, &other.numerator)?;
        if self.denominator == one && other.denominator == one {
            return Ok(Self::of(ring, top));
        }
        let bottom = ring.mul(&self.denominator, &other.denominator)?;
        Ok(Self::new(ring, &top, &bottom))
    }

    pub(super) fn div(&self, ring: &Ring, other: &Self) -> Result<Self, TooLarge> {
        if other.is_zero() {
            return Err(TooLarge);
        }
        let inverse = Self::new(ring, &other.denominator, &other.numerator);
        self.mul(ring, &inverse)
    }
}

/// A⁻¹ B by elimination; the emptiest row gives the pivot of a column.
pub(super) fn solve(
    ring: &Ring,
    mut a: Vec<Vec<Fraction>>,
    mut b: Vec<Vec<Fraction>>,
) -> Result<Vec<Vec<Fraction>>, TooLarge> {
    let n = a.len();
    for k in 0..n {
        let pivot = (k..n)
            .filter(|&i| !a[i][k].is_zero())
            .min_by_key(|&i| (a[i].iter().filter(|e| !e.is_zero()).count(), a[i][k].size(), i))
            .ok_or(TooLarge)?;
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in 0..n {
            if i == k || a[i][k].is_zero() {
                continue;
            }
            let factor = a[i][k].div(ring, &a[k][k])?.neg();
            for j in k..n {
                a[i][j] = a[i][j].add(ring, &factor.mul(ring, &a[k][j])?)?;
            }
            for j in 0..b[i].len() {
                b[i][j] = b[i][j].add(ring, &factor.mul(ring, &b[k][j])?)?;
            }
        }
    }
    for k in 0..n {
        for entry in &mut b[k] {
            *entry = entry.div(ring, &a[k][k])?;
        }
    }
    Ok(b)
}

/// One factor times a matrix without denominators: the factor is positive where that can be said of its
/// leading coefficients.
pub(super) fn common_factor(
    ring: &Ring,
    matrix: &[Vec<Fraction>],
) -> Result<(Fraction, Vec<Vec<Polynomial>>), TooLarge> {
    let mut bottom = ring.one();
    for entry in matrix.iter().flatten() {
        let common = ring.gcd(&bottom, &entry.denominator);
        let rest = entry.denominator.divided_by(&common).ok_or(TooLarge)?;
        bottom = ring.mul(&bottom, &rest)?;
    }
    let mut tops = Vec::new();
    for row in matrix {
        let mut top = Vec::new();
        for entry in row {
            let missing = bottom.divided_by(&entry.denominator).ok_or(TooLarge)?;
            top.push(ring.mul(&entry.numerator, &missing)?);
        }
        tops.push(top);
    }
    let mut factor = Polynomial::default();
    let mut content = Polynomial::default();
    for top in tops.iter().flatten().filter(|top| !top.is_zero()) {
        factor = ring.gcd(&factor, top);
        // Contents of all entries together: those of a polynomial that has them as coefficients.
        let mut key = vec![0; ring.len()];
        #[allow(clippy::cast_possible_truncation)]
        key.push(content.terms.len() as u8);
        content.terms.insert(key, top.content());
    }
    if factor.is_zero() {
        return Ok((Fraction::of(ring, ring.one()), tops));
    }
    let factor = factor.scaled(&content.content());
    let mut rest = Vec::new();
    for row in &tops {
        let divided: Option<Vec<Polynomial>> =
            row.iter().map(|top| top.divided_by(&factor)).collect();
        rest.push(divided.ok_or(TooLarge)?);
    }
    Ok((Fraction::new(ring, &factor, &bottom), rest))
}
