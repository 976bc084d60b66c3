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
pub(crate) const SERVO_RATE: f64 = 12.0;
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

/// Where the search begins, and how far it goes.
struct Bounds {
    start: Natural,
    lower: [f64; 7],
    upper: [f64; 7],
}

/// With a balancing loop. A faster offset observer would hand on the noise of gyros through N q̇_s; a
/// momentum observer slower than thrice the fall leaves friction to the lean.
const BALANCING: Bounds = Bounds {
    start: Natural { values: [1.9, 1.45, 0.18, 0.5, 0.44, 3.2, 0.18] },
    lower: [1.1, 0.7, 0.03, 0.1, 0.3, 3.0, 0.18],
    upper: [2.3, 1.8, 1.0, 1.2, 1.5, 4.0, 0.18],
};

/// Without.
const SERVOED: Bounds = Bounds {
    start: Natural { values: [1.9, 1.45, 0.18, 0.67, 0.8, 3.2, 0.4] },
    lower: [1.9, 1.45, 0.18, 0.1, 0.3, 3.2, 0.18],
    upper: [1.9, 1.45, 0.18, 1.2, 1.5, 3.2, 0.6],
};

/// Shares of the parameters' values for each parameter alone, and for all together.
const ALONE: f64 = 0.2;
const TOGETHER: f64 = 0.1;

/// Corners of the box of all parameters.
const CORNERS: usize = 24;

/// How often the parameter values that are looked at are chosen anew, and how many are added.
const CUTS: usize = 2;
const LOOKED_AT: usize = 3;

/// Rounds of the search.
const ROUNDS: usize = 10;

/// Damping and decay (in natural time) that are aimed at: at the model's own values, the same with
/// delay, and over the ranges.
const WANTED: [[f64; 2]; 3] = [[0.45, 0.1], [0.25, 0.05], [0.12, 0.05]];

/// Price of what is missing.
const PENALTY: f64 = 100.0;

/// Cost of what is unstable.
const UNSTABLE: f64 = 1e3;

/// Weights of lean, of a constant force and of an offset beside a position error.
const EFFORT: f64 = 0.4;
const FORCE: f64 = 10.0;
const OFFSET: f64 = 0.1;

/// Squarings of the loop's map: 2¹³ periods.
const DOUBLINGS: usize = 13;

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
    own: Plant,
    /// At other parameter values: all of them, and the indices of those that are looked at.
    others: Vec<Plant>,
    critical: Vec<usize>,
}

/// The best gains found.
pub(crate) fn search(robot: &Robot<'_>) -> Natural {
    let mut samples = robot.samples(ALONE, 0, true);
    samples.extend(robot.samples(TOGETHER, CORNERS, false));
    let mut cases = cases(robot, &samples);
    let bounds = if robot.balancing { BALANCING } else { SERVOED };
    let mut best = bounds.start;
    for _ in 0..CUTS {
        for case in &mut cases {
            case.look_at_worst(robot, &best);
        }
        best = compass(robot, &cases, best, &bounds);
    }
    best
}

/// Moves one natural parameter at a time, by steps that halve where nothing improves.
fn compass(robot: &Robot<'_>, cases: &[Case], start: Natural, bounds: &Bounds) -> Natural {
    let mut best = start;
    let mut score = rate(robot, cases, &best);
    let mut steps = [0.2, 0.2, 0.1, 0.1, 0.1, 0.6, 0.1];
    // What matters most goes first; without an observer its rate is no matter.
    let order = [3, 4, 0, 1, 2, 5, 6];
    let free = |i: &usize| bounds.lower[*i] < bounds.upper[*i] && (*i != 5 || robot.observable);
    for _ in 0..ROUNDS {
        let before = score;
        for i in order.into_iter().filter(free) {
            for direction in [1.0, -1.0] {
                let mut next = best;
                next.values[i] =
                    (best.values[i] + direction * steps[i]).clamp(bounds.lower[i], bounds.upper[i]);
                if next == best {
                    continue;
                }
                let found = rate(robot, cases, &next);
                if found < score {
                    (best, score) = (next, found);
                    break;
                }
            }
        }
        if score >= before {
            steps = steps.map(|step| 0.5 * step);
        }
    }
    best
}

/// Mean squared deviations, and what is missing in damping and decay. Lower is better.
fn rate(robot: &Robot<'_>, cases: &[Case], natural: &Natural) -> f64 {
    let [inner, damping, ..] = natural.values;
    if robot.balancing && 2.0 * damping * inner > NOISE {
        return f64::INFINITY;
    }
    let gains = natural.gains(robot);
    let mut total = 0.0;
    for case in cases {
        let own = case.gains(&gains);
        let Some(law) = Law::new(&case.model, &own, &case.actuated) else { return f64::INFINITY };
        let now = quality(&law, &case.own, 1);
        let late = quality(&law, &case.own, 1 + (DELAY / PERIOD).round() as usize);
        let other = case.critical.iter().map(|&i| quality(&law, &case.others[i], 3));
        let other = other.fold(now, Quality::worse);
        let lacking = [now, late, other].into_iter().zip(WANTED).map(|(q, [damping, decay])| {
            (damping - q.damping).max(0.0) + (decay - q.decay * case.time).max(0.0)
        });
        let lacking: f64 = lacking.sum();
        let cost = if now.decay > 0.0 { case.cost(&law) } else { UNSTABLE };
        total += cost.min(UNSTABLE) + PENALTY * lacking;
    }
    total
}

impl Case {
    /// The gains of its axes.
    fn gains(&self, gains: &Gains) -> Gains {
        let lean = gains.lean.iter().enumerate().filter(|(i, _)| self.axes.contains(i));
        Gains {
            lean: lean.map(|(_, g)| *g).collect(),
            outer: self.axes.iter().map(|&i| gains.outer[i]).collect(),
            ..gains.clone()
        }
    }

    /// Adds the worst of the other parameter values to those that are looked at.
    fn look_at_worst(&mut self, robot: &Robot<'_>, natural: &Natural) {
        let own = self.gains(&natural.gains(robot));
        let Some(law) = Law::new(&self.model, &own, &self.actuated) else { return };
        let damping = |(i, plant)| (quality(&law, plant, 1).damping, i);
        let mut list: Vec<(f64, usize)> = self.others.iter().enumerate().map(damping).collect();
        list.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, i) in list.into_iter().take(LOOKED_AT) {
            if !self.critical.contains(&i) {
                self.critical.push(i);
            }
        }
    }

    /// Squared deviation of output and lean over time after one unit of position error, of force and of
    /// offset, in natural units: how far and how long.
    fn cost(&self, law: &Law<'_>) -> f64 {
        let model = &self.model;
        let closed = law.disturbed(&self.own, 1);
        let (n, n_x) = (model.len(), model.position_count());
        let size = closed.rows;
        let states = size - n;
        let mut output = Matrix::zeros(2 * n_x, size);
        let square = self.time * self.time;
        for i in 0..n_x {
            output[(i, i)] = 1.0;
            for j in 0..n - n_x {
                output[(i, n_x + j)] = model.output_shape[(i, j)];
                output[(n_x + i, n_x + j)] = EFFORT * square * model.shape_gain[(i, j)];
            }
        }
        let mut sum = output.transpose().times(&output);
        let mut power = closed;
        for _ in 0..DOUBLINGS {
            sum = sum.plus(&power.transpose().times(&sum).times(&power));
            power = power.times(&power);
        }
        let mut total = 0.0;
        for i in 0..n_x {
            total += sum[(i, i)];
            total += FORCE * sum[(states + i, states + i)] / (square * square);
        }
        for j in states + n_x..states + n {
            total += OFFSET * sum[(j, j)] / (square * square);
        }
        total * PERIOD / self.time
    }
}

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
        let plant = |sample: &Linearisation| Plant::new(&part(sample), &actuated, PERIOD);
        let others = samples.iter().filter_map(plant).collect();
        let Some(own) = plant(&robot.model) else { continue };
        cases.push(Case {
            model: part(&robot.model),
            axes,
            own,
            others,
            critical: Vec::new(),
            actuated: actuated.clone(),
            time: scale.time,
        });
    }
    cases
}
