//! What a plan has to keep: limits of the shape and of the actuators.

use crate::desired::shape_set;
use crate::error::{Outcome, Refusal};
use crate::refusal::Unplanned;
use crate::{Forces, Samples};
use nalgebra::SVector;
use shapebot_dynamics::{Actuator, Description};
use shapebot_planner::{Error, Row, survey_within};
use shapebot_tasks::{Quantities, Said};

/// Bounds on the magnitude of the shape coordinates: those of sets without a limit at their range.
pub(crate) fn shape_limits<const NS: usize>(
    given: &[(Said<String>, Quantities)],
    robot: &Description,
) -> Outcome<Option<SVector<f64, NS>>> {
    if given.is_empty() {
        return Ok(None);
    }
    let coordinates = robot.shape_coordinates();
    let mut limits = SVector::from_fn(|i, _| {
        let range = coordinates.get(i).map_or(f64::MAX, |c| c.lower.abs().max(c.upper.abs()));
        range.min(f64::MAX)
    });
    for (said, Quantities { values, dimension }) in given {
        let set = &robot.shape_sets[shape_set(said, robot)?];
        let wrong = |message: String| Err(Refusal::task(message).at(&said.place));
        if values.len() != 1 && values.len() != set.len {
            return wrong(format!("expected one number or {}, found {}", set.len, values.len()));
        }
        for k in 0..set.len {
            let unit = coordinates.get(set.first + k).map_or("rad", |c| c.unit);
            if unit != dimension.unit() {
                return wrong(format!("expected {unit}, found {}", dimension.unit()));
            }
            limits[set.first + k] = values[k % values.len()];
        }
    }
    Ok(Some(limits))
}

/// Largest magnitude of each actuator's force: that of the task, else the declared one.
pub(crate) fn force_limits(
    given: &[(Said<String>, Quantities)],
    robot: &Description,
) -> Outcome<Vec<f64>> {
    let mut limits: Vec<f64> = robot.actuators.iter().map(|actuator| actuator.limit).collect();
    for (said, Quantities { values, dimension }) in given {
        let wrong = |message: String| Err(Refusal::task(message).at(&said.place));
        let meant = actuators(&said.value, robot.actuators);
        if meant.is_empty() {
            let known = robot.actuators.iter().map(|actuator| actuator.name);
            return Err(Refusal::unknown("actuator", &said.value, known).at(&said.place));
        }
        if values.len() != 1 && values.len() != meant.len() {
            return wrong(format!(
                "expected one number or {}, found {}",
                meant.len(),
                values.len()
            ));
        }
        for (k, &index) in meant.iter().enumerate() {
            let unit = robot.actuators[index].unit;
            if unit != dimension.unit() {
                return wrong(format!("expected {unit}, found {}", dimension.unit()));
            }
            limits[index] = values[k % values.len()];
        }
    }
    Ok(limits)
}

/// The actuator of a name, or those of a vector of actuators: `tau` for `tau_x` and `tau_y`.
fn actuators(name: &str, all: &[Actuator]) -> Vec<usize> {
    let of = |fits: &dyn Fn(&str) -> bool| -> Vec<usize> {
        all.iter().enumerate().filter(|(_, a)| fits(a.name)).map(|(index, _)| index).collect()
    };
    let single = of(&|other| other == name);
    let component = |other: &str| {
        other
            .strip_prefix(name)
            .and_then(|rest| rest.strip_prefix('_'))
            .is_some_and(|label| !label.is_empty() && !label.contains('_'))
    };
    if single.is_empty() { of(&component) } else { single }
}

/// Looks at the rows of a plan: the largest force of each actuator, or the limit that is exceeded.
pub(crate) type Survey<'s, const NX: usize, const NS: usize> =
    dyn Fn(&mut dyn Iterator<Item = Row<f64, NX, NS>>) -> Result<Vec<f64>, Error> + 's;

/// The survey of a robot with some limits.
pub(crate) fn survey<'s, const N: usize, const NX: usize, const NS: usize>(
    robot: &'s Description,
    limits: &'s [f64],
    forces: &'s Forces<'s, N, NX, NS>,
) -> Box<Survey<'s, NX, NS>> {
    Box::new(move |rows| {
        let report = survey_within(robot, limits.iter().copied(), rows, forces)?;
        Ok(report.peak.iter().take(robot.actuators.len()).copied().collect())
    })
}

/// Refuses rows that leave limits of the shape, at the largest excess.
pub(crate) fn check_shape<const NX: usize, const NS: usize>(
    rows: &Samples<NX, NS>,
    limits: &SVector<f64, NS>,
    robot: &Description,
) -> Result<(), Error> {
    let mut worst = (1.0 + 8.0 * f64::EPSILON, None);
    for row in rows {
        for (i, coordinate) in robot.shape_coordinates().iter().enumerate().take(NS) {
            let (value, limit) = (row.plan.shape[i], limits[i]);
            let excess = value.abs() / limit;
            if excess > worst.0 {
                worst = (excess, Some((coordinate, row.plan.time, value, limit)));
            }
        }
    }
    match worst.1 {
        None => Ok(()),
        Some((coordinate, time, value, limit)) => Err(Error::LimitExceeded {
            coordinate: coordinate.name,
            unit: coordinate.unit,
            time,
            value,
            lower: -limit,
            upper: limit,
            duration: None,
        }),
    }
}

/// Most durations that are tried.
const ATTEMPTS: usize = 12;

/// A refusal for a limit with a duration of the desired motion that would do: tried out, not guessed.
/// `attempt` plans with a multiple of the duration.
pub(crate) fn with_duration(
    refusal: Unplanned,
    duration: f64,
    mut attempt: impl FnMut(f64) -> Result<(), Unplanned>,
) -> Unplanned {
    let Some(error) = refusal.limit() else {
        return refusal;
    };
    let (mut factor, mut latest) = (1.0_f64, error);
    for _ in 0..ATTEMPTS {
        let Error::LimitExceeded { value, lower, upper, .. } = latest else {
            break;
        };
        let bound = if value > upper { upper } else { lower };
        // Accelerations go with the inverse square of the duration.
        let excess = (value / bound).sqrt();
        if !(excess.is_finite() && excess > 0.0) {
            break;
        }
        factor *= (excess * 1.01).clamp(1.02, 4.0);
        match attempt(factor) {
            Ok(()) => return Unplanned::Planner(lasting(error, duration * factor)),
            Err(next) => match next.limit() {
                Some(next) => latest = next,
                None => break,
            },
        }
    }
    Unplanned::Planner(error)
}

/// A refusal with the duration that would do.
fn lasting(error: Error, seconds: f64) -> Error {
    match error {
        Error::LimitExceeded { coordinate, unit, time, value, lower, upper, .. } => {
            let duration = Some(seconds);
            Error::LimitExceeded { coordinate, unit, time, value, lower, upper, duration }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::actuators;
    use shapebot_dynamics::Actuator;

    #[test]
    fn actuators_are_named_alone_or_as_a_vector() {
        let named = |name| Actuator { name, unit: "N m", limit: 1.0 };
        let all = ["tau_x", "tau_y", "tau_arm_x", "tau"].map(named);
        assert_eq!(actuators("tau_x", &all), [0]);
        assert_eq!(actuators("tau_arm", &all), [2]);
        assert_eq!(actuators("tau", &all), [3]);
        assert_eq!(actuators("tau", &all[..3]), [0, 1]);
        assert!(actuators("ta", &all).is_empty());
    }
}
