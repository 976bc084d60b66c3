//! Energy of the free system over time.

use crate::states::{Numbers, interval};
use shapebot_dynamics::Robot;
use shapebot_dynamics::nalgebra::SVector;

/// Duration of the free motion, seconds: short enough that a falling robot stays in one piece.
const DURATION: f64 = 0.4;

/// Integrates the free motion from a random start with the classical Runge-Kutta method of fourth
/// order. The drift of T + V must vanish with the fourth power of the step, and be small.
///
/// # Panics
///
/// If not.
pub fn energy_is_conserved<const N: usize, const NX: usize, const NS: usize>(
    label: &str,
    robot: &impl Robot<f64, N, NX, NS>,
) {
    let mut numbers = Numbers::new(7);
    let intervals = robot.description().coordinates.iter().map(interval);
    let q: Vec<f64> = intervals.map(|(a, b)| numbers.between(a, b) * 0.5).collect();
    let start = (SVector::from_column_slice(&q), numbers.vector(-0.5, 0.5));
    let drift = |steps| drift(robot, start, steps);
    let [coarse, middle, fine] = [drift(100), drift(200), drift(1600)];
    // Sixteen times less with half the step, but for the end of the doubles.
    let order = middle < coarse / 12.0 || middle < 1e-12;
    assert!(order, "{label}: drift {coarse:e}, {middle:e} with half the step");
    assert!(fine < 1e-9, "{label}: drift {fine:e} with fine steps");
}

/// The largest relative change of the energy.
fn drift<const N: usize, const NX: usize, const NS: usize>(
    robot: &impl Robot<f64, N, NX, NS>,
    (mut q, mut qd): (SVector<f64, N>, SVector<f64, N>),
    steps: usize,
) -> f64 {
    let h = DURATION / steps as f64;
    let free = SVector::zeros();
    let energy = |q: &SVector<f64, N>, qd: &SVector<f64, N>| {
        robot.kinetic_energy(q, qd) + robot.potential_energy(q)
    };
    let acceleration =
        |q: &SVector<f64, N>, qd: &SVector<f64, N>| robot.forward_dynamics(q, qd, &free);
    let start = energy(&q, &qd);
    let mut scale = robot.kinetic_energy(&q, &qd);
    let mut largest: f64 = 0.0;
    for _ in 0..steps {
        let a1 = acceleration(&q, &qd);
        let (q2, v2) = (q + qd * (h / 2.0), qd + a1 * (h / 2.0));
        let a2 = acceleration(&q2, &v2);
        let (q3, v3) = (q + v2 * (h / 2.0), qd + a2 * (h / 2.0));
        let a3 = acceleration(&q3, &v3);
        let (q4, v4) = (q + v3 * h, qd + a3 * h);
        let a4 = acceleration(&q4, &v4);
        q += (qd + v2 * 2.0 + v3 * 2.0 + v4) * (h / 6.0);
        qd += (a1 + a2 * 2.0 + a3 * 2.0 + a4) * (h / 6.0);
        scale = scale.max(robot.kinetic_energy(&q, &qd));
        let change = (energy(&q, &qd) - start).abs();
        largest = if change.is_nan() { f64::NAN } else { largest.max(change) };
    }
    largest / scale
}
