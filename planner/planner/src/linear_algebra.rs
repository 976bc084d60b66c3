//! Small dense solves for an ordered scalar. nalgebra's own need `RealField`, which floats only have
//! with `std`.

use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::Ordered;

/// Whether `value` is larger than `bound`; no number is larger than NaN, and NaN than no number.
pub(crate) fn exceeds<T: Ordered>(value: T, bound: T) -> bool {
    value > bound
}

pub(crate) fn is_finite<T: Ordered, const R: usize, const C: usize>(m: &SMatrix<T, R, C>) -> bool {
    m.iter().all(|x| x.is_finite())
}

pub(crate) fn column<T: Ordered, const R: usize, const C: usize>(
    m: &SMatrix<T, R, C>,
    index: usize,
) -> SVector<T, R> {
    m.column(index).into_owned()
}

pub(crate) fn norm<T: Ordered, const N: usize>(v: &SVector<T, N>) -> T {
    v.dot(v).sqrt()
}

pub(crate) fn largest<T: Ordered>(values: impl IntoIterator<Item = T>) -> T {
    values.into_iter().fold(T::zero(), |max, x| if x.abs() > max { x.abs() } else { max })
}

/// Solves A X = B by Gaussian elimination with partial pivoting; `None` if A is singular to working
/// precision or not finite.
pub(crate) fn solve<T: Ordered, const N: usize, const M: usize>(
    mut a: SMatrix<T, N, N>,
    mut b: SMatrix<T, N, M>,
) -> Option<SMatrix<T, N, M>> {
    let threshold = largest(a.iter().copied()) * T::epsilon() * T::from_f64(N as f64);
    for column in 0..N {
        let mut pivot = column;
        for row in column + 1..N {
            if a[(row, column)].abs() > a[(pivot, column)].abs() {
                pivot = row;
            }
        }
        if !exceeds(a[(pivot, column)].abs(), threshold) {
            return None;
        }
        a.swap_rows(pivot, column);
        b.swap_rows(pivot, column);
        for row in column + 1..N {
            let factor = a[(row, column)] / a[(column, column)];
            for k in column + 1..N {
                let upper = a[(column, k)];
                a[(row, k)] -= factor * upper;
            }
            for k in 0..M {
                let upper = b[(column, k)];
                b[(row, k)] -= factor * upper;
            }
        }
    }
    for row in (0..N).rev() {
        for k in 0..M {
            let mut sum = b[(row, k)];
            for column in row + 1..N {
                sum -= a[(row, column)] * b[(column, k)];
            }
            b[(row, k)] = sum / a[(row, row)];
        }
    }
    is_finite(&b).then_some(b)
}

/// The inverse of A, under the conditions of [`solve`].
pub(crate) fn inverse<T: Ordered, const N: usize>(a: SMatrix<T, N, N>) -> Option<SMatrix<T, N, N>> {
    solve(a, SMatrix::identity())
}

/// The minimum-norm pseudo-inverse A^# = Aᵀ(A Aᵀ)⁻¹ of a matrix of full row rank; `None` if the rank
/// is less.
///
/// From Aᵀ = QR it is Q R⁻ᵀ, which does not square A's condition as forming A Aᵀ would.
pub(crate) fn pseudo_inverse<T: Ordered, const R: usize, const C: usize>(
    a: &SMatrix<T, R, C>,
) -> Option<SMatrix<T, C, R>> {
    let mut q = a.transpose();
    let mut lower = SMatrix::<T, R, R>::zeros(); // Rᵀ
    for j in 0..R {
        let original = norm(&column(&q, j));
        // Gram-Schmidt twice is orthogonal to working precision.
        for _ in 0..2 {
            for i in 0..j {
                let along = q.column(i).dot(&q.column(j));
                lower[(j, i)] += along;
                for k in 0..C {
                    let part = q[(k, i)] * along;
                    q[(k, j)] -= part;
                }
            }
        }
        let rest = norm(&column(&q, j));
        let threshold = original * T::epsilon() * T::from_f64((4 * C) as f64);
        if !exceeds(rest, threshold) {
            return None;
        }
        lower[(j, j)] = rest;
        for k in 0..C {
            q[(k, j)] /= rest;
        }
    }
    // X Rᵀ = Q, last column first.
    for j in (0..R).rev() {
        for k in 0..C {
            let mut sum = q[(k, j)];
            for i in j + 1..R {
                sum -= q[(k, i)] * lower[(i, j)];
            }
            q[(k, j)] = sum / lower[(j, j)];
        }
    }
    is_finite(&q).then_some(q)
}

/// The first row at which a Cholesky factorisation of the symmetric A breaks down, if any.
pub(crate) fn first_indefinite_row<T: Ordered, const N: usize>(
    mut a: SMatrix<T, N, N>,
) -> Option<usize> {
    for row in 0..N {
        for column in 0..=row {
            let mut sum = a[(row, column)];
            for k in 0..column {
                sum -= a[(row, k)] * a[(column, k)];
            }
            if column < row {
                a[(row, column)] = sum / a[(column, column)];
            } else if exceeds(sum, T::zero()) && sum.is_finite() {
                a[(row, row)] = sum.sqrt();
            } else {
                return Some(row);
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2x3, Matrix3, SMatrix, Vector3};

    #[test]
    fn solve_pivots_where_elimination_would_divide_by_zero() {
        let a = Matrix3::new(0.0, 2.0, 1.0, 1.0, 0.0, 3.0, 4.0, 1.0, 0.0);
        let x = Vector3::new(1.0, -2.0, 0.5);
        let found = solve(a, a * x).expect("regular");
        assert!((found - x).abs().max() < 1e-15);
        assert_eq!(solve(Matrix3::<f64>::from_element(1.0), x), None);
        assert_eq!(solve(Matrix3::from_element(f64::NAN), x), None);
    }

    #[test]
    fn pseudo_inverse_satisfies_the_penrose_conditions() {
        let a = Matrix2x3::new(1.0, 2.0, -1.0, 0.5, 1.0, 3.0);
        let x = pseudo_inverse(&a).expect("full rank");
        assert!((a * x - SMatrix::<f64, 2, 2>::identity()).abs().max() < 1e-15);
        let projector = x * a;
        assert!((projector - projector.transpose()).abs().max() < 1e-15);
        assert_eq!(pseudo_inverse(&Matrix2x3::new(1.0, 2.0, 3.0, 2.0, 4.0, 6.0)), None);
        assert_eq!(pseudo_inverse(&SMatrix::<f64, 3, 2>::from_fn(|i, j| (i + j * j) as f64)), None);
    }

    #[test]
    fn pseudo_inverse_keeps_its_digits_where_the_normal_matrix_loses_them() {
        let a = Matrix2x3::new(1.0, 1.0, 1.0, 1.0, 1.0, 1.0 + 1e-7);
        let x = pseudo_inverse(&a).expect("full rank");
        assert!((a * x - SMatrix::<f64, 2, 2>::identity()).abs().max() < 1e-8);
    }

    #[test]
    fn definiteness_is_decided_at_the_first_bad_row() {
        assert_eq!(first_indefinite_row(Matrix3::<f64>::identity()), None);
        let indefinite = Matrix3::new(2.0, 3.0, 0.0, 3.0, 2.0, 0.0, 0.0, 0.0, 1.0);
        assert_eq!(first_indefinite_row(indefinite), Some(1));
    }
}
