//! Small linear systems as straight-line formulas.

use shapebot_symbolic::{Graph, Id};

/// Solution of A x = b for a symmetric positive definite A by LDLᵀ. Rows are eliminated in the order
/// that keeps most zeros.
pub(crate) fn symmetric(graph: &mut Graph, a: &[Vec<Id>], b: &[Id]) -> Vec<Id> {
    let n = b.len();
    let mut a: Vec<Vec<Id>> = a.to_vec();
    let mut b = b.to_vec();
    let mut left: Vec<usize> = (0..n).collect();
    let mut steps: Vec<(usize, Vec<(usize, Id)>)> = Vec::new();
    while let Some(at) = sparsest(graph, &a, &left) {
        let p = left.remove(at);
        let rows: Vec<usize> = left.iter().copied().filter(|&i| !graph.is_zero(a[i][p])).collect();
        let factors: Vec<(usize, Id)> =
            rows.iter().map(|&i| (i, graph.div(a[i][p], a[p][p]))).collect();
        for (f, &(i, factor)) in factors.iter().enumerate() {
            for &(j, _) in &factors[..=f] {
                let change = graph.mul(factor, a[j][p]);
                let entry = graph.sub(a[i][j], change);
                a[i][j] = entry;
                a[j][i] = entry;
            }
            let change = graph.mul(factor, b[p]);
            b[i] = graph.sub(b[i], change);
        }
        steps.push((p, factors));
    }
    for (p, factors) in steps.into_iter().rev() {
        let mut x = graph.div(b[p], a[p][p]);
        for (i, factor) in factors {
            let part = graph.mul(factor, b[i]);
            x = graph.sub(x, part);
        }
        b[p] = x;
    }
    b
}

fn sparsest(graph: &Graph, a: &[Vec<Id>], left: &[usize]) -> Option<usize> {
    let degree = |&p: &usize| left.iter().filter(|&&i| !graph.is_zero(a[i][p])).count();
    (0..left.len()).min_by_key(|&k| degree(&left[k]))
}

/// Solutions of A X = B for several right-hand sides (columns of B, given as rows of `b`): by
/// Cramer's rule for one and two unknowns, by elimination else. `pivots` are values of A at a typical
/// point; they choose the order of elimination.
pub(crate) fn general(
    graph: &mut Graph,
    a: &[Vec<Id>],
    b: &[Vec<Id>],
    pivots: &[Vec<f64>],
) -> Vec<Vec<Id>> {
    match a.len() {
        1 => b.iter().map(|rhs| vec![graph.div(rhs[0], a[0][0])]).collect(),
        2 => {
            let det = minor(graph, (a[0][0], a[1][1]), (a[0][1], a[1][0]));
            let solve = |graph: &mut Graph, rhs: &Vec<Id>| {
                let x = minor(graph, (rhs[0], a[1][1]), (a[0][1], rhs[1]));
                let y = minor(graph, (a[0][0], rhs[1]), (rhs[0], a[1][0]));
                vec![graph.div(x, det), graph.div(y, det)]
            };
            b.iter().map(|rhs| solve(graph, rhs)).collect()
        }
        _ => eliminate(graph, a, b, pivots),
    }
}

/// p₀ p₁ − q₀ q₁.
fn minor(graph: &mut Graph, p: (Id, Id), q: (Id, Id)) -> Id {
    let left = graph.mul(p.0, p.1);
    let right = graph.mul(q.0, q.1);
    graph.sub(left, right)
}

fn eliminate(graph: &mut Graph, a: &[Vec<Id>], b: &[Vec<Id>], pivots: &[Vec<f64>]) -> Vec<Vec<Id>> {
    let n = a.len();
    let (mut a, mut values) = (a.to_vec(), pivots.to_vec());
    let mut b: Vec<Vec<Id>> = b.to_vec();
    for k in 0..n {
        let best =
            (k..n).max_by(|&i, &j| values[i][k].abs().total_cmp(&values[j][k].abs())).unwrap_or(k);
        a.swap(k, best);
        values.swap(k, best);
        for rhs in &mut b {
            rhs.swap(k, best);
        }
        for i in k + 1..n {
            if graph.is_zero(a[i][k]) {
                continue;
            }
            let factor = graph.div(a[i][k], a[k][k]);
            let number = values[i][k] / values[k][k];
            for j in k + 1..n {
                let change = graph.mul(factor, a[k][j]);
                a[i][j] = graph.sub(a[i][j], change);
                values[i][j] -= number * values[k][j];
            }
            for rhs in &mut b {
                let change = graph.mul(factor, rhs[k]);
                rhs[i] = graph.sub(rhs[i], change);
            }
        }
    }
    for rhs in &mut b {
        for k in (0..n).rev() {
            let mut x = rhs[k];
            for j in k + 1..n {
                let part = graph.mul(a[k][j], rhs[j]);
                x = graph.sub(x, part);
            }
            rhs[k] = graph.div(x, a[k][k]);
        }
    }
    b
}
