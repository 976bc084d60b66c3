//! The schema of `[simulation]` and `[paper]`.

use crate::error::Error;
use crate::quantity::{Dimension, Quantities};
use crate::reader::{Source, Table, Value};
use crate::simulation::{Compensate, Friction, Law, Noise, Paper, Push, Simulation, Weights};
use crate::task::{Said, Task};
use toml::de::DeTable;

type Outcome<T> = Result<T, Error>;

const KEYS: [&str; 21] = [
    "after",
    "seed",
    "compensate",
    "controller",
    "lqr",
    "observer",
    "offset",
    "estimator",
    "gains",
    "drive",
    "contact",
    "delay",
    "noise",
    "bias",
    "start",
    "slope",
    "pushes",
    "weights",
    "plant",
    "plant_model",
    "strength",
];

impl Task {
    /// Changes the simulation as a line of a task file's `[simulation]` would: `drive.coulomb = "2 N m"`.
    /// Quotes around a quantity may be left out. `place` is what messages begin with.
    ///
    /// # Errors
    ///
    /// What is wrong with the line.
    pub fn set_simulation(&mut self, place: &str, line: &str) -> Outcome<()> {
        let quoted = line.split_once('=').map(|(key, value)| format!("{key} = {:?}", value.trim()));
        let text = match (DeTable::parse(line), quoted) {
            (Err(_), Some(quoted)) => quoted,
            _ => line.to_owned(),
        };
        let source = Source { name: place, text: &text };
        let document = DeTable::parse(&text).map_err(|error| Error {
            place: source.place(error.span().map_or(0, |span| span.start)),
            message: error.message().to_owned(),
        })?;
        let table = Table::root(source, &document);
        read(&table, &mut self.simulation)
    }
}

/// Reads keys into a simulation; those not given keep their value.
pub(crate) fn read(table: &Table<'_>, to: &mut Simulation) -> Outcome<()> {
    table.only(&KEYS)?;
    for (key, value) in table.entries() {
        match key.value {
            "after" => to.after = Some(value.pause()?),
            "seed" => to.seed = value.count()? as u64,
            "compensate" => {
                to.compensate =
                    value.word(&[("plan", Compensate::Plan), ("body", Compensate::Body)])?;
            }
            "controller" => {
                to.law = value.word(&[("law", Law::Planned), ("lqr", Law::Regulator)])?
            }
            "lqr" => to.weights = value.said(weights(&value)?),
            "observer" => to.observer = Some(value.switch()?),
            "offset" => to.offset = Some(value.switch()?),
            "estimator" => to.estimator = value.switch()?,
            "gains" => gains(&value, &mut to.gains)?,
            "drive" => friction(&value, &mut to.drive)?,
            "contact" => friction(&value, &mut to.contact)?,
            "delay" => delay(&value, &mut to.delay)?,
            "noise" => noise(&value, &mut to.noise)?,
            "bias" => to.bias = Some(value.said(value.quantities()?)),
            "start" => start(&value, to)?,
            "slope" => to.slope = Some(value.said(value.quantities()?)),
            "pushes" => to.pushes = value.list()?.iter().map(push).collect::<Outcome<_>>()?,
            "weights" => to.point_weights = named(&value, force)?,
            "plant" => put_all(&mut to.plant, named(&value, |value| value.number())?),
            "plant_model" => to.plant_model = Some(value.said(value.string()?.to_owned())),
            _ => to.strength = Some(not_negative(&value)?),
        }
    }
    if to.law == Law::Regulator && to.weights.value.state.is_empty() {
        let place = table.get("controller").unwrap_or(table.require("lqr")?);
        return Err(place.error("needs `lqr = { state = [...], actuator = [...] }`"));
    }
    Ok(())
}

fn not_negative(value: &Value<'_>) -> Outcome<f64> {
    match value.number()? {
        number if number >= 0.0 => Ok(number),
        number => Err(value.error(format!("expected a number from 0 up, found {number}"))),
    }
}

fn owned(said: &Said<&str>) -> Said<String> {
    Said { value: said.value.to_owned(), place: said.place.clone() }
}

/// All entries of a table.
fn named<T>(
    value: &Value<'_>,
    read: impl Fn(&Value<'_>) -> Outcome<T>,
) -> Outcome<Vec<(Said<String>, T)>> {
    let entries = value.table()?.entries().into_iter();
    entries.map(|(name, value)| Ok((owned(&name), read(&value)?))).collect()
}

/// Later entries take the place of earlier ones of the same name.
fn put_all<T>(to: &mut Vec<(Said<String>, T)>, entries: Vec<(Said<String>, T)>) {
    for (name, value) in entries {
        to.retain(|(other, _)| other.value != name.value);
        to.push((name, value));
    }
}

fn numbers(value: &Value<'_>) -> Outcome<Vec<f64>> {
    if value.is_list() {
        return value.list()?.iter().map(|entry| entry.number()).collect();
    }
    Ok(vec![value.number()?])
}

fn weights(value: &Value<'_>) -> Outcome<Weights> {
    let table = value.table()?;
    table.only(&["state", "actuator"])?;
    let of = |key: &str| numbers(&table.require(key)?);
    Ok(Weights { state: of("state")?, actuator: of("actuator")? })
}

/// The gains that may be given.
pub const GAINS: [&str; 11] = [
    "lean",
    "lean_rate",
    "lean_integral",
    "position",
    "velocity",
    "servo_rate",
    "servo_damping",
    "servo_integral",
    "observer_rate",
    "offset_rate",
    "force_slew",
];

fn gains(value: &Value<'_>, to: &mut Vec<(Said<String>, Vec<f64>)>) -> Outcome<()> {
    value.table()?.only(&GAINS)?;
    put_all(to, named(value, numbers)?);
    Ok(())
}

fn friction(value: &Value<'_>, to: &mut Said<Friction>) -> Outcome<()> {
    let table = value.table()?;
    table.only(&["viscous", "coulomb"])?;
    to.place = value.place();
    for (key, value) in table.entries() {
        let found = single(&value)?;
        match key.value {
            "viscous" => to.value.viscous = Some(found),
            _ => to.value.coulomb = Some(found),
        }
    }
    Ok(())
}

/// One number from zero up, with a unit.
fn single(value: &Value<'_>) -> Outcome<Quantities> {
    let quantities = value.quantities()?;
    match &*quantities.values {
        [number] if *number >= 0.0 => Ok(quantities),
        [number] => Err(value.error(format!("expected a number from 0 up, found {number}"))),
        _ => Err(value.error("expected one number with a unit")),
    }
}

/// One time for the way to the motors, or a table.
fn delay(value: &Value<'_>, to: &mut [f64; 2]) -> Outcome<()> {
    if value.is_string() {
        to[1] = value.pause()?;
        return Ok(());
    }
    let table = value.table()?;
    table.only(&["sensors", "actuators"])?;
    for (key, value) in table.entries() {
        to[usize::from(key.value == "actuators")] = value.pause()?;
    }
    Ok(())
}

fn noise(value: &Value<'_>, to: &mut Said<Noise>) -> Outcome<()> {
    let table = value.table()?;
    table.only(&["lean", "rate", "counts"])?;
    to.place = value.place();
    for (key, value) in table.entries() {
        match key.value {
            "lean" => to.value.lean = Some(single(&value)?),
            "rate" => to.value.rate = Some(single(&value)?),
            _ => to.value.counts = not_negative(&value)?,
        }
    }
    Ok(())
}

fn start(value: &Value<'_>, to: &mut Simulation) -> Outcome<()> {
    let table = value.table()?;
    table.only(&["position", "lean"])?;
    for (key, value) in table.entries() {
        let found = Some(value.said(value.quantities()?));
        match key.value {
            "position" => to.start_position = found,
            _ => to.start_lean = found,
        }
    }
    Ok(())
}

fn force(value: &Value<'_>) -> Outcome<Quantities> {
    let quantities = value.quantities()?;
    match quantities.dimension {
        Dimension::Force => Ok(quantities),
        other => Err(value.error(format!("expected N, found {}", other.unit()))),
    }
}

fn push(value: &Value<'_>) -> Outcome<Push> {
    let table = value.table()?;
    table.only(&["point", "force", "start", "duration"])?;
    let (point, pushing) = (table.require("point")?, table.require("force")?);
    let quantities = force(&pushing)?;
    if quantities.values.len() != 3 {
        return Err(pushing.error("expected three numbers, along the world's axes"));
    }
    Ok(Push {
        point: point.said(point.string()?.to_owned()),
        force: pushing.said(quantities),
        start: table.require("start")?.pause()?,
        duration: table.require("duration")?.duration()?,
    })
}

/// What the paper reports.
pub(crate) fn paper(value: &Value<'_>) -> Outcome<Paper> {
    let table = value.table()?;
    table.only(&["figure", "rmse", "largest", "compensation"])?;
    let number = |value: &Value<'_>| Ok(single(value)?.values.first().copied().unwrap_or_default());
    let optional = |key: &str| table.get(key).map(|value| number(&value)).transpose();
    let figure = table.get("figure").map(|value| value.string().map(str::to_owned)).transpose()?;
    let compensation = table.get("compensation").map(|value| named(&value, number)).transpose()?;
    Ok(Paper {
        figure,
        rmse: optional("rmse")?,
        largest: optional("largest")?,
        compensation: compensation.unwrap_or_default(),
    })
}
