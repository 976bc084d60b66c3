//! Why there is no plan, in the user's words and at the place of the task that is to blame.

use crate::error::Refusal;
use crate::number;
use shapebot_planner::Error;
use shapebot_tasks::Task;

/// Why there is no plan.
#[derive(Debug)]
pub(crate) enum Unplanned {
    /// The planner says so.
    Planner(Error),
    /// This side of it does.
    Said(Refusal),
}

impl From<Error> for Unplanned {
    fn from(error: Error) -> Self {
        Self::Planner(error)
    }
}

impl From<Refusal> for Unplanned {
    fn from(failure: Refusal) -> Self {
        Self::Said(failure)
    }
}

impl Unplanned {
    /// The error of a plan that leaves a limit or a range, which a longer motion may mend.
    pub(crate) fn limit(&self) -> Option<Error> {
        match *self {
            Self::Planner(error @ Error::LimitExceeded { .. }) => Some(error),
            Self::Planner(Error::OutOfRange { coordinate, unit, time, value, lower, upper }) => {
                let duration = None;
                Some(Error::LimitExceeded { coordinate, unit, time, value, lower, upper, duration })
            }
            _ => None,
        }
    }

    /// What the user is told. `shares` is where the shares of the phase are given.
    pub(crate) fn failure(self, task: &Task, shares: &str) -> Refusal {
        match self {
            Self::Planner(error) => {
                // What was not said follows from the rest.
                let constraint = task.constraints.first().map_or("", |c| &c.set.place);
                let places = [constraint, task.motion.place.as_str()];
                let place = place(&error, task, shares).map(|place| {
                    let said = std::iter::once(place).chain(places);
                    said.into_iter().find(|place| !place.is_empty()).unwrap_or_default()
                });
                failure(error).at(place.unwrap_or_default())
            }
            Self::Said(failure) => failure,
        }
    }
}

/// Where a task says what an error is about.
fn place<'t>(error: &Error, task: &'t Task, shares: &'t str) -> Option<&'t str> {
    match error {
        Error::Invalid { field, .. }
        | Error::InvalidEntry { field, .. }
        | Error::Length { field, .. } => match *field {
            "samples" => Some(&task.samples.place),
            "contributions" | "sum of the contributions" | "number of kinds of free shape sets" => {
                Some(shares)
            }
            field if field.contains("standing") => Some(&task.standing.place),
            "shape set" | "coordinates of a constrained shape set" => {
                task.constraints.first().map(|constraint| constraint.set.place.as_str())
            }
            "limits" => task.limits.first().map(|(said, _)| said.place.as_str()),
            _ => Some(&task.motion.place),
        },
        Error::UselessShapeSet { .. } => Some(shares),
        Error::NoFreeShapeSet => task.constraints.first().map(|c| c.set.place.as_str()),
        Error::LimitExceeded { coordinate, .. } | Error::OutOfRange { coordinate, .. } => {
            let constrained = |set: &str| {
                coordinate
                    .strip_prefix(set)
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
            };
            let constraint = task.constraints.iter().find(|c| constrained(&c.set.value));
            constraint.map(|constraint| constraint.set.place.as_str())
        }
        _ => None,
    }
}

/// A task that makes no sense is the user's mistake, a plan that does not work out is refused.
pub(crate) fn failure(error: Error) -> Refusal {
    match error {
        Error::Invalid { .. }
        | Error::InvalidEntry { .. }
        | Error::Length { .. }
        | Error::NoFreeShapeSet => Refusal::task(error),
        Error::OutOfRange { coordinate, unit, time, value, lower, upper } => {
            let range = outside(coordinate, unit, time, [value, lower, upper]);
            Refusal::plan(format!("{range}: give the motion more time"))
        }
        Error::LimitExceeded { coordinate, unit, time, value, lower, upper, duration } => {
            let range = outside(coordinate, unit, time, [value, lower, upper]);
            Refusal::plan(match duration {
                Some(seconds) => format!("{range}: {seconds:.2} s for the motion would do"),
                None => format!("{range}: no longer duration was found that would do"),
            })
        }
        Error::NonFinite { .. } => Refusal::plan(format!(
            "{error}: the motion asks for more than the robot can do, give it more time"
        )),
        _ => Refusal::plan(error),
    }
}

fn outside(coordinate: &str, unit: &str, time: f64, numbers: [f64; 3]) -> String {
    let (unit, [value, lower, upper]) = number::shown(unit, numbers);
    format!(
        "`{coordinate}` would be {value} {unit} at t = {time:.4} s, outside of its range {lower} to \
         {upper} {unit}"
    )
}
