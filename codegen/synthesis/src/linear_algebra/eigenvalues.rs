//! Eigenvalues of a general real matrix.

use super::Matrix;

/// Sweeps per eigenvalue before giving up.
const SWEEPS: usize = 60;

/// Eigenvalues (re, im), by reduction to Hessenberg form and Francis' double-shift QR steps; `None` if
/// that does not converge or an entry is not finite.
pub(crate) fn eigenvalues(matrix: &Matrix) -> Option<Vec<(f64, f64)>> {
    if !matrix.largest().is_finite() {
        return None;
    }
    let mut h = matrix.clone();
    reduce(&mut h);
    let mut values = Vec::with_capacity(h.rows);
    let mut shift = 0.0;
    let mut active = h.rows;
    let mut sweeps = 0;
    while active > 0 {
        let last = active - 1;
        let start = split(&h, last);
        if start == last {
            values.push((h[(last, last)] + shift, 0.0));
            active -= 1;
            sweeps = 0;
        } else if start + 1 == last {
            values.extend(pair(&h, last, shift));
            active -= 2;
            sweeps = 0;
        } else {
            if sweeps == SWEEPS {
                return None;
            }
            sweeps += 1;
            let shifts = shifts(&mut h, last, sweeps, &mut shift);
            step(&mut h, start, last, shifts);
        }
    }
    Some(values)
}

/// Hessenberg form by elimination with pivoting: similar, not orthogonally.
fn reduce(a: &mut Matrix) {
    let n = a.rows;
    for m in 1..n.saturating_sub(1) {
        let pivot = (m..n).max_by(|&i, &j| a[(i, m - 1)].abs().total_cmp(&a[(j, m - 1)].abs()));
        let pivot = pivot.unwrap_or(m);
        if a[(pivot, m - 1)] == 0.0 {
            continue;
        }
        a.swap_rows(pivot, m);
        for i in 0..n {
            let (x, y) = (a[(i, pivot)], a[(i, m)]);
            a[(i, pivot)] = y;
            a[(i, m)] = x;
        }
        for i in m + 1..n {
            let factor = a[(i, m - 1)] / a[(m, m - 1)];
            if factor == 0.0 {
                continue;
            }
            a.subtract_row(i, m, factor);
            a[(i, m - 1)] = 0.0;
            for k in 0..n {
                let part = factor * a[(k, i)];
                a[(k, m)] += part;
            }
        }
    }
}

/// Start of the last block that does not fall apart.
fn split(h: &Matrix, last: usize) -> usize {
    let mut start = last;
    while start > 0 {
        let size = h[(start - 1, start - 1)].abs() + h[(start, start)].abs();
        let size = if size == 0.0 { h.largest() } else { size };
        if h[(start, start - 1)].abs() <= f64::EPSILON * size {
            break;
        }
        start -= 1;
    }
    start
}

/// Eigenvalues of the last 2 × 2 block.
fn pair(h: &Matrix, last: usize, shift: f64) -> [(f64, f64); 2] {
    let (x, y) = (h[(last, last)], h[(last - 1, last - 1)]);
    let w = h[(last, last - 1)] * h[(last - 1, last)];
    let p = 0.5 * (y - x);
    let q = p * p + w;
    let root = q.abs().sqrt();
    if q < 0.0 {
        return [(x + p + shift, root), (x + p + shift, -root)];
    }
    let z = p + root.copysign(p);
    let other = if z == 0.0 { x } else { x - w / z };
    [(x + z + shift, 0.0), (other + shift, 0.0)]
}

/// Sum and product of the two shifts; exceptional ones where the usual do not help.
fn shifts(h: &mut Matrix, last: usize, sweeps: usize, shift: &mut f64) -> [f64; 3] {
    if sweeps.is_multiple_of(10) {
        let x = h[(last, last)];
        *shift += x;
        for i in 0..=last {
            h[(i, i)] -= x;
        }
        let size = h[(last, last - 1)].abs() + h[(last - 1, last - 2)].abs();
        return [0.75 * size, 0.75 * size, -0.4375 * size * size];
    }
    [h[(last, last)], h[(last - 1, last - 1)], h[(last, last - 1)] * h[(last - 1, last)]]
}

/// One double-shift QR sweep over rows `start..=last`.
fn step(h: &mut Matrix, start: usize, last: usize, [x, y, w]: [f64; 3]) {
    let mut m = last - 2;
    let mut column = loop {
        let z = h[(m, m)];
        let (r, s) = (x - z, y - z);
        let column = [
            (r * s - w) / h[(m + 1, m)] + h[(m, m + 1)],
            h[(m + 1, m + 1)] - z - r - s,
            h[(m + 2, m + 1)],
        ];
        let size = column.iter().map(|v| v.abs()).sum::<f64>();
        let column = column.map(|v| v / size);
        if m == start {
            break column;
        }
        let small = h[(m, m - 1)].abs() * (column[1].abs() + column[2].abs());
        let near = h[(m - 1, m - 1)].abs() + z.abs() + h[(m + 1, m + 1)].abs();
        if small <= f64::EPSILON * column[0].abs() * near {
            break column;
        }
        m -= 1;
    };
    for i in m + 2..=last {
        h[(i, i - 2)] = 0.0;
        if i > m + 2 {
            h[(i, i - 3)] = 0.0;
        }
    }
    for k in m..last {
        chase(h, [start, m, k, last], &mut column);
    }
}

/// Moves the bulge from column k to k + 1.
fn chase(h: &mut Matrix, [start, m, k, last]: [usize; 4], column: &mut [f64; 3]) {
    let third = k + 1 < last;
    let mut size = 1.0;
    if k > m {
        *column = [h[(k, k - 1)], h[(k + 1, k - 1)], if third { h[(k + 2, k - 1)] } else { 0.0 }];
        size = column.iter().map(|v| v.abs()).sum();
        if size == 0.0 {
            return;
        }
        *column = column.map(|v| v / size);
    }
    let [p, q, r] = *column;
    let s = (p * p + q * q + r * r).sqrt().copysign(p);
    if s == 0.0 {
        return;
    }
    if k > m {
        h[(k, k - 1)] = -s * size;
    } else if start != m {
        h[(k, k - 1)] = -h[(k, k - 1)];
    }
    let p = p + s;
    let (x, y, z) = (p / s, q / s, r / s);
    let (q, r) = (q / p, r / p);
    for j in k..h.columns {
        let mut sum = h[(k, j)] + q * h[(k + 1, j)];
        if third {
            sum += r * h[(k + 2, j)];
            h[(k + 2, j)] -= sum * z;
        }
        h[(k + 1, j)] -= sum * y;
        h[(k, j)] -= sum * x;
    }
    for i in 0..=last.min(k + 3) {
        let mut sum = x * h[(i, k)] + y * h[(i, k + 1)];
        if third {
            sum += z * h[(i, k + 2)];
            h[(i, k + 2)] -= sum * r;
        }
        h[(i, k + 1)] -= sum * q;
        h[(i, k)] -= sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(matrix: &Matrix) -> Vec<(f64, f64)> {
        let mut values = eigenvalues(matrix).expect("convergence");
        values.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        values
    }

    /// Companion matrix of the monic polynomial with these coefficients, highest first.
    fn companion(coefficients: &[f64]) -> Matrix {
        let n = coefficients.len();
        Matrix::from_fn(n, n, |i, j| match (i, j) {
            (0, j) => -coefficients[j],
            (i, j) if i == j + 1 => 1.0,
            _ => 0.0,
        })
    }

    #[test]
    fn roots_of_known_polynomials_are_found() {
        // (s + 1)(s + 2)(s + 3)(s² + 2 s + 10)
        let values = sorted(&companion(&[8.0, 33.0, 88.0, 122.0, 60.0]));
        for (re, im) in [(-3.0, 0.0), (-2.0, 0.0), (-1.0, -3.0), (-1.0, 0.0), (-1.0, 3.0)] {
            let near = |v: &&(f64, f64)| (v.0 - re).hypot(v.1 - im) < 1e-10;
            assert_eq!(values.iter().filter(near).count(), 1, "{re} + {im}i: {values:?}");
        }
    }

    #[test]
    fn roots_of_unity_need_exceptional_shifts() {
        let values = sorted(&companion(&[0.0, 0.0, 0.0, 0.0, 0.0, -1.0]));
        for (re, im) in &values {
            assert!((re.hypot(*im) - 1.0).abs() < 1e-12, "{values:?}");
        }
        assert!((values[0].0 + 1.0).abs() < 1e-12 && (values[5].0 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn trace_and_determinant_of_a_full_matrix_are_kept() {
        let n = 24;
        let entry = |i: usize, j: usize| ((i * 7 + j * 13) % 19) as f64 / 19.0 - 0.4;
        let matrix = Matrix::from_fn(n, n, entry);
        let values = eigenvalues(&matrix).expect("convergence");
        let (trace, square) = (
            (0..n).map(|i| matrix[(i, i)]).sum::<f64>(),
            (0..n).map(|i| matrix.times(&matrix)[(i, i)]).sum::<f64>(),
        );
        let sum: f64 = values.iter().map(|v| v.0).sum();
        let squares: f64 = values.iter().map(|v| v.0 * v.0 - v.1 * v.1).sum();
        assert_eq!(values.len(), n);
        assert!((sum - trace).abs() < 1e-10 && (squares - square).abs() < 1e-9);
    }
}
