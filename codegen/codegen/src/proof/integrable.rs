//! Integrability of the dynamic constraint (Eqs. 6 and 7) by the conditions of Oriolo and Nakamura (1991).
//!
//! An unactuated equation is *partially* integrable, that is, equivalent to one on q and q̇, if and only
//! if its gravity term is constant and its coordinate does not enter the mass matrix. If that holds for
//! all of them, they are *completely* integrable if and only if the distribution M_u(q) q̇ = 0 is
//! involutive as well. Both are decided exactly. Combinations of several equations with coefficients
//! that depend on the configuration are not looked at.

use super::certificate::{Integrability, RowIntegrability};
use super::problem::{Problem, determinant, index};
use shapebot_symbolic::{Id, Symbol};

pub(super) fn examine(problem: &mut Problem<'_>) -> Integrability {
    let equations = problem.equations;
    let n = problem.len();
    let mut rows = Vec::new();
    for u in problem.unactuated.clone() {
        let force = equations.gravity[u];
        let gravity_constant =
            (0..n).all(|j| !problem.depends(force, Symbol::Coordinate(index(j))));
        let own = Symbol::Coordinate(index(u));
        let inertia_free =
            (0..n).all(|i| (i..n).all(|j| !problem.depends(equations.mass[i][j], own)));
        rows.push(RowIntegrability { coordinate: problem.name(u), gravity_constant, inertia_free });
    }
    let all = !rows.is_empty() && rows.iter().all(RowIntegrability::partially_integrable);
    let involutive = all.then(|| involutive(problem));
    Integrability { rows, involutive }
}

/// Frobenius: the forms ω_u = M_u dq satisfy dω_u(v, w) = 0 for all v, w that they annihilate.
fn involutive(problem: &mut Problem<'_>) -> bool {
    let rows = problem.unactuated.clone();
    let kernel = kernel(problem, &rows);
    for &u in &rows {
        for a in 0..kernel.len() {
            for b in 0..a {
                let curvature = curvature(problem, u, &kernel[a], &kernel[b]);
                if !problem.graph.is_zero(curvature) {
                    return false;
                }
            }
        }
    }
    true
}

/// Σ_ij (∂M_uj/∂q_i − ∂M_ui/∂q_j) v_i w_j.
fn curvature(problem: &mut Problem<'_>, u: usize, v: &[Id], w: &[Id]) -> Id {
    let mut sum = problem.graph.zero();
    let mass = &problem.equations.mass[u];
    for i in 0..mass.len() {
        for j in 0..mass.len() {
            if problem.graph.is_zero(v[i]) || problem.graph.is_zero(w[j]) {
                continue;
            }
            let (left, right) = (problem.by_q(i, mass[j]), problem.by_q(j, mass[i]));
            let graph = &mut problem.graph;
            let turn = graph.sub(left, right);
            let area = graph.mul(v[i], w[j]);
            let part = graph.mul(turn, area);
            sum = graph.add(sum, part);
        }
    }
    sum
}

/// Vectors annihilated by the rows of M, by Cramer's rule: det(M_uu) e_a − Σ … e_u.
fn kernel(problem: &mut Problem<'_>, rows: &[usize]) -> Vec<Vec<Id>> {
    let block = problem.mass(rows, rows);
    let det = determinant(&mut problem.graph, &block);
    let others: Vec<usize> = (0..problem.len()).filter(|i| !rows.contains(i)).collect();
    let mut vectors = Vec::new();
    for &a in &others {
        let mut vector = vec![problem.graph.zero(); problem.len()];
        vector[a] = det;
        for (k, &u) in rows.iter().enumerate() {
            let mut replaced = block.clone();
            for (r, &row) in rows.iter().enumerate() {
                replaced[r][k] = problem.equations.mass[row][a];
            }
            let minor = determinant(&mut problem.graph, &replaced);
            vector[u] = problem.graph.neg(minor);
        }
        vectors.push(vector);
    }
    vectors
}
