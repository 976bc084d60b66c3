//! The robust pick of gains.

use crate::closed_loop::{Law, Plant, poles};
use crate::gains::Gains;
use crate::linear_algebra::Matrix;
use crate::linearisation::Linearisation;
use crate::robot::Robot;

/// The control period, s.
pub(crate) const PERIOD: f64 = 0.002;

/// Delay beyond the first period that a design is made to bear, s.
const DELAY: f64 = 0.01;

/// Rate of servoed shape variables, rad/s, at most a tenth of the period's.
const SERVO_RATE: f64 = 12.0;
const SERVO_DAMPING: f64 = 0.9;
/// k_i of the servo in units of ω³.
const SERVO_INTEGRAL: f64 = 0.1;

/// Largest k_d p: noise of the rates.
const NOISE: f64 = 6.0;

/// Natural parameters of the gains: numbers near one, alike for robots of all sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Natural {
    /// ω/p and ζ of the balancing loop, k_i/p, ω τ and ζ of the outer loop, rate of the momentum
    /// observer in p, of the offset observer in 1/τ.
    pub(crate) values: [f64; 7],
}

pub(crate) const START: Natural = Natural { values: [1.9, 1.45, 0.18, 0.46, 0.44, 3.2, 0.35] };
const LOWER: [f64; 7] = [1.1, 0.7, 0.03, 0.1, 0.3, 0.8, 0.2];
const UPPER: [f64; 7] = [2.3, 1.8, 1.0, 1.2, 1.5, 4.0, 0.6];

impl Natural {
    /// The gains of a robot.
    pub(crate) fn gains(&self, robot: &Robot<'_>) -> Gains {
        let [inner, damping, integral, outer, outer_damping, observer, offset] = self.values;
        let lean = |s: &crate::robot::Scale| {
            let (p2, p) = (s.pole_squared, s.pole_squared.abs().sqrt());
            let omega = inner * p;
            [1.0 + omega * omega / p2, 2.0 * damping * omega / p2, integral * p * p2.signum()]
        };
        let position = |s: &crate::robot::Scale| {
            let omega = outer / s.time;
            [omega * omega, 2.0 * outer_damping * omega]
        };
        let rate = SERVO_RATE.min(0.1 / PERIOD);
        let slowest = robot.scales.iter().map(|s| s.pole_squared.abs().sqrt());
        let slowest = slowest.fold(f64::INFINITY, f64::min);
        let longest = robot.scales.iter().map(|s| s.time).fold(0.0, f64::max);
        Gains {
            period: PERIOD,
            lean: if robot.balancing { robot.scales.iter().map(lean).collect() } else { vec![] },
            outer: robot.scales.iter().map(position).collect(),
            servo: [rate, SERVO_DAMPING, SERVO_INTEGRAL * rate.powi(3)],
            observer_rate: if robot.observable {
                (observer * slowest).min(0.15 / PERIOD)
            } else {
                0.0
            },
            offset_rate: offset / longest,
        }
        .rounded()
    }
}

/// Slowest decay rate and smallest damping of a loop; decay is negative if it is unstable.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quality {
    pub(crate) decay: f64,
    pub(crate) damping: f64,
}

impl Quality {
    pub(crate) const BAD: Self = Self { decay: f64::NEG_INFINITY, damping: -1.0 };

    pub(crate) fn of(list: &[(f64, f64)]) -> Self {
        let decay = list.iter().map(|p| -p.0).fold(f64::INFINITY, f64::min);
        let damping = list.iter().map(|p| -p.0 / p.0.hypot(p.1).max(1e-12));
        Self { decay, damping: damping.fold(1.0, f64::min) }
    }

    pub(crate) fn worse(self, other: Self) -> Self {
        Self { decay: self.decay.min(other.decay), damping: self.damping.min(other.damping) }
    }
}

/// Quality of the loop that a law closes around a plant.
pub(crate) fn quality(law: &Law<'_>, plant: &Plant, delay: usize) -> Quality {
    poles(&law.around(plant, delay), PERIOD).map_or(Quality::BAD, |list| Quality::of(&list))
}

/// A small problem that stands for the robot: servoed shape locked, one axis if axes are decoupled.
#[derive(Debug)]
struct Case {
    model: Linearisation,
    axes: Vec<usize>,
    actuated: Vec<bool>,
    time: f64,
    /// The model's own values first.
    plants: Vec<(Plant, Linearisation)>,
}

/// The best gains found.
pub(crate) fn search(robot: &Robot<'_>, samples: &[Linearisation]) -> Natural {
    let cases = cases(robot, samples);
    let mut best = START;
    let mut score = rate(robot, &cases, &best);
    let mut steps = [0.25, 0.2, 0.1, 0.15, 0.15, 0.6, 0.1];
    let free: &[usize] = if robot.balancing { &[3, 4, 0, 1, 2, 5, 6] } else { &[3, 4, 6] };
    for _ in 0..ROUNDS {
        let before = score;
        for &i in free {
            for direction in [1.0, -1.0] {
                let mut next = best;
                next.values[i] = (best.values[i] + direction * steps[i]).clamp(LOWER[i], UPPER[i]);
                if next == best {
                    continue;
                }
                let found = rate(robot, &cases, &next);
                if found > score {
                    (best, score) = (next, found);
                    break;
                }
            }
        }
        if score <= before {
            steps = steps.map(|step| 0.5 * step);
        }
    }
    best
}

const ROUNDS: usize = 0;

/// Worst decay in natural time, less what is missing in damping.
fn rate(robot: &Robot<'_>, cases: &[Case], natural: &Natural) -> f64 {
    let [inner, damping, ..] = natural.values;
    if robot.balancing && 2.0 * damping * inner > NOISE {
        return f64::NEG_INFINITY;
    }
    let gains = natural.gains(robot);
    let late = 1 + (DELAY / PERIOD).round() as usize;
    let mut worst = f64::INFINITY;
    for case in cases {
        let pick = |list: &[[f64; 2]]| case.axes.iter().map(|&i| list[i]).collect();
        let lean = gains.lean.iter().enumerate().filter(|(i, _)| case.axes.contains(i));
        let own = Gains {
            lean: lean.map(|(_, g)| *g).collect(),
            outer: pick(&gains.outer),
            ..gains.clone()
        };
        let Some(law) = Law::new(&case.model, &own, &case.actuated) else {
            return f64::NEG_INFINITY;
        };
        for (k, (plant, sample)) in case.plants.iter().enumerate() {
            for delay in [1, late] {
                let closed = law.disturbed(plant, delay);
                let c = cost(closed, sample, case.time);
                worst = worst.min(-c);
            }
        }
    }
    worst
}

/// Mean squared deviation of output and lean after one unit of position error, of force and of offset,
/// in natural units: how far and how long.
fn cost(closed: Matrix, sample: &Linearisation, time: f64) -> f64 {
    let (n, n_x) = (sample.len(), sample.position_count());
    let size = closed.rows;
    let states = size - n;
    let mut output = Matrix::zeros(2 * n_x, size);
    for i in 0..n_x {
        output[(i, i)] = 1.0;
        for j in 0..n - n_x {
            output[(i, n_x + j)] = sample.output_shape[(i, j)];
            output[(n_x + i, n_x + j)] = EFFORT * time * time * sample.shape_gain[(i, j)];
        }
    }
    let mut sum = output.transpose().times(&output);
    let mut power = closed;
    for _ in 0..DOUBLINGS {
        let next = power.transpose().times(&sum).times(&power);
        sum = sum.plus(&next);
        power = power.times(&power);
        if !(sum.largest() < 1e12) {
            return f64::INFINITY;
        }
    }
    let scale = time * time;
    let mut total = 0.0;
    for i in 0..n_x {
        total += sum[(i, i)];
        total += FORCE * sum[(states + i, states + i)] / (scale * scale);
    }
    for j in 0..n - n_x {
        total += OFFSET * sum[(states + n_x + j, states + n_x + j)] / (scale * scale);
    }
    total * PERIOD / time
}

const EFFORT: f64 = 0.7;
const FORCE: f64 = 1.0;
const OFFSET: f64 = 0.1;
const DOUBLINGS: usize = 13;

fn cases(robot: &Robot<'_>, samples: &[Linearisation]) -> Vec<Case> {
    let n_x = robot.model.position_count();
    let groups: Vec<Vec<usize>> = if robot.decoupled {
        (0..n_x).map(|i| vec![i]).collect()
    } else {
        vec![(0..n_x).collect()]
    };
    let mut cases = Vec::new();
    let mut seen: Vec<crate::robot::Scale> = Vec::new();
    for axes in groups {
        let scale = robot.scales[axes[0]];
        // Axes that are nearly alike need one look.
        let alike = |other: &crate::robot::Scale| (other.time / scale.time - 1.0).abs() < 0.02;
        if seen.iter().any(alike) {
            continue;
        }
        seen.push(scale);
        let part = |model: &Linearisation| robot.core(model).restricted(&axes, &axes);
        let actuated: Vec<bool> =
            (0..2 * axes.len()).map(|i| (i < axes.len()) == robot.balancing).collect();
        let plants = std::iter::once(&robot.model)
            .chain(samples)
            .filter_map(|sample| {
                let sample = part(sample);
                Some((Plant::new(&sample, &actuated, PERIOD)?, sample))
            })
            .collect();
        cases.push(Case { model: part(&robot.model), axes, actuated, time: scale.time, plants });
    }
    cases
}
