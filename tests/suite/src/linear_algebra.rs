//! A few small solves, so that the suite needs no more of nalgebra than the runtime crates do.

use shapebot_dynamics::nalgebra::SMatrix;

/// The smallest pivot of the Cholesky decomposition, relative to the diagonal entry it belongs to:
/// positive for a positive definite matrix.
#[must_use]
pub fn smallest_pivot<const N: usize>(matrix: &SMatrix<f64, N, N>) -> f64 {
    let mut work = *matrix;
    let mut smallest = f64::INFINITY;
    for k in 0..N {
        let pivot = work[(k, k)];
        smallest = smallest.min(pivot / matrix[(k, k)]);
        if pivot <= 0.0 || pivot.is_nan() {
            return f64::NEG_INFINITY;
        }
        for i in k + 1..N {
            for j in k + 1..N {
                work[(i, j)] -= work[(i, k)] * work[(k, j)] / pivot;
            }
        }
    }
    smallest
}

/// Inverse by Gauss and Jordan with pivoting; `None` for a singular matrix.
#[must_use]
pub fn inverse<const N: usize>(matrix: &SMatrix<f64, N, N>) -> Option<SMatrix<f64, N, N>> {
    let (mut left, mut right) = (*matrix, SMatrix::<f64, N, N>::identity());
    for k in 0..N {
        let row = (k..N).max_by(|&a, &b| left[(a, k)].abs().total_cmp(&left[(b, k)].abs()))?;
        left.swap_rows(k, row);
        right.swap_rows(k, row);
        let pivot = left[(k, k)];
        if pivot == 0.0 || !pivot.is_finite() {
            return None;
        }
        left.row_mut(k).apply(|x| *x /= pivot);
        right.row_mut(k).apply(|x| *x /= pivot);
        for i in (0..N).filter(|&i| i != k) {
            let factor = left[(i, k)];
            let (from_left, from_right) = (left.row(k) * factor, right.row(k) * factor);
            let mut row = left.row_mut(i);
            row -= from_left;
            let mut row = right.row_mut(i);
            row -= from_right;
        }
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::{inverse, smallest_pivot};
    use shapebot_dynamics::nalgebra::{Matrix2, Matrix3};

    #[test]
    fn pivots_tell_definite_from_indefinite() {
        assert!((smallest_pivot(&Matrix2::new(2.0, 1.0, 1.0, 2.0)) - 0.75).abs() < 1e-15);
        assert!(smallest_pivot(&Matrix2::new(1.0, 2.0, 2.0, 1.0)) < 0.0);
        assert!(smallest_pivot(&Matrix2::new(f64::NAN, 0.0, 0.0, 1.0)) < 0.0);
        let third = Matrix3::new(4.0, 2.0, 0.0, 2.0, 4.0, 1.0, 0.0, 1.0, 0.1);
        assert!(smallest_pivot(&third) < 0.0);
    }

    #[test]
    fn an_inverse_undoes_its_matrix() {
        let matrix = Matrix3::new(0.0, 2.0, 1.0, 3.0, 1.0, -1.0, 0.5, 0.25, 4.0);
        let product = matrix * inverse(&matrix).expect("regular");
        assert!((product - Matrix3::identity()).abs().max() < 1e-14);
        assert!(inverse(&Matrix2::new(1.0, 2.0, 2.0, 4.0)).is_none());
    }
}
