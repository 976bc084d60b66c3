//! Where falls begin.

use crate::Error;
use crate::scenario::leaning;
use crate::trials::Trials;
use nalgebra::{SVector, Vector3};
use shapebot_dynamics::Description;
use shapebot_sim::{Onset, Push, Scenario, onset};

/// Where one disturbance, alone, begins to make the robot fall.
#[derive(Clone, Debug, PartialEq)]
pub struct OnsetOf {
    /// What is disturbed.
    pub what: String,
    /// Of its size.
    pub unit: &'static str,
    /// The largest size tried that the robot stood.
    pub stands: f64,
    /// The smallest size tried that made it fall; none up to `stands`.
    pub falls: Option<f64>,
}

/// Relative width of the gap that is left.
const PRECISION: f64 = 0.03;

#[derive(Clone, Copy)]
enum Kind {
    Delay,
    Mass,
    Push,
    Bias,
}

/// A disturbance: what it is called, its unit, the first size that is tried, and the last.
pub(crate) struct Trial {
    kind: Kind,
    what: String,
    unit: &'static str,
    range: [f64; 2],
    /// From the size that is tried to the one that is told.
    told: fn(f64) -> f64,
}

impl<const N: usize, const NX: usize, const NS: usize> Trials<'_, N, NX, NS> {
    /// What is tried.
    pub(crate) fn disturbances(&self) -> Vec<Trial> {
        let scale = &self.loops.scale;
        let robot = self.loops.subject.model.description();
        let mut trials = vec![Trial {
            kind: Kind::Delay,
            what: "delay of the actuators".into(),
            unit: "ms",
            range: [0.01 * scale.time, 2.0 * scale.time],
            told: |seconds| 1e3 * seconds,
        }];
        if let Some((name, value, upper)) = heaviest(robot) {
            trials.push(Trial {
                kind: Kind::Mass,
                what: format!("{name}, times the model's own"),
                unit: "",
                range: [0.1, (upper / value - 1.0).min(9.0)],
                told: |more| 1.0 + more,
            });
        }
        if !robot.points.is_empty() {
            let impulse = scale.inertia * scale.length / scale.time;
            trials.push(Trial {
                kind: Kind::Push,
                what: format!("push at `{}`", robot.points[self.highest()]),
                unit: "N·s",
                range: [0.02 * impulse, 20.0 * impulse],
                told: |impulse| impulse,
            });
        }
        trials.push(Trial {
            kind: Kind::Bias,
            what: "bias of the measured lean".into(),
            unit: "deg",
            range: [0.25_f64.to_radians(), 30_f64.to_radians()],
            told: f64::to_degrees,
        });
        trials
    }

    /// Where one begins to make the robot fall.
    pub(crate) fn onset(&self, trial: &Trial) -> Result<OnsetOf, Error> {
        let mut refused = None;
        let [first, limit] = trial.range;
        let Onset { stands, falls } = onset(first, limit, PRECISION, |size| {
            if refused.is_some() {
                return true;
            }
            self.falls(trial.kind, size).unwrap_or_else(|error| {
                refused = Some(error);
                true
            })
        });
        if let Some(error) = refused {
            return Err(error);
        }
        Ok(OnsetOf {
            what: trial.what.clone(),
            unit: trial.unit,
            stands: (trial.told)(stands),
            falls: falls.map(trial.told),
        })
    }

    fn falls(&self, kind: Kind, size: f64) -> Result<bool, Error> {
        let robot = self.loops.subject.model.description();
        let mut scenario: Scenario<NX, NS> = self.base.clone();
        let mut set = Vec::new();
        match kind {
            Kind::Delay => scenario.actuation_delay += size,
            Kind::Mass => {
                set.extend(heaviest(robot).map(|(name, value, _)| (name, value * (1.0 + size))));
            }
            Kind::Push => scenario.pushes.push(Push {
                point: self.highest(),
                force: Vector3::x() * (size / PUSHED),
                start: 0.5 * self.loops.duration(),
                duration: PUSHED,
            }),
            Kind::Bias => {
                if let Some(&index) = leaning(robot).first() {
                    scenario.sensors.lean_bias[index] += size;
                }
            }
        }
        let plant = self.loops.plant(&set)?;
        Ok(self.loops.run(&*plant, &scenario, None)?.fell.is_some())
    }

    /// The highest point at the origin.
    fn highest(&self) -> usize {
        let model = self.loops.subject.model;
        let height = |point: usize| model.point_position(&SVector::zeros(), point)[2];
        let points = 0..model.description().points.len();
        points.max_by(|&a, &b| height(a).total_cmp(&height(b))).unwrap_or_default()
    }
}

/// How long a push lasts, s.
const PUSHED: f64 = 0.1;

/// The heaviest mass with its upper bound.
fn heaviest(robot: &Description) -> Option<(&'static str, f64, f64)> {
    let masses = robot.parameters.iter().filter(|p| p.unit == "kg" && p.value > 0.0);
    let heaviest = masses.max_by(|a, b| a.value.total_cmp(&b.value))?;
    (heaviest.upper > 1.1 * heaviest.value).then_some((
        heaviest.name,
        heaviest.value,
        heaviest.upper,
    ))
}
