//! Power products of at most 64 variables with exponents of at most 7.

/// Exponents, four bits each, of which the highest tells an overflow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Monomial([u64; 4]);

const PER_WORD: usize = 16;
const OVERFLOW: u64 = 0x8888_8888_8888_8888;

impl Monomial {
    /// Number of variables there can be.
    pub(crate) const VARIABLES: usize = 4 * PER_WORD;

    /// The empty product.
    pub(crate) const ONE: Self = Self([0; 4]);

    /// One variable.
    pub(crate) fn variable(index: usize) -> Self {
        Self::ONE.with_exponent(index, 1)
    }

    /// Exponent of a variable.
    pub(crate) fn exponent(self, index: usize) -> u64 {
        self.0[index / PER_WORD] >> (4 * (index % PER_WORD)) & 7
    }

    /// The same with another exponent (below 8) of one variable.
    pub(crate) fn with_exponent(mut self, index: usize, exponent: u64) -> Self {
        let shift = 4 * (index % PER_WORD);
        let word = &mut self.0[index / PER_WORD];
        *word = *word & !(7 << shift) | exponent << shift;
        self
    }

    /// Product; `None` if an exponent gets too large.
    pub(crate) fn times(self, other: Self) -> Option<Self> {
        let mut product = self;
        for (a, b) in product.0.iter_mut().zip(other.0) {
            *a += b;
            if *a & OVERFLOW != 0 {
                return None;
            }
        }
        Some(product)
    }

    /// Variables, each as often as it is a factor.
    pub(crate) fn factors(self) -> Vec<usize> {
        let mut factors = Vec::new();
        for (w, word) in self.0.into_iter().enumerate() {
            let mut left = word;
            while left != 0 {
                let place = left.trailing_zeros() as usize / 4;
                let exponent = (left >> (4 * place) & 7) as usize;
                factors.extend(std::iter::repeat_n(w * PER_WORD + place, exponent));
                left &= !(7 << (4 * place));
            }
        }
        factors
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_add_exponents_until_they_overflow() {
        let (x, y) = (Monomial::variable(3), Monomial::variable(40));
        let xxy = x.times(x).and_then(|p| p.times(y)).unwrap();
        assert_eq!(xxy.factors(), [3, 3, 40]);
        assert_eq!(xxy.exponent(3), 2);
        assert_eq!(xxy.with_exponent(3, 0), y);
        let fourth = xxy.times(xxy).unwrap();
        assert_eq!(fourth.times(fourth), None);
    }
}
