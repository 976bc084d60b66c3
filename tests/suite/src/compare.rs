//! Comparison of arrays, entry by entry, against their largest entry.

use shapebot_dynamics::Ordered;
use shapebot_dynamics::nalgebra::SMatrix;
use std::fmt::Display;

/// Numbers with the extents they are laid out by: `[]` a scalar, `[n]`, `[rows, columns]`,
/// `[layers, rows, columns]`; last index fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Extents.
    pub extents: Vec<usize>,
    /// Entries.
    pub entries: Vec<f64>,
}

impl Array {
    /// The largest magnitude; NaN if there is one.
    #[must_use]
    pub fn largest(&self) -> f64 {
        let larger = |max: f64, x: &f64| if x.abs() > max || x.is_nan() { x.abs() } else { max };
        self.entries.iter().fold(0.0, larger)
    }

    /// `[1][0]` for the entry at a position of the list.
    fn index(&self, mut position: usize) -> String {
        let mut text = String::new();
        for &extent in self.extents.iter().rev() {
            text.insert_str(0, &format!("[{}]", position % extent.max(1)));
            position /= extent.max(1);
        }
        text
    }
}

/// What has numbers in it.
pub trait Numbers {
    /// The numbers as doubles.
    fn array(&self) -> Array;
}

impl Numbers for Array {
    fn array(&self) -> Array {
        self.clone()
    }
}

impl Numbers for f64 {
    fn array(&self) -> Array {
        Array { extents: Vec::new(), entries: vec![*self] }
    }
}

impl Numbers for f32 {
    fn array(&self) -> Array {
        f64::from(*self).array()
    }
}

impl<T: Ordered, const R: usize, const C: usize> Numbers for SMatrix<T, R, C> {
    fn array(&self) -> Array {
        let rows = self.row_iter();
        let entries = rows.flat_map(|row| row.iter().map(|x| x.to_f64()).collect::<Vec<_>>());
        Array { extents: if C == 1 { vec![R] } else { vec![R, C] }, entries: entries.collect() }
    }
}

impl<A: Numbers, const L: usize> Numbers for [A; L] {
    fn array(&self) -> Array {
        let layers: Vec<Array> = self.iter().map(Numbers::array).collect();
        let mut extents = vec![L];
        extents.extend(layers.first().into_iter().flat_map(|a| a.extents.clone()));
        Array { extents, entries: layers.into_iter().flat_map(|a| a.entries).collect() }
    }
}

/// What is wrong with an array, if anything: an entry further from the expected one than `tolerance`
/// times the largest expected entry (times one, if nothing but zero is expected).
///
/// # Errors
///
/// A sentence with the entry, both values and the error.
pub fn compare(found: &Array, expected: &Array, tolerance: f64) -> Result<(), String> {
    let scale = if expected.largest() == 0.0 { 1.0 } else { expected.largest() };
    compare_on_scale(found, expected, tolerance, scale)
}

/// The same with a given scale: for quantities that are small differences of large ones.
///
/// # Errors
///
/// As [`compare`].
pub fn compare_on_scale(
    found: &Array,
    expected: &Array,
    tolerance: f64,
    scale: f64,
) -> Result<(), String> {
    if found.entries.len() != expected.entries.len() {
        return Err(format!(
            "has {} entries, {} expected",
            found.entries.len(),
            expected.entries.len()
        ));
    }
    let errors = found.entries.iter().zip(&expected.entries);
    let errors = errors.map(|(found, expected)| (found - expected).abs() / scale);
    let worst = errors.enumerate().fold((0, 0.0), worse);
    if worst.1 <= tolerance {
        return Ok(());
    }
    let layout = if found.extents.len() > expected.extents.len() { found } else { expected };
    Err(format!(
        "{}: found {:e}, expected {:e}: off by {:.2e} of {:e}, {tolerance:e} allowed",
        layout.index(worst.0),
        found.entries[worst.0],
        expected.entries[worst.0],
        worst.1,
        scale,
    ))
}

/// The larger error; NaN is the largest.
fn worse(a: (usize, f64), b: (usize, f64)) -> (usize, f64) {
    if a.1.is_nan() || b.1 <= a.1 { a } else { b }
}

/// Compares to `tolerance` of the largest expected entry; fails with the entry's place.
#[track_caller]
pub fn assert_close(
    what: impl Display,
    found: &impl Numbers,
    expected: &impl Numbers,
    tolerance: f64,
) {
    if let Err(fault) = compare(&found.array(), &expected.array(), tolerance) {
        panic!("{what}{fault}");
    }
}

/// Compares to `tolerance` of a given scale; fails with the entry's place.
#[track_caller]
pub fn assert_close_on_scale(
    what: impl Display,
    found: &impl Numbers,
    expected: &impl Numbers,
    tolerance: f64,
    scale: f64,
) {
    if let Err(fault) = compare_on_scale(&found.array(), &expected.array(), tolerance, scale) {
        panic!("{what}{fault}");
    }
}

#[cfg(test)]
mod tests {
    use super::{Numbers, compare};
    use shapebot_dynamics::nalgebra::{Matrix2, Matrix2x3};

    #[test]
    fn the_worst_entry_is_named() {
        let expected = Matrix2x3::new(1.0, 2.0, 3.0, 4.0, 5.0, 10.0);
        let mut found = expected;
        found[(1, 0)] += 0.5;
        found[(0, 2)] += 0.25;
        let fault = compare(&found.array(), &expected.array(), 1e-3).expect_err("a fault");
        assert!(fault.starts_with("[1][0]: found 4.5e0, expected 4e0: off by 5.00e-2"), "{fault}");
        assert_eq!(compare(&found.array(), &expected.array(), 0.051), Ok(()));
        let layers = compare(&[expected, found].array(), &[expected, expected].array(), 0.01);
        assert!(layers.expect_err("a fault").starts_with("[1][1][0]"));
    }

    #[test]
    fn nothing_that_is_no_number_passes() {
        let good = Matrix2::new(1.0, 2.0, 3.0, 4.0);
        for at in 0..4 {
            let mut bad = good;
            bad[at] = f64::NAN;
            assert!(compare(&bad.array(), &good.array(), 1e300).is_err());
            assert!(compare(&good.array(), &bad.array(), 1e300).is_err());
        }
        assert!(compare(&good.array(), &1.0.array(), 1.0).is_err());
    }

    #[test]
    fn zero_is_expected_absolutely() {
        let zero = Matrix2::<f64>::zeros();
        assert_eq!(compare(&zero.array(), &zero.array(), 1e-12), Ok(()));
        assert!(compare(&zero.add_scalar(1e-9).array(), &zero.array(), 1e-12).is_err());
    }
}
