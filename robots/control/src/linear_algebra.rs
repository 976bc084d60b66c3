//! Small dense solves without pivots that depend on data, and inverses for constructors.

use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::Ordered;

/// Factors L D Lᵀ of a symmetric positive definite matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factors<T: Ordered, const N: usize> {
    /// L D below the diagonal, D⁻¹ on it.
    lower: SMatrix<T, N, N>,
}

impl<T: Ordered, const N: usize> Factors<T, N> {
    /// Always the same work.
    pub(crate) fn of(mut a: SMatrix<T, N, N>) -> Self {
        for column in 0..N {
            let reciprocal = T::one() / a[(column, column)];
            let own: SVector<T, N> = a.column(column).into();
            let factors = own * reciprocal;
            // Column by column: of ranges that end with N the compiler sees that no index can panic.
            for k in column + 1..N {
                let upper = own[k];
                for row in k..N {
                    a[(row, k)] -= factors[row] * upper;
                }
            }
            a[(column, column)] = reciprocal;
        }
        Self { lower: a }
    }

    /// x of A x = b.
    pub(crate) fn solve(&self, mut b: SVector<T, N>) -> SVector<T, N> {
        let a = &self.lower;
        for column in 0..N {
            b[column] *= a[(column, column)];
            for row in column + 1..N {
                let part = a[(row, column)] * b[column];
                b[row] -= part;
            }
        }
        for row in (0..N).rev() {
            for below in row + 1..N {
                let part = a[(below, row)] * a[(row, row)] * b[below];
                b[row] -= part;
            }
        }
        b
    }
}

/// Solves A x = b for a symmetric positive definite A: always the same work.
pub(crate) fn solve_definite<T: Ordered, const N: usize>(
    a: SMatrix<T, N, N>,
    b: SVector<T, N>,
) -> SVector<T, N> {
    Factors::of(a).solve(b)
}

/// Solves A x = b for an A near the identity, by elimination without pivots: always the same work.
pub(crate) fn solve_near_identity<T: Ordered, const N: usize>(
    mut a: SMatrix<T, N, N>,
    mut b: SVector<T, N>,
) -> SVector<T, N> {
    for column in 0..N {
        let reciprocal = T::one() / a[(column, column)];
        for k in column..N {
            a[(column, k)] *= reciprocal;
        }
        b[column] *= reciprocal;
        for row in (0..N).filter(|&row| row != column) {
            let factor = a[(row, column)];
            for k in column + 1..N {
                let part = factor * a[(column, k)];
                a[(row, k)] -= part;
            }
            let part = factor * b[column];
            b[row] -= part;
        }
    }
    b
}

/// The inverse of A by elimination with row pivoting; `None` if A is singular to working precision or
/// not finite.
pub(crate) fn inverse<T: Ordered, const N: usize>(
    mut a: SMatrix<T, N, N>,
) -> Option<SMatrix<T, N, N>> {
    let mut b = SMatrix::<T, N, N>::identity();
    let largest = a.iter().fold(T::zero(), |m, x| if x.abs() > m { x.abs() } else { m });
    let threshold = largest * T::epsilon() * T::from_f64((4 * N) as f64);
    for column in 0..N {
        let mut pivot = column;
        for row in column + 1..N {
            if a[(row, column)].abs() > a[(pivot, column)].abs() {
                pivot = row;
            }
        }
        let size = a[(pivot, column)].abs();
        if !size.is_finite() || size <= threshold {
            return None;
        }
        a.swap_rows(pivot, column);
        b.swap_rows(pivot, column);
        let reciprocal = T::one() / a[(column, column)];
        for row in (0..N).filter(|&row| row != column) {
            let factor = a[(row, column)] * reciprocal;
            for k in 0..N {
                let (left, right) = (a[(column, k)], b[(column, k)]);
                a[(row, k)] -= factor * left;
                b[(row, k)] -= factor * right;
            }
        }
        for k in 0..N {
            a[(column, k)] *= reciprocal;
            b[(column, k)] *= reciprocal;
        }
    }
    b.iter().all(|x| x.is_finite()).then_some(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector3};

    #[test]
    fn definite_solutions_satisfy_their_equations() {
        let a = Matrix3::new(4.0, 1.0, -0.5, 1.0, 3.0, 0.25, -0.5, 0.25, 2.0);
        let x = Vector3::new(1.0, -2.0, 0.5);
        assert!((solve_definite(a, a * x) - x).abs().max() < 1e-15);
    }

    #[test]
    fn near_the_identity_no_pivot_is_needed() {
        let a = Matrix3::new(1.2, 0.1, -0.3, 0.2, 0.9, 0.25, -0.1, 0.3, 1.1);
        let x = Vector3::new(1.0, -2.0, 0.5);
        assert!((solve_near_identity(a, a * x) - x).abs().max() < 1e-15);
    }

    #[test]
    fn inverses_pivot_and_refuse_singular_matrices() {
        let a = Matrix3::new(0.0, 2.0, 1.0, 1.0, 0.0, 3.0, 4.0, 1.0, 0.0);
        let found = inverse(a).expect("regular");
        assert!((found * a - Matrix3::identity()).abs().max() < 1e-15);
        assert_eq!(inverse(Matrix3::<f64>::from_element(1.0)), None);
        assert_eq!(inverse(Matrix3::from_element(f64::NAN)), None);
    }
}
