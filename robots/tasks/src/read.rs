//! The schema.

use crate::error::Error;
use crate::reader::{Source, Table, Value};
use crate::simulation::Simulation;
use crate::task::{
    Constraint, ConstraintLeg, Method, Motion, Objective, Said, Shares, Spare, Task, Waypoint,
};
use toml::de::DeTable;

/// Most samples of a motion: every one of them becomes a row of the plan.
pub const MOST_SAMPLES: usize = 1_000_000;

type Outcome<T> = Result<T, Error>;

/// Degree of a line's smooth step if the task does not say.
const DEGREE: usize = 9;

const KEYS: [&str; 14] = [
    "title",
    "robot",
    "method",
    "objective",
    "samples",
    "standing",
    "shares",
    "spare",
    "limits",
    "force_limits",
    "motion",
    "constraints",
    "simulation",
    "paper",
];

/// Reads a task; `name` is that of the file, for messages.
///
/// # Errors
///
/// The first thing that is wrong, with line and key.
pub fn parse(name: &str, text: &str) -> Outcome<Task> {
    let source = Source { name, text };
    let document = DeTable::parse(text).map_err(|error| Error {
        place: source.place(error.span().map_or(0, |span| span.start)),
        message: error.message().to_owned(),
    })?;
    let table = Table::root(source, &document);
    table.only(&KEYS)?;
    let robot = table.require("robot")?;
    let place = table.require("motion")?;
    let motion = motion(&place.table()?, false)?;
    let mut task = Task {
        title: table.get("title").map(|title| title.string().map(str::to_owned)).transpose()?,
        robot: robot.said(robot.string()?.to_owned()),
        method: optional(&table, "method", method)?,
        objective: said(&table, "objective", objective)?,
        samples: samples(&table.require("samples")?)?,
        standing: said(&table, "standing", standing)?,
        shares: said(&table, "shares", shares)?,
        limits: optional(&table, "limits", limits)?,
        force_limits: optional(&table, "force_limits", limits)?,
        motion: place.said(motion),
        constraints: optional(&table, "constraints", constraints)?,
        simulation: Simulation::default(),
        is_experiment: false,
        paper: optional(&table, "paper", crate::read_simulation::paper)?,
    };
    if let Some(simulation) = table.get("simulation") {
        crate::read_simulation::read(&simulation.table()?, &mut task.simulation)?;
        task.is_experiment = true;
    }
    if let Some(spare) = table.get("spare") {
        let Shares::Automatic(chosen) = &mut task.shares.value else {
            return Err(spare.error("goes with shares = \"auto\""));
        };
        *chosen =
            spare.word(&[("unactuated", Spare::Unactuated), ("actuated", Spare::Actuated)])?;
    }
    check_phases(&table, &task)?;
    Ok(task)
}

fn optional<T: Default>(
    table: &Table<'_>,
    key: &str,
    read: impl FnOnce(&Value<'_>) -> Outcome<T>,
) -> Outcome<T> {
    table.get(key).map_or_else(|| Ok(T::default()), |value| read(&value))
}

/// A value with its place; the default has none.
fn said<T: Default>(
    table: &Table<'_>,
    key: &str,
    read: impl FnOnce(&Value<'_>) -> Outcome<T>,
) -> Outcome<Said<T>> {
    optional(table, key, |value| Ok(value.said(read(value)?)))
}

fn samples(value: &Value<'_>) -> Outcome<Said<usize>> {
    match value.count()? {
        count if count <= MOST_SAMPLES => Ok(value.said(count)),
        _ => Err(value.error(format!("more than {MOST_SAMPLES} samples"))),
    }
}

fn method(value: &Value<'_>) -> Outcome<Method> {
    value.word(&[("gain", Method::Gain), ("refined", Method::Refined)])
}

fn objective(value: &Value<'_>) -> Outcome<Objective> {
    value.word(&[
        ("position", Objective::Position),
        ("acceleration", Objective::Acceleration),
        ("coordinates", Objective::Coordinates),
    ])
}

/// One time for both sides, or a table.
fn standing(value: &Value<'_>) -> Outcome<[f64; 2]> {
    if value.is_string() {
        return value.pause().map(|seconds| [seconds; 2]);
    }
    let table = value.table()?;
    table.only(&["before", "after"])?;
    Ok([
        optional(&table, "before", |time| time.pause())?,
        optional(&table, "after", |time| time.pause())?,
    ])
}

fn shares(value: &Value<'_>) -> Outcome<Shares> {
    if value.is_string() {
        return value.word(&[("auto", ())]).map(|()| Shares::Automatic(Spare::default()));
    }
    let entries = value.table()?.entries();
    let share = |(set, share): (Said<&str>, Value<'_>)| Ok((owned(&set), share.number()?));
    entries.into_iter().map(share).collect::<Outcome<_>>().map(Shares::Given)
}

fn limits(value: &Value<'_>) -> Outcome<Vec<(Said<String>, crate::Quantities)>> {
    let entries = value.table()?.entries();
    let limit = |(name, limit): (Said<&str>, Value<'_>)| {
        let quantities = limit.quantities()?;
        if let Some(value) = quantities.values.iter().find(|value| **value < 0.0) {
            return Err(limit.error(format!("a limit is a magnitude, found {value}")));
        }
        Ok((owned(&name), quantities))
    };
    entries.into_iter().map(limit).collect()
}

fn owned(said: &Said<&str>) -> Said<String> {
    Said { value: said.value.to_owned(), place: said.place.clone() }
}

/// Kinds of motion.
#[derive(Clone, Copy)]
enum Kind {
    Line,
    Bezier,
    Waypoints,
    Rest,
    Legs,
    TwoPhases,
}

const KINDS: [(&str, Kind); 6] = [
    ("line", Kind::Line),
    ("bezier", Kind::Bezier),
    ("waypoints", Kind::Waypoints),
    ("rest", Kind::Rest),
    ("legs", Kind::Legs),
    ("two-phases", Kind::TwoPhases),
];

/// A motion; legs are made of the first four kinds.
fn motion(table: &Table<'_>, leg: bool) -> Outcome<Motion> {
    let kinds = if leg { &KINDS[..4] } else { &KINDS[..] };
    match table.require("kind")?.word(kinds)? {
        Kind::Line => line(table),
        Kind::Bezier => bezier(table),
        Kind::Waypoints => waypoints(table),
        Kind::Rest => {
            table.only(&["kind", "duration"])?;
            Ok(Motion::Rest { duration: table.require("duration")?.duration()? })
        }
        Kind::Legs => {
            table.only(&["kind", "legs"])?;
            let legs = table.require("legs")?.list()?;
            let legs = legs.iter().map(|entry| motion(&entry.table()?, true));
            legs.collect::<Outcome<_>>().map(Motion::Legs)
        }
        Kind::TwoPhases => two_phases(table),
    }
}

fn line(table: &Table<'_>) -> Outcome<Motion> {
    table.only(&["kind", "goal", "degree", "duration"])?;
    let degree = table.get("degree").map_or(Ok(DEGREE), |degree| degree.count())?;
    let (goal, duration) = (point(table, "goal")?, table.require("duration")?.duration()?);
    Ok(Motion::Line { goal, degree, duration })
}

fn point(table: &Table<'_>, key: &str) -> Outcome<Said<crate::Quantities>> {
    let value = table.require(key)?;
    Ok(value.said(value.quantities()?))
}

/// Most control points that a repetition may ask for: far beyond what a curve can have.
const MOST_POINTS: usize = 1000;

/// Control points are quantities, or tables of a point and how often it stands there.
fn bezier(table: &Table<'_>) -> Outcome<Motion> {
    table.only(&["kind", "points", "duration"])?;
    let mut points = Vec::new();
    for entry in table.require("points")?.list()? {
        if entry.is_string() {
            points.push(entry.said(entry.quantities()?));
            continue;
        }
        let repeated = entry.table()?;
        repeated.only(&["at", "times"])?;
        let times = repeated.require("times")?;
        let count = times.count()?;
        if points.len() + count > MOST_POINTS {
            return Err(times.error(format!("more than {MOST_POINTS} control points")));
        }
        let at = point(&repeated, "at")?;
        points.extend(std::iter::repeat_n(at, count));
    }
    Ok(Motion::Bezier { points, duration: table.require("duration")?.duration()? })
}

fn waypoints(table: &Table<'_>) -> Outcome<Motion> {
    table.only(&["kind", "points"])?;
    let points = table.require("points")?.list()?;
    let waypoint = |entry: &Value<'_>| {
        let entry = entry.table()?;
        entry.only(&["time", "at"])?;
        Ok(Waypoint { time: entry.require("time")?.time()?, at: point(&entry, "at")? })
    };
    points.iter().map(waypoint).collect::<Outcome<_>>().map(Motion::Waypoints)
}

fn two_phases(table: &Table<'_>) -> Outcome<Motion> {
    table.only(&["kind", "goal", "duration", "accelerate", "brake"])?;
    let share = |key: &str| {
        let value = table.require(key)?;
        Ok(value.said(shares(&value)?))
    };
    Ok(Motion::TwoPhases {
        goal: point(table, "goal")?,
        duration: table.require("duration")?.duration()?,
        shares: [share("accelerate")?, share("brake")?],
    })
}

fn constraints(value: &Value<'_>) -> Outcome<Vec<Constraint>> {
    let constraint = |(set, legs): (Said<&str>, Value<'_>)| {
        let legs = legs.list()?.iter().map(constraint_leg).collect::<Outcome<_>>()?;
        Ok(Constraint { set: owned(&set), legs })
    };
    value.table()?.entries().into_iter().map(constraint).collect()
}

fn constraint_leg(value: &Value<'_>) -> Outcome<ConstraintLeg> {
    let table = value.table()?;
    table.only(&["to", "duration"])?;
    let to = table.get("to").map(|to| Ok(to.said(to.quantities()?))).transpose()?;
    Ok(ConstraintLeg { duration: table.require("duration")?.duration()?, to })
}

/// What does not go with a motion in two phases.
fn check_phases(table: &Table<'_>, task: &Task) -> Outcome<()> {
    if !matches!(task.motion.value, Motion::TwoPhases { .. }) {
        return Ok(());
    }
    for (key, why) in [
        (
            "shares",
            "a motion of kind \"two-phases\" has its shares in `motion.accelerate` and `motion.brake`",
        ),
        (
            "constraints",
            "does not go with a motion of kind \"two-phases\": where its halves meet every free shape set \
             is at zero, and cannot make up for what a constrained one causes",
        ),
    ] {
        if let Some(value) = table.get(key) {
            return Err(value.error(why));
        }
    }
    let samples = table.require("samples")?;
    if task.samples.value.is_multiple_of(2) {
        return Err(samples.error("expected an odd number: the phases share the middle sample"));
    }
    Ok(())
}
