//! Multivariate polynomials over the rationals, in atoms: parameters, coordinates, rates, and the sine
//! and cosine of each angle, with sin² = 1 − cos².

use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use std::cell::Cell;
use std::collections::BTreeMap;

/// Exponents of all atoms. The order is lexicographic: the first atom weighs most.
pub(super) type Monomial = Vec<u8>;

/// Terms by monomial; no coefficient is zero.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Polynomial {
    pub(super) terms: BTreeMap<Monomial, BigRational>,
}

/// The atoms: for each whether it is a sine, and of which cosine it is the partner.
#[derive(Clone, Debug, Default)]
pub(super) struct Ring {
    pub(super) cosine_of: Vec<Option<usize>>,
    /// Products of terms so far: large models run out of [`WORK`] before they run out of time.
    work: Cell<usize>,
}

/// More terms than this are not worked with.
pub(super) const LARGEST: usize = 120;
/// Products of terms in all.
const WORK: usize = 200_000;
/// Greatest common divisors are sought only between polynomials of at most this many terms.
const DIVISOR_TERMS: usize = 40;
/// The largest exponent.
const HIGHEST: u8 = 60;

/// A polynomial grew beyond [`LARGEST`], or all of them together beyond [`WORK`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TooLarge;

impl Ring {
    /// In which some atoms are sines, with their cosines.
    pub(super) fn new(cosine_of: Vec<Option<usize>>) -> Self {
        Self { cosine_of, work: Cell::new(0) }
    }

    /// Number of atoms.
    pub(super) fn len(&self) -> usize {
        self.cosine_of.len()
    }

    pub(super) fn constant(&self, value: BigRational) -> Polynomial {
        let mut terms = BTreeMap::new();
        if !value.is_zero() {
            terms.insert(vec![0; self.len()], value);
        }
        Polynomial { terms }
    }

    pub(super) fn one(&self) -> Polynomial {
        self.constant(BigRational::one())
    }

    pub(super) fn atom(&self, i: usize) -> Polynomial {
        let mut monomial = vec![0; self.len()];
        monomial[i] = 1;
        Polynomial { terms: BTreeMap::from([(monomial, BigRational::one())]) }
    }

    /// Product, with squares of sines replaced.
    pub(super) fn mul(&self, a: &Polynomial, b: &Polynomial) -> Result<Polynomial, TooLarge> {
        let products = a.terms.len() * b.terms.len();
        self.work.set(self.work.get() + products);
        if products > 4 * LARGEST || self.work.get() > WORK {
            return Err(TooLarge);
        }
        let mut out = Polynomial::default();
        for (ma, ca) in &a.terms {
            for (mb, cb) in &b.terms {
                let monomial: Monomial = ma.iter().zip(mb).map(|(x, y)| x + y).collect();
                if monomial.iter().any(|&e| e > HIGHEST) {
                    return Err(TooLarge);
                }
                self.insert_reduced(&mut out, monomial, ca * cb);
            }
        }
        if out.terms.len() > LARGEST { Err(TooLarge) } else { Ok(out) }
    }

    fn insert_reduced(&self, out: &mut Polynomial, monomial: Monomial, coefficient: BigRational) {
        let square = (0..self.len()).find(|&i| monomial[i] >= 2 && self.cosine_of[i].is_some());
        let Some((sine, cosine)) = square.and_then(|i| Some((i, self.cosine_of[i]?))) else {
            out.insert(monomial, coefficient);
            return;
        };
        let mut without = monomial;
        without[sine] -= 2;
        let mut with = without.clone();
        with[cosine] += 2;
        self.insert_reduced(out, without, coefficient.clone());
        self.insert_reduced(out, with, -coefficient);
    }

    /// The greatest common divisor, up to a rational factor; one where it would be dear to find.
    pub(super) fn gcd(&self, a: &Polynomial, b: &Polynomial) -> Polynomial {
        if a.is_zero() || b.is_zero() {
            return if a.is_zero() { b.primitive() } else { a.primitive() };
        }
        let common: Monomial =
            a.common_monomial().iter().zip(b.common_monomial()).map(|(&x, y)| x.min(y)).collect();
        let (a, b) = (a.without(&a.common_monomial()), b.without(&b.common_monomial()));
        let core = if a.terms.len() > DIVISOR_TERMS || b.terms.len() > DIVISOR_TERMS {
            self.one()
        } else if a.divided_by(&b).is_some() {
            b
        } else if b.divided_by(&a).is_some() {
            a
        } else {
            self.euclid(&a.primitive(), &b.primitive())
        };
        core.times_monomial(&common, &BigRational::one()).primitive()
    }

    /// Primitive remainder sequence in the first atom that occurs, coefficients by recursion.
    fn euclid(&self, a: &Polynomial, b: &Polynomial) -> Polynomial {
        let Some(v) = (0..self.len()).find(|&v| a.degree(v) > 0 || b.degree(v) > 0) else {
            return self.one();
        };
        if a.degree(v) == 0 || b.degree(v) == 0 {
            let (constant, other) = if a.degree(v) == 0 { (a, b) } else { (b, a) };
            return self.gcd(constant, &self.content(other, v));
        }
        let (ca, cb) = (self.content(a, v), self.content(b, v));
        let outer = self.gcd(&ca, &cb);
        let (Some(mut p), Some(mut q)) = (a.divided_by(&ca), b.divided_by(&cb)) else {
            return self.one();
        };
        if p.degree(v) < q.degree(v) {
            std::mem::swap(&mut p, &mut q);
        }
        let inner = loop {
            let Some(rest) = self.pseudo_remainder(&p, &q, v) else { break self.one() };
            if rest.is_zero() {
                break q;
            }
            if rest.degree(v) == 0 {
                break self.one();
            }
            let content = self.content(&rest, v);
            let Some(next) = rest.divided_by(&content) else { break self.one() };
            p = std::mem::replace(&mut q, next.primitive());
        };
        outer.plain_mul(&inner).primitive()
    }

    /// Common divisor of the coefficients as a polynomial in `v`.
    fn content(&self, p: &Polynomial, v: usize) -> Polynomial {
        p.coefficients(v).values().fold(Polynomial::default(), |sum, c| self.gcd(&sum, c))
    }

    fn pseudo_remainder(&self, p: &Polynomial, q: &Polynomial, v: usize) -> Option<Polynomial> {
        let lead = q.coefficients(v).pop_last()?.1;
        let mut rest = p.clone();
        while !rest.is_zero() && rest.degree(v) >= q.degree(v) {
            let shift = rest.degree(v) - q.degree(v);
            let top = rest.coefficients(v).pop_last()?.1;
            let mut power = vec![0; self.len()];
            power[v] = shift;
            let scaled = q.plain_mul(&top).times_monomial(&power, &BigRational::one());
            rest = lead.plain_mul(&rest).sub(&scaled);
            if rest.terms.len() > 4 * DIVISOR_TERMS {
                return None;
            }
        }
        Some(rest)
    }
}

impl Polynomial {
    pub(super) fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// The number, if it is one.
    pub(super) fn as_constant(&self) -> Option<BigRational> {
        match self.terms.iter().next() {
            None => Some(BigRational::zero()),
            Some((m, c)) if self.terms.len() == 1 && m.iter().all(|&e| e == 0) => Some(c.clone()),
            _ => None,
        }
    }

    fn insert(&mut self, monomial: Monomial, coefficient: BigRational) {
        if coefficient.is_zero() {
            return;
        }
        match self.terms.entry(monomial) {
            std::collections::btree_map::Entry::Vacant(place) => {
                place.insert(coefficient);
            }
            std::collections::btree_map::Entry::Occupied(mut place) => {
                *place.get_mut() += coefficient;
                if place.get().is_zero() {
                    place.remove();
                }
            }
        }
    }

    pub(super) fn add(&self, other: &Self) -> Self {
        let mut out = self.clone();
        for (m, c) in &other.terms {
            out.insert(m.clone(), c.clone());
        }
        out
    }

    pub(super) fn sub(&self, other: &Self) -> Self {
        self.add(&other.neg())
    }

    pub(super) fn neg(&self) -> Self {
        self.scaled(&-BigRational::one())
    }

    pub(super) fn scaled(&self, factor: &BigRational) -> Self {
        Self { terms: self.terms.iter().map(|(m, c)| (m.clone(), c * factor)).collect() }
    }

    /// Product in the free ring.
    fn plain_mul(&self, other: &Self) -> Self {
        let mut out = Self::default();
        for (m, c) in &self.terms {
            out = out.add(&other.times_monomial(m, c));
        }
        out
    }

    pub(super) fn times_monomial(&self, monomial: &[u8], factor: &BigRational) -> Self {
        let times = |m: &Monomial| m.iter().zip(monomial).map(|(x, y)| x + y).collect();
        Self { terms: self.terms.iter().map(|(m, c)| (times(m), c * factor)).collect() }
    }

    /// Highest power of an atom.
    pub(super) fn degree(&self, v: usize) -> u8 {
        self.terms.keys().map(|m| m[v]).max().unwrap_or(0)
    }

    fn coefficients(&self, v: usize) -> BTreeMap<u8, Self> {
        let mut out: BTreeMap<u8, Self> = BTreeMap::new();
        for (m, c) in &self.terms {
            let mut rest = m.clone();
            rest[v] = 0;
            out.entry(m[v]).or_default().terms.insert(rest, c.clone());
        }
        out
    }

    /// The monomial that divides all terms.
    pub(super) fn common_monomial(&self) -> Monomial {
        let mut keys = self.terms.keys();
        let first = keys.next().cloned().unwrap_or_default();
        keys.fold(first, |low, m| low.iter().zip(m).map(|(&x, &y)| x.min(y)).collect())
    }

    /// Divided by a monomial that divides all terms.
    pub(super) fn without(&self, monomial: &[u8]) -> Self {
        let less = |m: &Monomial| m.iter().zip(monomial).map(|(x, y)| x - y).collect();
        Self { terms: self.terms.iter().map(|(m, c)| (less(m), c.clone())).collect() }
    }

    /// Positive rational by which all coefficients become coprime integers.
    pub(super) fn content(&self) -> BigRational {
        let mut values = self.terms.values().map(Signed::abs);
        let Some(first) = values.next() else { return BigRational::one() };
        // With x/y = n/d in lowest terms the greatest common divisor of the rationals is x/n.
        values.fold(first, |g, c| {
            let ratio = &g / c;
            g / BigRational::from_integer(ratio.numer().clone())
        })
    }

    /// With coprime integer coefficients, the leading one positive.
    pub(super) fn primitive(&self) -> Self {
        let mut content = self.content();
        if self.terms.values().next_back().is_some_and(Signed::is_negative) {
            content = -content;
        }
        self.scaled(&content.recip())
    }

    /// The quotient, if the division comes out even in the free ring.
    pub(super) fn divided_by(&self, divisor: &Self) -> Option<Self> {
        let (lead, factor) = divisor.terms.last_key_value()?;
        let mut rest = self.clone();
        let mut quotient = Self::default();
        while let Some((m, c)) = rest.terms.last_key_value() {
            let step: Monomial =
                m.iter().zip(lead).map(|(x, y)| x.checked_sub(*y)).collect::<Option<_>>()?;
            let ratio = c / factor;
            rest = rest.sub(&divisor.times_monomial(&step, &ratio));
            quotient.insert(step, ratio);
            if quotient.terms.len() > LARGEST {
                return None;
            }
        }
        Some(quotient)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring() -> Ring {
        // x, y, sin, cos.
        Ring::new(vec![None, None, Some(3), None])
    }

    #[test]
    fn squares_of_sines_are_replaced() {
        let ring = ring();
        let (sine, cosine) = (ring.atom(2), ring.atom(3));
        let square = ring.mul(&sine, &sine).unwrap();
        let sum = square.add(&ring.mul(&cosine, &cosine).unwrap());
        assert_eq!(sum, ring.one());
    }

    #[test]
    fn common_factors_are_found() {
        let ring = ring();
        let (x, y) = (ring.atom(0), ring.atom(1));
        let (sum, difference) = (x.add(&y), x.sub(&y));
        let one = ring.one();
        let a = ring.mul(&sum, &ring.mul(&difference, &x.add(&one)).unwrap()).unwrap();
        let b = ring.mul(&sum, &y.add(&one)).unwrap();
        assert_eq!(ring.gcd(&a, &b), sum);
        assert_eq!(ring.gcd(&ring.mul(&sum, &sum).unwrap(), &a), sum);
        assert_eq!(a.divided_by(&sum).unwrap().terms.len(), 4);
    }
}
