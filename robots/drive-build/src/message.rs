//! The frames of a drive by name: what codecs and DBC are made from.

use crate::description::{Command, DriveDescription, Node};
use shapebot_drive::{DataType, Entry, Field, Pdo, Role, Signal, Source};
use std::collections::BTreeSet;

/// A frame on a bus.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// Identifier of a language: `front_tpdo1`.
    pub name: String,
    /// Index of its bus.
    pub bus: usize,
    /// CAN identifier.
    pub cob_id: u16,
    /// Data bytes.
    pub bytes: usize,
    /// Node that sends it; `None` is the master.
    pub sender: Option<String>,
    /// Numbers in it, from the first byte on; gaps are left out.
    pub signals: Vec<MessageSignal>,
}

/// A number in a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct MessageSignal {
    /// Identifier of a language: `position`.
    pub name: String,
    /// Offset of its first byte.
    pub byte: usize,
    /// Type, little-endian.
    pub kind: DataType,
    /// Value of one count.
    pub scale: f64,
    /// SI unit, empty for codes.
    pub unit: String,
}

impl DriveDescription {
    /// All PDOs by name, the nodes' first, then the master's.
    #[must_use]
    pub fn messages(&self) -> Vec<Message> {
        let sent = self
            .nodes
            .iter()
            .flat_map(|node| node.transmit.iter().map(|pdo| self.transmitted(node, pdo)));
        sent.chain(self.commands.iter().map(|command| self.commanded(command))).collect()
    }

    fn transmitted(&self, node: &Node, pdo: &Pdo) -> Message {
        let name = |entry: &Entry| {
            let coordinate = |index: u8| self.coordinates[usize::from(index)].0.clone();
            match entry.signal {
                Signal::Coordinate(index) => coordinate(index),
                Signal::Rate(index) => format!("{}_rate", coordinate(index)),
                signal => signal_name(signal).to_owned(),
            }
        };
        let entries = pdo.entries().iter().map(|entry| {
            let skip = entry.signal == Signal::Gap;
            let scale = shortest(entry.scale);
            (entry.kind, (!skip).then(|| (name(entry), scale, self.unit(node, entry))))
        });
        Message {
            name: format!("{}_tpdo{}", node.name, pdo.number),
            bus: usize::from(node.bus),
            cob_id: pdo.cob_id,
            bytes: pdo.bytes(),
            sender: Some(node.name.clone()),
            signals: laid_out(entries),
        }
    }

    fn unit(&self, node: &Node, entry: &Entry) -> String {
        let axis = || node.motor.map(|motor| &self.axes[usize::from(motor.axis)]);
        let unit_of = |index: u8| self.coordinates[usize::from(index)].1.as_str();
        match entry.signal {
            Signal::Position => axis().map_or_else(String::new, |axis| axis.unit.clone()),
            Signal::Velocity => axis().map_or_else(String::new, |axis| format!("{}/s", axis.unit)),
            Signal::ActualTorque | Signal::Torque => "N*m".to_owned(),
            Signal::Coordinate(index) => unit_of(index).to_owned(),
            Signal::Rate(index) => format!("{}/s", unit_of(index)),
            Signal::Heading | Signal::Yaw => "rad".to_owned(),
            Signal::HeadingRate => "rad/s".to_owned(),
            _ => String::new(),
        }
    }

    fn commanded(&self, command: &Command) -> Message {
        let own = self.nodes.iter().find_map(|node| {
            let pdo = node.receive.iter().find(|pdo| pdo.cob_id == command.cob_id)?;
            let own = node.bus == command.bus && node.id.rpdo(pdo.number) == command.cob_id;
            own.then(|| format!("{}_rpdo{}", node.name, pdo.number))
        });
        let signal = |field: &Field| {
            let named = |name: &str| Some((name.to_owned(), 1.0, String::new()));
            match field.source {
                Source::Zero => None,
                Source::Controlword { .. } => named("controlword"),
                Source::Mode { .. } => named("mode"),
                Source::Legs => named("legs_command"),
                Source::Torque { axis, sign } => {
                    let axis = &self.axes[usize::from(axis)];
                    let name =
                        if own.is_some() { "force".into() } else { format!("force_{}", axis.name) };
                    let scale = f64::from(sign) * shortest((1.0 / axis.counts_per_force) as f32);
                    Some((name, scale, if axis.unit == "m" { "N" } else { "N*m" }.to_owned()))
                }
            }
        };
        let fields = command.fields.iter().map(|field| (field.kind, signal(field)));
        Message {
            bus: usize::from(command.bus),
            cob_id: command.cob_id,
            bytes: command.bytes(),
            sender: None,
            signals: laid_out(fields),
            name: own.unwrap_or_else(|| format!("shared_{:03x}", command.cob_id)),
        }
    }
}

/// The number that is printed for an `f32`, so that tables and DBC show the same digits.
fn shortest(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| value.into())
}

/// Name, scale and unit of a number; `None` for a gap.
type Named = Option<(String, f64, String)>;

/// Numbers with their places and with names that differ.
fn laid_out(entries: impl Iterator<Item = (DataType, Named)>) -> Vec<MessageSignal> {
    let mut signals = Vec::new();
    let (mut byte, mut taken) = (0, BTreeSet::new());
    for (kind, named) in entries {
        if let Some((base, scale, unit)) = named {
            let mut name = base.clone();
            let mut count = 1;
            while !taken.insert(name.clone()) {
                count += 1;
                name = format!("{base}_{count}");
            }
            signals.push(MessageSignal { name, byte, kind, scale, unit });
        }
        byte += kind.bytes();
    }
    signals
}

const fn signal_name(signal: Signal) -> &'static str {
    match signal {
        Signal::Gap => "gap",
        Signal::Controlword => "controlword",
        Signal::Mode => "mode",
        Signal::Torque => "torque",
        Signal::LegsCommand => "legs_command",
        Signal::Statusword => "statusword",
        Signal::ModeDisplay => "mode_display",
        Signal::ErrorRegister => "error_register",
        Signal::Position => "position",
        Signal::Velocity => "velocity",
        Signal::ActualTorque => "actual_torque",
        Signal::Coordinate(_) => "coordinate",
        Signal::Rate(_) => "rate",
        Signal::Heading => "heading",
        Signal::HeadingRate => "heading_rate",
        Signal::Yaw => "yaw",
        Signal::Sequence => "sequence",
        Signal::Health => "health",
        Signal::LegsState => "legs_state",
    }
}

/// What a role is called in texts.
pub(crate) const fn role_name(role: Role) -> &'static str {
    match role {
        Role::Drive => "drive",
        Role::Imu => "IMU",
        Role::Encoder => "encoder",
        Role::Legs => "legs",
    }
}
