//! Sampling and the discrete algebraic Riccati equation.

use super::Linear;
use crate::Error;
use nalgebra::DMatrix;

/// The doubling algorithm converges quadratically.
const MAX_DOUBLINGS: usize = 60;

/// Matrices of x⁺ = A x + B u with u held for `period` seconds: exp([A, B; 0, 0] T).
#[must_use]
pub fn discretise(system: &Linear, period: f64) -> (DMatrix<f64>, DMatrix<f64>) {
    let (n, m) = system.input.shape();
    let mut both = DMatrix::zeros(n + m, n + m);
    both.view_mut((0, 0), (n, n)).copy_from(&system.state);
    both.view_mut((0, n), (n, m)).copy_from(&system.input);
    let exponential = (both * period).exp();
    (exponential.view((0, 0), (n, n)).into_owned(), exponential.view((0, n), (n, m)).into_owned())
}

/// The gain K that makes Σ xᵀQ x + uᵀR u smallest with u = −K x, by the structure-preserving doubling
/// algorithm (Chu, Fan, Lin and Wang 2004).
///
/// # Errors
///
/// [`Error::NoSolution`] if R is singular, or what is unstable cannot be reached.
pub fn solve_riccati(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
) -> Result<DMatrix<f64>, Error> {
    let refused = Error::NoSolution { equation: "discrete Riccati equation" };
    let inverse = |matrix: DMatrix<f64>| matrix.try_inverse().ok_or_else(|| refused.clone());
    let identity = DMatrix::identity(a.nrows(), a.nrows());
    let mut state = a.clone();
    let mut g = b * inverse(r.clone())? * b.transpose();
    let mut h = q.clone();
    let mut settled = false;
    for _ in 0..MAX_DOUBLINGS {
        let w = inverse(&identity + &g * &h)?;
        let (wa, wg) = (&w * &state, &w * &g);
        let growth = state.transpose() * &h * &wa;
        g += &state * wg * state.transpose();
        h += &growth;
        state = &state * wa;
        if growth.norm() <= 1e-13 * h.norm() {
            settled = true;
            break;
        }
    }
    let gain = inverse(r + b.transpose() * &h * b)? * b.transpose() * &h * a;
    let closed = a - b * &gain;
    let rate = closed.complex_eigenvalues().iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    if settled && rate < 1.0 { Ok(gain) } else { Err(refused) }
}

#[cfg(test)]
mod tests {
    use super::{discretise, solve_riccati};
    use crate::lqr::Linear;
    use nalgebra::DMatrix;

    fn matrix(rows: usize, entries: &[f64]) -> DMatrix<f64> {
        DMatrix::from_row_slice(rows, entries.len() / rows, entries)
    }

    #[test]
    fn a_scalar_equation_is_solved_by_hand() {
        // p = a²p/(1 + p) + 1 with a = 2: p² − 4p − 1 = 0, p = 2 + √5; k = a p/(1 + p).
        let p = 2.0 + 5.0_f64.sqrt();
        let one = matrix(1, &[1.0]);
        let gain = solve_riccati(&matrix(1, &[2.0]), &one, &one, &one).unwrap();
        assert!((gain[(0, 0)] - 2.0 * p / (1.0 + p)).abs() < 1e-12, "{gain}");
    }

    #[test]
    fn what_cannot_be_reached_has_no_gain() {
        let (a, b) = (matrix(2, &[1.1, 0.0, 0.0, 0.5]), matrix(2, &[0.0, 1.0]));
        assert!(solve_riccati(&a, &b, &DMatrix::identity(2, 2), &matrix(1, &[1.0])).is_err());
    }

    #[test]
    fn a_double_integrator_is_sampled_by_hand() {
        let system =
            Linear { state: matrix(2, &[0.0, 1.0, 0.0, 0.0]), input: matrix(2, &[0.0, 1.0]) };
        let (a, b) = discretise(&system, 0.1);
        assert!((a - matrix(2, &[1.0, 0.1, 0.0, 1.0])).norm() < 1e-14);
        assert!((b - matrix(2, &[0.005, 0.1])).norm() < 1e-14);
    }
}
