//! Poles and zeros at the origin, at the model's parameter values, without friction.

use super::certificate::{Linearisation, Root, ShapeMap};
use super::linear::{definite_eigenvalues, eigenvalues, sorted};
use super::problem::Problem;
use super::shape_map::time_constants;
use shapebot_symbolic::Id;

/// Eigenvalues below this part of the largest are zero up to rounding.
const ROUNDING: f64 = 1e-10;

/// `None` if the origin is no regular point or the mass matrix is not positive definite there.
pub(super) fn examine(problem: &mut Problem<'_>, map: Option<&ShapeMap>) -> Option<Linearisation> {
    let n = problem.len();
    let stiffness: Vec<Vec<Id>> = (0..n)
        .map(|i| {
            let force = problem.equations.gravity[i];
            (0..n).map(|j| problem.by_q(j, force)).collect()
        })
        .collect();
    let stiffness = problem.matrix_at_origin(&stiffness);
    let mass = problem.matrix_at_origin(&problem.equations.mass.clone());
    if problem.graph.singular().is_some() {
        return None;
    }
    let (k, m) = (problem.numeric(&stiffness), problem.numeric(&mass));
    let poles = poles(&k, &m)?;
    let n_x = problem.n_x();
    let minor = |a: &[Vec<f64>]| a[n_x..].iter().map(|row| row[n_x..].to_vec()).collect();
    let locked_poles = poles_of_minor(&minor(&k), &minor(&m));
    let (through, [time_constants, output_time_constants]) =
        map.map(|map| response(problem, map)).unwrap_or_default();
    Some(Linearisation {
        poles,
        locked_poles,
        zeros: zeros(&time_constants),
        time_constants,
        through: through.into_iter().map(|i| problem.name(i)).collect(),
        output_zeros: zeros(&output_time_constants),
        output_time_constants,
    })
}

fn poles_of_minor(k: &Vec<Vec<f64>>, m: &Vec<Vec<f64>>) -> Vec<Root> {
    if k.is_empty() { Vec::new() } else { poles(k, m).unwrap_or_default() }
}

/// Roots of det(M s² + K): s² = −λ with K x = λ M x, M symmetric positive definite and K symmetric.
fn poles(k: &Vec<Vec<f64>>, m: &Vec<Vec<f64>>) -> Option<Vec<Root>> {
    let values = definite_eigenvalues(k, m)?;
    let largest = values.iter().fold(0.0_f64, |l, v| l.max(v.abs()));
    let pair = |&value: &f64| {
        let size = value.abs().sqrt();
        if value.abs() <= ROUNDING * largest {
            [Root { re: 0.0, im: 0.0 }; 2]
        } else if value < 0.0 {
            [-size, size].map(|re| Root { re, im: 0.0 })
        } else {
            [-size, size].map(|im| Root { re: 0.0, im })
        }
    };
    Some(sorted(values.iter().flat_map(pair).collect()))
}

/// τ² through the unactuated shape variables; through all of them if the unactuated rows are none of
/// the shape's (a maze) or do not reach every acceleration alone.
fn response(problem: &mut Problem<'_>, map: &ShapeMap) -> (Vec<usize>, [Vec<Vec<f64>>; 2]) {
    let n_x = problem.n_x();
    let balancing: Vec<usize> = problem.unactuated.iter().copied().filter(|&u| u >= n_x).collect();
    let all: Vec<usize> = (n_x..problem.len()).collect();
    for through in [balancing, all] {
        if through.len() < n_x {
            continue;
        }
        if let Some(constants) = time_constants(problem, &map.gain, &through) {
            return (through, constants);
        }
    }
    Default::default()
}

/// Roots of det(1 − τ² s²): ±1/√μ for every nonzero eigenvalue μ of τ².
fn zeros(time_constants: &Vec<Vec<f64>>) -> Vec<Root> {
    if time_constants.is_empty() {
        return Vec::new();
    }
    let values = eigenvalues(time_constants);
    let size = |r: &Root| r.re.hypot(r.im);
    let largest = values.iter().map(size).fold(0.0, f64::max);
    let roots =
        values.iter().filter(|r| size(r) > ROUNDING * largest.max(ROUNDING)).flat_map(|r| {
            // s = ±μ^(−1/2), principal branch.
            let modulus = 1.0 / size(r).sqrt();
            let angle = -0.5 * r.im.atan2(r.re);
            let re = if r.im == 0.0 && r.re < 0.0 { 0.0 } else { modulus * angle.cos() };
            let im = if r.im == 0.0 && r.re > 0.0 { 0.0 } else { modulus * angle.sin() };
            [Root { re, im }, Root { re: 0.0 - re, im: 0.0 - im }]
        });
    sorted(roots.collect())
}
