//! Node types and nodes.

use crate::error::{Said, Spot};
use crate::reader::{Table, Value};
use shapebot_drive::{DataType, Object, Role, object};

/// What a count is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Unit {
    /// A thousandth of the rated torque.
    PerMille,
    /// A count of the encoder, or a count per second.
    Counts,
    /// So many base units of the dimension that the signal has.
    Si(f64),
    /// So many amperes.
    Ampere(f64),
    /// A bare number.
    One,
}

/// A type of node: hardware and its configuration.
#[derive(Clone, Debug)]
pub(crate) struct TypeSource {
    pub(crate) name: Said<String>,
    pub(crate) role: Said<Role>,
    pub(crate) motor: Option<Motor>,
    pub(crate) receive: Vec<PdoSource>,
    pub(crate) transmit: Vec<PdoSource>,
    pub(crate) objects: Vec<ObjectSource>,
    pub(crate) sets: Vec<SetSource>,
    pub(crate) identity: Identity,
    pub(crate) heartbeat: Said<f64>,
    pub(crate) heartbeat_timeout: Said<f64>,
    /// Deadline of receive PDOs, seconds.
    pub(crate) deadline: Option<Said<f64>>,
    pub(crate) interpolation: Option<Said<f64>>,
    pub(crate) dummy_mapping: bool,
    /// Receive and transmit PDOs that the device has.
    pub(crate) pdo_counts: [u8; 2],
    /// Travel time of legs, seconds.
    pub(crate) travel: Option<Said<f64>>,
}

/// Motor, encoder and reactions of a drive.
#[derive(Clone, Debug)]
pub(crate) struct Motor {
    pub(crate) rated: Said<f64>,
    pub(crate) peak: Said<f64>,
    pub(crate) counts: Said<u32>,
    pub(crate) mode: i8,
    /// N·m/A, for torque objects in amperes.
    pub(crate) constant: Option<f64>,
    /// 0x6007, 0x605A to 0x605E.
    pub(crate) reactions: [(Object, i16); 6],
}

/// A PDO by its entries' names.
#[derive(Clone, Debug)]
pub(crate) struct PdoSource {
    pub(crate) spot: Spot,
    pub(crate) transmission: u8,
    pub(crate) entries: Vec<Said<String>>,
}

/// What object a signal is.
#[derive(Clone, Debug)]
pub(crate) struct ObjectSource {
    pub(crate) signal: Said<String>,
    pub(crate) object: Object,
    pub(crate) kind: DataType,
    /// As written: its dimension depends on the signal.
    pub(crate) unit: Option<Said<String>>,
}

/// A further value to write.
#[derive(Clone, Debug)]
pub(crate) struct SetSource {
    pub(crate) spot: Spot,
    pub(crate) object: Object,
    pub(crate) kind: DataType,
    pub(crate) value: i64,
}

/// What 0x1018 must be; `None` is not asked for.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Identity {
    pub(crate) vendor: Option<u32>,
    pub(crate) product: Option<u32>,
}

const ROLES: [(&str, Role); 4] =
    [("drive", Role::Drive), ("imu", Role::Imu), ("encoder", Role::Encoder), ("legs", Role::Legs)];

const TYPES: [(&str, DataType); 6] = [
    ("i8", DataType::I8),
    ("i16", DataType::I16),
    ("i32", DataType::I32),
    ("u8", DataType::U8),
    ("u16", DataType::U16),
    ("u32", DataType::U32),
];

const COMMON: [&str; 11] = [
    "role",
    "rpdo",
    "tpdo",
    "objects",
    "set",
    "identity",
    "heartbeat",
    "heartbeat-timeout",
    "deadline",
    "dummy-mapping",
    "pdos",
];

pub(crate) fn node_type(name: Said<String>, table: &Table<'_>) -> Option<TypeSource> {
    let role = table.require("role").and_then(|value| Some(value.said(value.word(&ROLES)?)))?;
    let mut known = COMMON.to_vec();
    match role.value {
        Role::Drive => known.extend([
            "rated-torque",
            "peak-torque",
            "torque-constant",
            "counts",
            "mode",
            "reactions",
            "interpolation",
        ]),
        Role::Legs => known.push("travel"),
        Role::Imu | Role::Encoder => {}
    }
    table.only(&known);
    let motor = (role.value == Role::Drive).then(|| motor(table));
    let travel = (role.value == Role::Legs)
        .then(|| table.require("travel").and_then(|value| value.positive("s")));
    let pdos = |key| table.get(key).and_then(|value| value.list()).unwrap_or_default();
    let receive = pdos("rpdo").iter().filter_map(pdo).collect();
    let transmit = pdos("tpdo").iter().filter_map(pdo).collect();
    let objects = entries(table, "objects", object_source);
    let sets = entries(table, "set", set_source);
    let heartbeat = table.require("heartbeat").and_then(|value| value.positive("s"));
    let timeout = table.require("heartbeat-timeout").and_then(|value| value.positive("s"));
    let deadline = table.get("deadline").map(|value| value.positive("s"));
    let interpolation = table.get("interpolation").map(|value| value.positive("s"));
    let dummy = table.get("dummy-mapping").map_or(Some(false), |value| value.boolean());
    let identity = table.get("identity").and_then(|value| value.table());
    Some(TypeSource {
        name,
        role,
        receive,
        transmit,
        objects,
        sets,
        identity: identity.map_or_else(Identity::default, |table| read_identity(&table)),
        heartbeat: heartbeat?,
        heartbeat_timeout: timeout?,
        deadline: deadline.flatten(),
        interpolation: interpolation.flatten(),
        dummy_mapping: dummy?,
        pdo_counts: pdo_counts(table)?,
        motor: match motor {
            Some(motor) => Some(motor?),
            None => None,
        },
        travel: travel.flatten(),
    })
}

fn pdo_counts(table: &Table<'_>) -> Option<[u8; 2]> {
    let Some(value) = table.get("pdos") else {
        return Some([4, 4]);
    };
    match value.list()?.as_slice() {
        [receive, transmit] => Some([receive.integer(0, 4)?, transmit.integer(0, 4)?]),
        _ => value.refuse("expected two numbers: receive and transmit PDOs that the device has"),
    }
}

fn entries<T>(
    table: &Table<'_>,
    key: &str,
    read: impl Fn(Said<&str>, &Value<'_>) -> Option<T>,
) -> Vec<T> {
    let table = table.get(key).and_then(|value| value.table());
    let entries = table.map(|table| table.entries()).unwrap_or_default();
    entries.into_iter().filter_map(|(name, value)| read(name, &value)).collect()
}

fn read_identity(table: &Table<'_>) -> Identity {
    table.only(&["vendor", "product"]);
    let number = |key| table.get(key).and_then(|value| value.integer(0, u32::MAX.into()));
    Identity { vendor: number("vendor"), product: number("product") }
}

/// Key, object, words with their values, default.
type Reaction = (&'static str, Object, &'static [(&'static str, i16)], i16);

/// Words of the reactions, with the values that the standard gives them, and the default.
const REACTIONS: [Reaction; 6] = [
    (
        "connection-lost",
        Object::ABORT_CONNECTION,
        &[("none", 0), ("fault", 1), ("disable-voltage", 2), ("quick-stop", 3)],
        1,
    ),
    ("quick-stop", Object::QUICK_STOP_OPTION, &[("disable", 0), ("slow-down", 1), ("ramp", 2)], 0),
    ("shutdown", Object::SHUTDOWN_OPTION, &[("disable", 0), ("slow-down", 1)], 0),
    ("disable-operation", Object::DISABLE_OPTION, &[("disable", 0), ("slow-down", 1)], 0),
    ("halt", Object::HALT_OPTION, &[("slow-down", 1), ("ramp", 2)], 1),
    ("fault", Object::FAULT_OPTION, &[("disable", 0), ("slow-down", 1), ("ramp", 2)], 0),
];

fn motor(table: &Table<'_>) -> Option<Motor> {
    let torque = |key| table.require(key).and_then(|value| value.positive("N*m"));
    let (rated, peak) = (torque("rated-torque"), torque("peak-torque"));
    let counts = table.require("counts");
    let counts = counts.and_then(|value| Some(value.said(value.integer(1, 1 << 30)?)));
    let constant = table.get("torque-constant").map(|value| value.positive("N*m/A"));
    let mode = table.get("mode").map_or(Some(10), |value| value.integer(-128, 127));
    let given = table.get("reactions").and_then(|value| value.table());
    if let Some(given) = &given {
        given.only(&REACTIONS.map(|(name, ..)| name));
    }
    let reactions = REACTIONS.map(|(name, object, words, default)| {
        let value = given.as_ref().and_then(|given| given.get(name));
        (object, value.and_then(|value| value.word(words)).unwrap_or(default))
    });
    Some(Motor {
        rated: rated?,
        peak: peak?,
        counts: counts?,
        mode: mode?,
        constant: constant.flatten().map(|constant| constant.value),
        reactions,
    })
}

/// `{ entries = ["statusword", "position"], transmission = "event" }`.
fn pdo(value: &Value<'_>) -> Option<PdoSource> {
    let table = value.table()?;
    table.only(&["entries", "transmission"]);
    let entries = table.require("entries").and_then(|value| value.names());
    let transmission = match table.get("transmission") {
        None => Some(1),
        Some(value) if value.is_string() => value.word(&[("sync", 1), ("event", 255)]),
        Some(value) => value.integer(1, 240),
    };
    Some(PdoSource { spot: table.spot(), transmission: transmission?, entries: entries? })
}

/// `{ object = "0x6071:00", type = "i16", unit = "1 mN*m" }`.
fn object_source(signal: Said<&str>, value: &Value<'_>) -> Option<ObjectSource> {
    let table = value.table()?;
    table.only(&["object", "type", "unit"]);
    let place = table.require("object");
    let object = place.and_then(|value| read_object(value.string()?, |m| value.refuse(m)));
    let kind = table.require("type").and_then(|value| value.word(&TYPES));
    let unit = table.get("unit").map(|value| value.name());
    Some(ObjectSource {
        signal: Said { value: signal.value.to_owned(), spot: signal.spot },
        object: object?,
        kind: kind?,
        unit: unit.flatten(),
    })
}

/// `"0x6087:00" = { type = "u32", value = 1000000 }`.
fn set_source(key: Said<&str>, value: &Value<'_>) -> Option<SetSource> {
    let table = value.table()?;
    table.only(&["type", "value"]);
    let object = read_object(key.value, |message| value.refuse(message));
    let kind = table.require("type").and_then(|value| value.word(&TYPES))?;
    let (low, high) = kind.range();
    let number = table.require("value").and_then(|value| value.integer(low, high));
    Some(SetSource { spot: key.spot, object: object?, kind, value: number? })
}

/// `0x6071:00`.
fn read_object(text: &str, refuse: impl Fn(String) -> Option<Object>) -> Option<Object> {
    let read = || {
        let (index, sub) = text.strip_prefix("0x")?.split_once(':')?;
        let index = u16::from_str_radix(index, 16).ok()?;
        Some(object(index, u8::from_str_radix(sub, 16).ok()?))
    };
    read().or_else(|| refuse(format!("\"{text}\" is no object such as \"0x6071:00\"")))
}

/// A node.
#[derive(Clone, Debug)]
pub(crate) struct NodeSource {
    pub(crate) name: Said<String>,
    pub(crate) kind: Said<String>,
    pub(crate) bus: Said<String>,
    pub(crate) id: Said<u8>,
    pub(crate) sign: Option<Said<i8>>,
    pub(crate) sign_in_drive: Option<Said<bool>>,
    pub(crate) serial: Option<u32>,
}

pub(crate) fn node(name: Said<String>, table: &Table<'_>) -> Option<NodeSource> {
    table.only(&["type", "bus", "id", "sign", "sign-in", "serial"]);
    let text = |key| table.require(key).and_then(|value| value.name());
    let (kind, bus) = (text("type"), text("bus"));
    let id = table.require("id").and_then(|id| Some(id.said(id.integer(1, 127)?)));
    let sign = table.get("sign").and_then(|value| match value.integer(-1, 1)? {
        0_i8 => value.refuse("expected 1 or -1"),
        sign => Some(value.said(sign)),
    });
    let sign_in_drive = table
        .get("sign-in")
        .and_then(|value| Some(value.said(value.word(&[("drive", true), ("master", false)])?)));
    let serial = table.get("serial").and_then(|value| value.integer(0, u32::MAX.into()));
    Some(NodeSource { name, kind: kind?, bus: bus?, id: id?, sign, sign_in_drive, serial })
}
