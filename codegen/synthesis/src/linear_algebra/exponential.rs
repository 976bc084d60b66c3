//! Sampling of linear systems.

use super::Matrix;

/// Terms of the series after scaling: with a norm of at most a half, the rest is below 1e-18.
const TERMS: usize = 14;

/// (A_d, B_d) of ẋ = A x + B u with u held for a period.
pub(crate) fn zero_order_hold(a: &Matrix, b: &Matrix, period: f64) -> (Matrix, Matrix) {
    let (n, m) = (a.rows, b.columns);
    let joined = Matrix::from_fn(n + m, n + m, |i, j| match (i < n, j < n) {
        (true, true) => period * a[(i, j)],
        (true, false) => period * b[(i, j - n)],
        _ => 0.0,
    });
    let whole = exponential(&joined);
    let rows: Vec<usize> = (0..n).collect();
    let inputs: Vec<usize> = (n..n + m).collect();
    (whole.pick(&rows, &rows), whole.pick(&rows, &inputs))
}

/// e^A by scaling and squaring of the power series.
fn exponential(a: &Matrix) -> Matrix {
    let norm = (0..a.rows).map(|i| a.row(i).iter().map(|x| x.abs()).sum()).fold(0.0, f64::max);
    let mut halvings = 0;
    let mut scale = 1.0;
    while norm * scale > 0.5 && halvings < 60 {
        scale *= 0.5;
        halvings += 1;
    }
    let a = a.scaled(scale);
    let mut term = Matrix::identity(a.rows);
    let mut sum = term.clone();
    for k in 1..=TERMS {
        term = term.times(&a).scaled(1.0 / k as f64);
        sum = sum.plus(&term);
    }
    for _ in 0..halvings {
        sum = sum.times(&sum);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_held_force_on_a_mass_is_sampled_as_by_hand() {
        // ẍ = u: x⁺ = x + T v + T²/2 u, v⁺ = v + T u.
        let a = Matrix::from_fn(2, 2, |i, j| if (i, j) == (0, 1) { 1.0 } else { 0.0 });
        let b = Matrix::from_fn(2, 1, |i, _| i as f64);
        let (ad, bd) = zero_order_hold(&a, &b, 0.25);
        assert_eq!((ad[(0, 1)], bd[(0, 0)], bd[(1, 0)]), (0.25, 0.03125, 0.25));
    }

    #[test]
    fn a_fast_pole_decays_exactly() {
        let a = Matrix::from_fn(1, 1, |_, _| -40.0);
        let (ad, bd) = zero_order_hold(&a, &Matrix::identity(1), 0.5);
        assert!((ad[(0, 0)] / (-20.0_f64).exp() - 1.0).abs() < 1e-12);
        assert!((bd[(0, 0)] * 40.0 - 1.0).abs() < 1e-8);
    }
}
