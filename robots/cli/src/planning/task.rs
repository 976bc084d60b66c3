//! What is to be planned.

use crate::failure::{Failure, Outcome};
use shapebot_dynamics::{Description, ShapeSet};
use shapebot_planner::Objective;

/// Path of the desired motion in output space.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Path {
    /// From the origin along a line, timed by a polynomial.
    Line {
        /// Where to.
        goal: Vec<f64>,
        /// Degree of the polynomial.
        degree: usize,
    },
    /// A Bézier curve.
    Bezier {
        /// Its control points.
        points: Vec<Vec<f64>>,
    },
}

/// What is to be planned.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlanTask {
    /// Where the output goes.
    pub(crate) path: Path,
    /// Seconds.
    pub(crate) duration: f64,
    /// Number of samples.
    pub(crate) samples: usize,
    /// Contributions of shape sets by name; empty for the default.
    pub(crate) weights: Vec<(String, f64)>,
    /// What is minimised.
    pub(crate) objective: Objective,
}

impl PlanTask {
    /// Contributions in the order of the robot's shape sets. Without weights: everything from the one
    /// set without an actuator if there is exactly one among several, else the smallest shape.
    pub(crate) fn contributions(&self, robot: &Description) -> Outcome<Option<Vec<f64>>> {
        if self.weights.is_empty() {
            return Ok(default_contributions(robot.shape_sets));
        }
        let mut contributions = vec![None; robot.shape_sets.len()];
        for (name, value) in &self.weights {
            let Some(i) = robot.shape_sets.iter().position(|set| set.name == name) else {
                return Err(Failure::unknown(
                    "shape set",
                    name,
                    robot.shape_sets.iter().map(|s| s.name),
                ));
            };
            if contributions[i].replace(*value).is_some() {
                return Err(Failure::usage(format!("the weight of `{name}` is given twice")));
            }
        }
        Ok(Some(contributions.into_iter().map(Option::unwrap_or_default).collect()))
    }
}

fn default_contributions(sets: &[ShapeSet]) -> Option<Vec<f64>> {
    let lone = sets.len() > 1 && sets.iter().filter(|set| !set.actuated).count() == 1;
    lone.then(|| sets.iter().map(|set| if set.actuated { 0.0 } else { 1.0 }).collect())
}

#[cfg(test)]
mod tests {
    use super::{Path, PlanTask, default_contributions};
    use shapebot_dynamics::ShapeSet;
    use shapebot_planner::Objective;

    const SETS: [ShapeSet; 2] = [
        ShapeSet { name: "alpha", first: 0, len: 2, actuated: true },
        ShapeSet { name: "phi", first: 2, len: 2, actuated: false },
    ];

    #[test]
    fn by_default_the_unactuated_set_does_it_all() {
        assert_eq!(default_contributions(&SETS), Some(vec![0.0, 1.0]));
        assert_eq!(default_contributions(&SETS[1..]), None);
    }

    #[test]
    fn sets_without_a_weight_rest() {
        let weights = vec![("phi".to_owned(), 1.0)];
        let task = task(weights);
        assert_eq!(task.contributions(&description()).unwrap(), Some(vec![0.0, 1.0]));
    }

    #[test]
    fn unknown_and_repeated_sets_are_refused() {
        let pair = |name: &str| (name.to_owned(), 0.5);
        assert!(task(vec![pair("phy")]).contributions(&description()).is_err());
        assert!(task(vec![pair("phi"), pair("phi")]).contributions(&description()).is_err());
    }

    fn task(weights: Vec<(String, f64)>) -> PlanTask {
        let path = Path::Line { goal: vec![1.0], degree: 9 };
        PlanTask { path, duration: 1.0, samples: 10, weights, objective: Objective::Output }
    }

    fn description() -> shapebot_dynamics::Description {
        shapebot_dynamics::Description {
            name: "r",
            summary: "",
            coordinates: &[],
            position_count: 0,
            shape_sets: &SETS,
            actuators: &[],
            parameters: &[],
            outputs: &[],
            output_unit: "m",
            frames: &[],
            points: &[],
            geometry: &[],
            friction: &[],
        }
    }
}
