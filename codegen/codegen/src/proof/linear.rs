//! Small dense linear algebra in doubles, by simple and robust methods: build scripts run unoptimised.

use super::certificate::Root;

/// Rows of a matrix.
pub(super) type Matrix = Vec<Vec<f64>>;

/// Lower Cholesky factor; `None` if the matrix is not positive definite.
pub(super) fn cholesky(a: &Matrix) -> Option<Matrix> {
    let n = a.len();
    let scale = (0..n).map(|i| a[i][i].abs()).fold(0.0, f64::max);
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let rest: f64 = a[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            if i == j {
                // A pivot that is lost in rounding is no pivot. NaN fails the comparison as well.
                let positive = rest > 1e-14 * scale;
                if !positive {
                    return None;
                }
                l[i][i] = rest.sqrt();
            } else {
                l[i][j] = rest / l[j][j];
            }
        }
    }
    Some(l)
}

/// Eigenvalues of a symmetric matrix by Jacobi rotations, ascending.
pub(super) fn symmetric_eigenvalues(matrix: &Matrix) -> Vec<f64> {
    let n = matrix.len();
    let mut a = matrix.clone();
    for _sweep in 0..50 {
        let off: f64 =
            (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| a[i][j].powi(2)).sum();
        let diagonal: f64 = (0..n).map(|i| a[i][i].powi(2)).sum();
        if off <= 1e-32 * diagonal {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                rotate(&mut a, p, q);
            }
        }
    }
    let mut values: Vec<f64> = (0..n).map(|i| a[i][i]).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Annihilates the entry (p, q).
fn rotate(a: &mut Matrix, p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    for k in 0..a.len() {
        let (x, y) = (a[k][p], a[k][q]);
        a[k][p] = c * x - s * y;
        a[k][q] = s * x + c * y;
    }
    for k in 0..a.len() {
        let (x, y) = (a[p][k], a[q][k]);
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
    }
}

/// Eigenvalues λ of A x = λ M x with A symmetric and M symmetric positive definite, ascending.
pub(super) fn definite_eigenvalues(a: &Matrix, m: &Matrix) -> Option<Vec<f64>> {
    let l = cholesky(m)?;
    // L⁻¹ A, then its transpose by the same: L⁻¹ A L⁻ᵀ.
    let half = forward_columns(&l, a);
    let whole = forward_columns(&l, &transpose(&half));
    Some(symmetric_eigenvalues(&whole))
}

/// L⁻¹ B.
fn forward_columns(l: &Matrix, b: &Matrix) -> Matrix {
    let mut x = b.clone();
    for i in 0..l.len() {
        for c in 0..x[i].len() {
            let known: f64 = (0..i).map(|k| l[i][k] * x[k][c]).sum();
            x[i][c] = (x[i][c] - known) / l[i][i];
        }
    }
    x
}

/// Transpose.
pub(super) fn transpose(a: &Matrix) -> Matrix {
    let width = a.first().map_or(0, Vec::len);
    (0..width).map(|j| a.iter().map(|row| row[j]).collect()).collect()
}

/// Product.
pub(super) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let columns = transpose(b);
    let dot = |row: &Vec<f64>, column: &Vec<f64>| row.iter().zip(column).map(|(x, y)| x * y).sum();
    a.iter().map(|row| columns.iter().map(|column| dot(row, column)).collect()).collect()
}

/// A⁻¹ B by elimination with row pivoting; `None` if A is singular.
pub(super) fn solve(a: &Matrix, b: &Matrix) -> Option<Matrix> {
    let n = a.len();
    let (mut a, mut x) = (a.clone(), b.clone());
    let scale = a.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        let usable = a[pivot][k].abs() > 1e-13 * scale;
        if !usable {
            return None;
        }
        a.swap(k, pivot);
        x.swap(k, pivot);
        for i in 0..n {
            if i == k {
                continue;
            }
            let factor = a[i][k] / a[k][k];
            for j in k..n {
                a[i][j] -= factor * a[k][j];
            }
            for j in 0..x[i].len() {
                x[i][j] -= factor * x[k][j];
            }
        }
    }
    for k in 0..n {
        for value in &mut x[k] {
            *value /= a[k][k];
        }
    }
    Some(x)
}

/// Eigenvalues of a general matrix of a few rows: roots of its characteristic polynomial
/// (Faddeev-LeVerrier, then Durand-Kerner).
pub(super) fn eigenvalues(a: &Matrix) -> Vec<Root> {
    let n = a.len();
    let mut coefficients = vec![1.0];
    let mut power = identity(n);
    #[allow(clippy::cast_precision_loss)]
    for k in 1..=n {
        power = product(a, &power);
        let c = -(0..n).map(|i| power[i][i]).sum::<f64>() / k as f64;
        coefficients.push(c);
        for i in 0..n {
            power[i][i] += c;
        }
    }
    polynomial_roots(&coefficients)
}

/// Unit matrix.
pub(super) fn identity(n: usize) -> Matrix {
    (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect()
}

/// Roots of a polynomial with leading coefficient one, highest power first.
fn polynomial_roots(coefficients: &[f64]) -> Vec<Root> {
    let n = coefficients.len() - 1;
    if let [_, p, q] = *coefficients {
        return quadratic_roots(p, q);
    }
    let bound = 1.0 + coefficients[1..].iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    #[allow(clippy::cast_precision_loss)]
    let start = |k: usize| {
        let angle = 0.4 + std::f64::consts::TAU * k as f64 / n as f64;
        Root { re: bound * angle.cos(), im: bound * angle.sin() }
    };
    let mut roots: Vec<Root> = (0..n).map(start).collect();
    for _ in 0..500 {
        for i in 0..n {
            let z = roots[i];
            let value = coefficients.iter().fold(Root { re: 0.0, im: 0.0 }, |v, c| {
                let w = times(v, z);
                Root { re: w.re + c, im: w.im }
            });
            let others = (0..n).filter(|&j| j != i).fold(Root { re: 1.0, im: 0.0 }, |d, j| {
                times(d, Root { re: z.re - roots[j].re, im: z.im - roots[j].im })
            });
            let size = others.re * others.re + others.im * others.im;
            if size > 0.0 {
                let step = times(value, Root { re: others.re / size, im: -others.im / size });
                roots[i] = Root { re: z.re - step.re, im: z.im - step.im };
            }
        }
    }
    for root in &mut roots {
        if root.im.abs() < 1e-6 * root.re.abs().max(1e-300) {
            root.im = 0.0;
        }
    }
    sorted(roots)
}

/// Roots of x² + p x + q. Two that differ by rounding alone are one double root.
fn quadratic_roots(p: f64, q: f64) -> Vec<Root> {
    let centre = -0.5 * p;
    let spread = centre * centre - q;
    if spread.abs() <= 1e-12 * (centre * centre).max(q.abs()) {
        return vec![Root { re: centre, im: 0.0 }; 2];
    }
    let width = spread.abs().sqrt();
    if spread < 0.0 {
        return sorted(vec![Root { re: centre, im: -width }, Root { re: centre, im: width }]);
    }
    let larger = centre + width.copysign(centre);
    sorted(vec![Root { re: larger, im: 0.0 }, Root { re: q / larger, im: 0.0 }])
}

fn times(a: Root, b: Root) -> Root {
    Root { re: a.re * b.re - a.im * b.im, im: a.re * b.im + a.im * b.re }
}

/// By real part, then by imaginary part.
pub(super) fn sorted(mut roots: Vec<Root>) -> Vec<Root> {
    roots.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
    roots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definite_pencils_have_the_known_eigenvalues() {
        let a = vec![vec![2.0, 1.0], vec![1.0, 2.0]];
        let m = vec![vec![2.0, 0.0], vec![0.0, 2.0]];
        let values = definite_eigenvalues(&a, &m).unwrap();
        assert!((values[0] - 0.5).abs() < 1e-14 && (values[1] - 1.5).abs() < 1e-14);
        assert!(cholesky(&vec![vec![1.0, 2.0], vec![2.0, 1.0]]).is_none());
    }

    #[test]
    fn eigenvalues_of_general_matrices_may_be_complex() {
        let turn = vec![vec![0.0, -2.0, 0.0], vec![2.0, 0.0, 0.0], vec![0.0, 0.0, 3.0]];
        let roots = eigenvalues(&turn);
        assert!(roots.iter().any(|r| (r.re - 3.0).abs() < 1e-9 && r.im == 0.0));
        assert!(roots.iter().any(|r| r.re.abs() < 1e-9 && (r.im - 2.0).abs() < 1e-9));
    }

    #[test]
    fn solving_undoes_multiplication() {
        let a = vec![vec![0.0, 2.0, 1.0], vec![1.0, 0.0, 3.0], vec![4.0, 1.0, 0.0]];
        let b = vec![vec![1.0], vec![2.0], vec![3.0]];
        let x = solve(&a, &product(&a, &b)).unwrap();
        for i in 0..3 {
            assert!((x[i][0] - b[i][0]).abs() < 1e-14);
        }
    }
}
