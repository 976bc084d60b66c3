//! Desired motions of a task, at the robot's sizes.

use crate::error::{Outcome, Refusal};
use crate::number;
use crate::refusal::failure;
use nalgebra::SVector;
use shapebot_dynamics::{Coordinate, Description};
use shapebot_planner::motion::{
    Bezier, DesiredMotion, Knot, Legs, Line, Rest, Waypoint, Waypoints,
};
use shapebot_planner::{SetMotion, TwoPhases};
use shapebot_tasks::{Constraint, Motion, Quantities, Said, Task};

/// Degree of the smooth steps of constrained shape sets.
const DEGREE: usize = 9;

/// A point of the output space.
pub(crate) fn point<const NX: usize>(
    said: &Said<Quantities>,
    robot: &Description,
) -> Outcome<SVector<f64, NX>> {
    entries(said, robot.output_unit, "output", robot.outputs)
}

/// Numbers for coordinates of known names and unit.
fn entries<const N: usize>(
    said: &Said<Quantities>,
    unit: &str,
    what: &str,
    names: &[&str],
) -> Outcome<SVector<f64, N>> {
    let Quantities { values, dimension } = &said.value;
    if values.len() != N {
        let (found, names) = (values.len(), names.join(", "));
        let numbers = if found == 1 { "number" } else { "numbers" };
        let message = format!(
            "{}: {found} {numbers} for a point, the robot's {what} has {N}: {names}",
            said.place
        );
        return Err(Refusal::task(message));
    }
    if dimension.unit() != unit {
        let found = dimension.unit();
        return Err(Refusal::task(format!(
            "{}: given in {found}, the robot's {what} is in {unit}",
            said.place
        )));
    }
    Ok(SVector::from_fn(|i, _| values[i]))
}

/// What a motion is made of; curves keep their points here.
enum Piece<const NX: usize> {
    Line(Line<f64, NX>),
    Rest(Rest<f64, NX>),
    Curve(Vec<SVector<f64, NX>>, f64),
    Spline(Vec<Waypoint<f64, NX>>, Vec<Knot<f64, NX>>),
    Phases(TwoPhases<f64, NX>),
}

impl<const NX: usize> Piece<NX> {
    /// A motion that begins at a point; `place` is where the task says it.
    fn new(
        motion: &Motion,
        from: SVector<f64, NX>,
        robot: &Description,
        place: &str,
    ) -> Outcome<Self> {
        let failure = |error| failure(error).at(place);
        Ok(match motion {
            Motion::Line { goal, degree, duration } => {
                let line = Line::new(from, point(goal, robot)?, *duration, *degree);
                Self::Line(line.map_err(failure)?)
            }
            Motion::Rest { duration } => Self::Rest(Rest::new(from, *duration).map_err(failure)?),
            Motion::Bezier { points, duration } => {
                let points = points.iter().map(|at| point(at, robot)).collect::<Outcome<_>>()?;
                Self::Curve(points, *duration)
            }
            Motion::Waypoints(points) => {
                let waypoint = |said: &shapebot_tasks::Waypoint| {
                    Ok(Waypoint { time: said.time, position: point(&said.at, robot)? })
                };
                let waypoints = points.iter().map(waypoint).collect::<Outcome<Vec<_>>>()?;
                let knots = vec![Knot::default(); waypoints.len()];
                Self::Spline(waypoints, knots)
            }
            Motion::TwoPhases { goal, duration, .. } => {
                let phases = TwoPhases::new(from, point(goal, robot)?, *duration);
                Self::Phases(phases.map_err(failure)?)
            }
            Motion::Legs(_) => return Err(Refusal::task("legs within legs")),
        })
    }

    fn motion(&mut self) -> Outcome<Box<dyn DesiredMotion<f64, NX> + '_>> {
        Ok(match self {
            Self::Line(line) => Box::new(*line),
            Self::Rest(rest) => Box::new(*rest),
            Self::Phases(phases) => Box::new(*phases),
            Self::Curve(points, duration) => {
                Box::new(Bezier::new(points, *duration).map_err(failure)?)
            }
            Self::Spline(waypoints, knots) => {
                Box::new(Waypoints::new(waypoints, knots).map_err(failure)?)
            }
        })
    }
}

/// Calls a function with the desired motion of a task.
pub(crate) fn with_motion<const NX: usize, O>(
    task: &Task,
    robot: &Description,
    then: impl FnOnce(&dyn DesiredMotion<f64, NX>) -> Outcome<O>,
) -> Outcome<O> {
    let legs = match &task.motion.value {
        Motion::Legs(legs) => legs.as_slice(),
        single => std::slice::from_ref(single),
    };
    let mut at = SVector::zeros();
    let mut pieces = Vec::new();
    for leg in legs {
        let mut piece = Piece::new(leg, at, robot, &task.motion.place)?;
        {
            let motion = piece.motion().map_err(|e| e.at(&task.motion.place))?;
            at = motion.position(motion.duration());
        }
        pieces.push(piece);
    }
    let motions = pieces.iter_mut().map(Piece::motion).collect::<Outcome<Vec<_>>>()?;
    if let [motion] = motions.as_slice() {
        return then(&**motion);
    }
    let motions: Vec<&dyn DesiredMotion<f64, NX>> =
        motions.iter().map(|motion| &**motion).collect();
    let legs = Legs::new(&motions).map_err(|e| failure(e).at(&task.motion.place))?;
    then(&legs)
}

/// The lines along which a constrained shape set goes.
pub(crate) fn constraint_lines<const NX: usize>(
    constraint: &Constraint,
    robot: &Description,
) -> Outcome<Vec<Line<f64, NX>>> {
    let set = &robot.shape_sets[shape_set(&constraint.set, robot)?];
    let coordinates = robot.shape_coordinates().get(set.first..set.first + set.len);
    let coordinates = coordinates.unwrap_or_default();
    let names: Vec<&str> = coordinates.iter().map(|coordinate| coordinate.name).collect();
    let unit = coordinates.first().map_or("rad", |coordinate| coordinate.unit);
    let mut at = SVector::zeros();
    let mut lines = Vec::new();
    for leg in &constraint.legs {
        let to = match &leg.to {
            Some(to) => {
                let values: SVector<f64, NX> = entries(to, unit, set.name, &names)?;
                check_ranges(coordinates, values.as_slice()).map_err(|e| e.at(&to.place))?;
                values
            }
            None => at,
        };
        let line = Line::new(at, to, leg.duration, DEGREE);
        lines.push(line.map_err(|e| failure(e).at(&constraint.set.place))?);
        at = to;
    }
    Ok(lines)
}

/// Refuses values outside of the declared ranges.
fn check_ranges(coordinates: &[Coordinate], values: &[f64]) -> Outcome {
    for (coordinate, &value) in coordinates.iter().zip(values) {
        let (lower, upper) = (coordinate.lower, coordinate.upper);
        if !(lower..=upper).contains(&value) {
            let (unit, [value, lower, upper]) =
                number::shown(coordinate.unit, [value, lower, upper]);
            return Err(Refusal::task(format!(
                "{value} {unit} is outside of the range of `{}`, {lower} to {upper} {unit}",
                coordinate.name
            )));
        }
    }
    Ok(())
}

/// The constrained shape sets with their trajectories.
pub(crate) fn set_motions<'l, const NX: usize>(
    task: &Task,
    robot: &Description,
    legs: &'l [Legs<'l, Line<f64, NX>, f64, NX>],
) -> Outcome<Vec<SetMotion<'l, f64, NX>>> {
    let pairs = task.constraints.iter().zip(legs);
    let motion = |(constraint, motion): (&Constraint, &'l Legs<'l, _, f64, NX>)| {
        Ok(SetMotion { set: shape_set(&constraint.set, robot)?, motion })
    };
    pairs.map(motion).collect()
}

/// Index of a shape set.
pub(crate) fn shape_set(said: &Said<String>, robot: &Description) -> Outcome<usize> {
    let known = || robot.shape_sets.iter().map(|set| set.name);
    let index = known().position(|name| name == said.value);
    index.ok_or_else(|| Refusal::unknown("shape set", &said.value, known()).at(&said.place))
}
