//! How the shape sets share the work, at the robot's sizes.

use crate::desired::shape_set;
use crate::error::{Outcome, Refusal};
use shapebot_dynamics::{Description, ShapeSet};
use shapebot_tasks::Said;

/// Contributions in the order of the robot's shape sets.
pub(crate) fn contributions(
    given: &[(Said<String>, f64)],
    robot: &Description,
) -> Outcome<Vec<f64>> {
    let mut contributions = vec![None; robot.shape_sets.len()];
    for (set, value) in given {
        let index = shape_set(set, robot)?;
        if contributions[index].replace(*value).is_some() {
            let message = format!("the weight of `{}` is given twice", set.value);
            return Err(Refusal::task(message).at(&set.place));
        }
    }
    Ok(contributions.into_iter().map(Option::unwrap_or_default).collect())
}

/// Everything from the one free set without an actuator if there is exactly one among several, else the
/// smallest shape. `held` are the constrained sets.
pub(crate) fn default_contributions(sets: &[ShapeSet], held: &[usize]) -> Option<Vec<f64>> {
    let mut unactuated = (0..sets.len()).filter(|&index| !sets[index].actuated);
    let lone = match (unactuated.next(), unactuated.next()) {
        (Some(lone), None) if sets.len() > 1 && !held.contains(&lone) => lone,
        _ => return None,
    };
    Some((0..sets.len()).map(|index| if index == lone { 1.0 } else { 0.0 }).collect())
}

#[cfg(test)]
mod tests {
    use super::{contributions, default_contributions};
    use shapebot_dynamics::{Description, ShapeSet};
    use shapebot_tasks::Said;

    const SETS: [ShapeSet; 2] = [
        ShapeSet { name: "alpha", first: 0, len: 2, actuated: true },
        ShapeSet { name: "phi", first: 2, len: 2, actuated: false },
    ];

    fn said(name: &str) -> Said<String> {
        Said { value: name.to_owned(), place: "t.toml:3:4: `shares`".to_owned() }
    }

    #[test]
    fn by_default_the_unactuated_set_does_it_all() {
        assert_eq!(default_contributions(&SETS, &[0]), Some(vec![0.0, 1.0]));
        assert_eq!(default_contributions(&SETS, &[1]), None);
        assert_eq!(default_contributions(&SETS[1..], &[]), None);
    }

    #[test]
    fn sets_without_a_weight_rest() {
        let given = [(said("phi"), 1.0)];
        assert_eq!(contributions(&given, &description()).unwrap(), [0.0, 1.0]);
    }

    #[test]
    fn unknown_and_repeated_sets_are_refused() {
        let pair = |name: &str| (said(name), 0.5);
        assert!(contributions(&[pair("phy")], &description()).is_err());
        assert!(contributions(&[pair("phi"), pair("phi")], &description()).is_err());
    }

    fn description() -> Description {
        Description {
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
