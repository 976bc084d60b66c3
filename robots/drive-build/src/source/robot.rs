//! The parts that belong to the robot: timing, buses, axes, yaw, safety.

use crate::error::{Said, Spot};
use crate::reader::{Table, Value};

/// Periods and deadlines, seconds.
#[derive(Clone, Debug)]
pub(crate) struct TimingSource {
    pub(crate) period: Said<f64>,
    pub(crate) compute: Said<f64>,
    pub(crate) jitter: Option<Said<f64>>,
    pub(crate) heartbeat: Said<f64>,
    pub(crate) boot_timeout: f64,
    pub(crate) sdo_timeout: f64,
    pub(crate) sdo_retries: u8,
    pub(crate) enable_timeout: f64,
    pub(crate) missed_warning: u8,
    pub(crate) missed_fault: u8,
}

/// A quantity above zero, or a default.
fn time_or(table: &Table<'_>, key: &str, default: f64) -> Option<f64> {
    match table.get(key) {
        Some(value) => value.positive("s").map(|time| time.value),
        None => Some(default),
    }
}

fn count_or(table: &Table<'_>, key: &str, low: i64, high: i64, default: u8) -> Option<u8> {
    table.get(key).map_or(Some(default), |value| value.integer(low, high))
}

/// A quantity above zero that must be there.
fn positive(table: &Table<'_>, key: &str, like: &str) -> Option<Said<f64>> {
    table.require(key)?.positive(like)
}

pub(crate) fn timing(table: &Table<'_>) -> Option<TimingSource> {
    table.only(&[
        "period",
        "compute",
        "jitter",
        "heartbeat",
        "boot-timeout",
        "sdo-timeout",
        "sdo-retries",
        "enable-timeout",
        "missed-warning",
        "missed-fault",
    ]);
    let period = positive(table, "period", "s");
    let compute = positive(table, "compute", "s");
    let heartbeat = positive(table, "heartbeat", "s");
    let jitter = table.get("jitter").map(|value| value.positive("s"));
    let boot_timeout = time_or(table, "boot-timeout", 2.0);
    let sdo_timeout = time_or(table, "sdo-timeout", 0.05);
    let enable_timeout = time_or(table, "enable-timeout", 1.0);
    let sdo_retries = count_or(table, "sdo-retries", 0, 10, 2);
    let missed_warning = count_or(table, "missed-warning", 1, 100, 2);
    let missed_fault = count_or(table, "missed-fault", 1, 100, 5);
    Some(TimingSource {
        period: period?,
        compute: compute?,
        jitter: optional(jitter)?,
        heartbeat: heartbeat?,
        boot_timeout: boot_timeout?,
        sdo_timeout: sdo_timeout?,
        sdo_retries: sdo_retries?,
        enable_timeout: enable_timeout?,
        missed_warning: missed_warning?,
        missed_fault: missed_fault?,
    })
}

/// Missing is sound, wrong is not.
fn optional<T>(value: Option<Option<T>>) -> Option<Option<T>> {
    match value {
        Some(None) => None,
        Some(Some(value)) => Some(Some(value)),
        None => Some(None),
    }
}

/// A bus.
#[derive(Clone, Debug)]
pub(crate) struct BusSource {
    pub(crate) name: Said<String>,
    /// Bits per second.
    pub(crate) rate: Said<f64>,
    /// Largest load, 0 to 1.
    pub(crate) load_limit: f64,
}

pub(crate) fn bus(name: Said<String>, table: &Table<'_>) -> Option<BusSource> {
    table.only(&["rate", "load-limit"]);
    let rate = positive(table, "rate", "bit/s");
    let limit = match table.get("load-limit") {
        None => Some(0.8),
        Some(value) => match value.number()? {
            share if share > 0.0 && share <= 1.0 => Some(share),
            _ => value.refuse("expected a share between 0 and 1"),
        },
    };
    Some(BusSource { name, rate: rate?, load_limit: limit? })
}

/// Radians of the motor per unit of the coordinate.
#[derive(Clone, Debug)]
pub(crate) enum Ratio {
    /// Motor angle per coordinate angle.
    Angle(f64),
    /// Motor angle per length, rad/m.
    Length(f64),
}

/// An axis.
#[derive(Clone, Debug)]
pub(crate) struct AxisSource {
    pub(crate) name: Said<String>,
    pub(crate) actuator: Option<Said<String>>,
    pub(crate) drives: Said<Vec<Said<String>>>,
    pub(crate) ratio: Said<Ratio>,
    /// As written: the unit depends on the coordinate.
    pub(crate) force: Said<f64>,
    /// Whether force and slew are in N·m, not N.
    pub(crate) is_torque: bool,
    pub(crate) slew: f64,
    pub(crate) force_step: Option<Said<f64>>,
    pub(crate) position_step: Option<Said<f64>>,
    pub(crate) pair_tolerance: Option<Said<f64>>,
}

pub(crate) fn axis(name: Said<String>, table: &Table<'_>) -> Option<AxisSource> {
    let is_torque = table.get("force").is_none();
    let (force, unit, length) =
        if is_torque { ("torque", "N*m", "rad") } else { ("force", "N", "m") };
    let step = format!("{force}-step");
    table.only(&[
        "drives",
        "actuator",
        "ratio",
        force,
        &step,
        "slew",
        "position-step",
        "pair-tolerance",
    ]);
    let drives = table.require("drives").and_then(|value| Some(value.said(value.names()?)));
    let actuator = table.get("actuator").map(|value| value.name());
    let ratio = table.require("ratio").and_then(|value| Some(value.said(ratio(&value)?)));
    let limit = positive(table, force, unit);
    let slew = positive(table, "slew", &format!("{unit}/s"));
    let steps = [(step.as_str(), unit), ("position-step", length), ("pair-tolerance", length)];
    let [force_step, position_step, pair_tolerance] =
        steps.map(|(key, unit)| table.get(key).map(|value| value.positive(unit)));
    Some(AxisSource {
        name,
        actuator: optional(actuator)?,
        drives: drives?,
        ratio: ratio?,
        force: limit?,
        is_torque,
        slew: slew?.value,
        force_step: optional(force_step)?,
        position_step: optional(position_step)?,
        pair_tolerance: optional(pair_tolerance)?,
    })
}

/// A number, or radii and a gear.
fn ratio(value: &Value<'_>) -> Option<Ratio> {
    if !value.is_table() {
        return match value.number()? {
            number if number > 0.0 => Some(Ratio::Angle(number)),
            _ => value.refuse("must be above zero; a node's `sign` turns it"),
        };
    }
    let table = value.table()?;
    table.only(&["ball", "roller", "wheel", "gear"]);
    let gear = match table.get("gear") {
        Some(gear) => gear.number().filter(|gear| *gear > 0.0)?,
        None => 1.0,
    };
    match (table.get("ball"), table.get("roller"), table.get("wheel")) {
        (Some(ball), Some(roller), None) => {
            let (ball, roller) = (ball.positive("m")?, roller.positive("m")?);
            Some(Ratio::Angle(gear * ball.value / roller.value))
        }
        (None, None, Some(wheel)) => Some(Ratio::Length(gear / wheel.positive("m")?.value)),
        _ => value.refuse("expected a number, { ball, roller, gear } or { wheel, gear }"),
    }
}

/// A receive PDO that several drives listen to.
#[derive(Clone, Debug)]
pub(crate) struct SharedSource {
    pub(crate) spot: Spot,
    pub(crate) bus: Said<String>,
    pub(crate) cob_id: Said<u16>,
    /// Axes or drives, a torque each.
    pub(crate) fields: Vec<Said<String>>,
}

pub(crate) fn shared(table: &Table<'_>) -> Option<SharedSource> {
    table.only(&["bus", "cob-id", "fields"]);
    let bus = table.require("bus").and_then(|value| value.name());
    let cob_id = table.require("cob-id").and_then(|id| Some(id.said(id.integer(1, 0x7FF)?)));
    let fields = table.require("fields").and_then(|value| value.names());
    Some(SharedSource { spot: table.spot(), bus: bus?, cob_id: cob_id?, fields: fields? })
}

/// The yaw axis.
#[derive(Clone, Debug)]
pub(crate) struct YawSource {
    pub(crate) spot: Spot,
    pub(crate) axis: Option<Said<String>>,
    pub(crate) plane: Said<Vec<Said<String>>>,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) rate_limit: f64,
}

pub(crate) fn yaw(table: &Table<'_>) -> Option<YawSource> {
    table.only(&["axis", "plane", "stiffness", "damping", "rate-limit"]);
    let plane = table.require("plane").and_then(|value| Some(value.said(value.names()?)));
    let axis = table.get("axis").map(|value| value.name());
    let number = |key, unit| match (&axis, table.get(key)) {
        (None, None) => Some(0.0),
        (None, Some(value)) => value.refuse("goes with `yaw.axis`"),
        (Some(_), _) => positive(table, key, unit).map(|said| said.value),
    };
    let stiffness = number("stiffness", "N*m/rad");
    let damping = number("damping", "N*m*s/rad");
    let rate_limit = number("rate-limit", "rad/s");
    Some(YawSource {
        spot: table.spot(),
        plane: plane?,
        stiffness: stiffness?,
        damping: damping?,
        rate_limit: rate_limit?,
        axis: optional(axis)?,
    })
}

/// Limits of the safety logic.
#[derive(Clone, Debug)]
pub(crate) struct SafetySource {
    pub(crate) lean_start: Said<f64>,
    pub(crate) lean_limit: Said<f64>,
    pub(crate) lean_rate_start: f64,
    pub(crate) lean_step: Option<Said<f64>>,
    pub(crate) lean_rate_step: Option<Said<f64>>,
    pub(crate) stale_fault: u8,
    pub(crate) silent_fault: u8,
    pub(crate) rise_timeout: f64,
    pub(crate) lower_timeout: f64,
    pub(crate) fault_deadline: f64,
}

pub(crate) fn safety(table: &Table<'_>) -> Option<SafetySource> {
    table.only(&[
        "lean-start",
        "lean-limit",
        "lean-rate-start",
        "lean-step",
        "lean-rate-step",
        "stale-fault",
        "silent-fault",
        "rise-timeout",
        "lower-timeout",
        "fault-deadline",
    ]);
    let lean_start = positive(table, "lean-start", "rad");
    let lean_limit = positive(table, "lean-limit", "rad");
    let lean_rate_start = positive(table, "lean-rate-start", "rad/s");
    let lean_step = table.get("lean-step").map(|value| value.positive("rad"));
    let lean_rate_step = table.get("lean-rate-step").map(|value| value.positive("rad/s"));
    let stale_fault = count_or(table, "stale-fault", 1, 100, 5);
    let silent_fault = count_or(table, "silent-fault", 1, 100, 3);
    let fault_deadline = time_or(table, "fault-deadline", 3.0);
    let rise_timeout = time_or(table, "rise-timeout", 3.0);
    let lower_timeout = time_or(table, "lower-timeout", 3.0);
    Some(SafetySource {
        lean_start: lean_start?,
        lean_limit: lean_limit?,
        lean_rate_start: lean_rate_start?.value,
        lean_step: optional(lean_step)?,
        lean_rate_step: optional(lean_rate_step)?,
        stale_fault: stale_fault?,
        silent_fault: silent_fault?,
        rise_timeout: rise_timeout?,
        lower_timeout: lower_timeout?,
        fault_deadline: fault_deadline?,
    })
}

/// The operator protocol's identifiers.
#[derive(Clone, Debug)]
pub(crate) struct OperatorSource {
    pub(crate) bus: Said<String>,
    pub(crate) command: Said<u16>,
    pub(crate) telemetry: Said<u16>,
    pub(crate) master: Said<u8>,
}

pub(crate) fn operator(table: &Table<'_>) -> Option<OperatorSource> {
    table.only(&["bus", "command", "telemetry", "master"]);
    let bus = table.require("bus").and_then(|value| value.name());
    let id = |key| table.require(key).and_then(|id| Some(id.said(id.integer(1, 0x7FF)?)));
    let (command, telemetry) = (id("command"), id("telemetry"));
    let master = table.require("master").and_then(|id| Some(id.said(id.integer(1, 127)?)));
    Some(OperatorSource { bus: bus?, command: command?, telemetry: telemetry?, master: master? })
}
