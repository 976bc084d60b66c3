//! What the simulated nodes of a drive are made from.

use crate::check::Check;
use crate::description::{Axis, Node};
use crate::source::{Motor, NodeSource, TypeSource};
use shapebot_drive::{DataType, MotorTable, Object, Signal, object};
use std::collections::BTreeMap;

/// A node to simulate: the hardware that the description assumes.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedNode {
    /// Name.
    pub name: String,
    /// Index of its bus.
    pub bus: usize,
    /// Node-ID.
    pub id: u8,
    /// What it is.
    pub kind: SimulatedKind,
    /// Its object dictionary as it is after power-up, in the order of objects. Communication objects
    /// (0x1400, 0x1600, 0x1800, 0x1A00 and on) are there for the PDOs that the node has, unmapped.
    pub objects: Vec<DictionaryObject>,
}

/// What a node is.
#[derive(Clone, Debug, PartialEq)]
pub enum SimulatedKind {
    /// A CiA 402 drive with its motor.
    Drive(SimulatedDrive),
    /// A sensor or the legs: their objects say what they send.
    Sensor,
    /// Legs that take this long to travel, seconds.
    Legs {
        /// From up to down, or down to up, seconds.
        travel: f64,
    },
}

/// Motor, gear and encoder of a simulated drive.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedDrive {
    /// Name of the axis that it moves.
    pub axis: String,
    /// Index of the axis' coordinate in q; `None` for yaw.
    pub coordinate: Option<usize>,
    /// How it is mounted: 1 if the motor turns forward for a growing coordinate, else −1.
    pub mounting: i8,
    /// Radians of the motor per unit of the coordinate, positive: coordinate force = mounting · ratio ·
    /// motor torque.
    pub ratio: f64,
    /// Rated torque of the motor, N·m: what 1000 counts of a per-mille object mean.
    pub rated_torque: f64,
    /// Largest torque of motor and amplifier, N·m.
    pub peak_torque: f64,
    /// Torque of one count of the torque object, N·m.
    pub torque_per_count: f64,
    /// Object of the target torque.
    pub torque_object: Object,
    /// Mode of operation in which that object acts.
    pub mode: i8,
    /// Counts per revolution of the motor.
    pub counts_per_revolution: u32,
}

/// An object of a simulated node's dictionary.
#[derive(Clone, Debug, PartialEq)]
pub struct DictionaryObject {
    /// Index and sub-index.
    pub object: Object,
    /// Type.
    pub kind: DataType,
    /// Who may write it.
    pub access: Access,
    /// Value after power-up.
    pub value: i64,
    /// What it measures or commands; `None` for configuration.
    pub signal: Option<Signal>,
    /// SI value of one count of a signal (at the sensor, without the mounting of a motor), else 1.
    pub scale: f64,
}

/// Access to an object, from the bus, and whether it can be in a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Read only; cannot be mapped.
    Constant,
    /// Read and write; cannot be mapped.
    Setting,
    /// Read and write; can be in a receive PDO.
    Receive,
    /// Read only; can be in a transmit PDO.
    Transmit,
}

/// The nodes to simulate.
pub(crate) fn simulated(
    check: &Check<'_>,
    nodes: &[Node],
    axes: &[Option<Axis>],
) -> Vec<SimulatedNode> {
    let pairs = nodes.iter().zip(&check.source.nodes);
    pairs.filter_map(|(node, source)| simulate(check, node, source, axes)).collect()
}

fn simulate(
    check: &Check<'_>,
    node: &Node,
    source: &NodeSource,
    axes: &[Option<Axis>],
) -> Option<SimulatedNode> {
    let kind = check.type_of(source)?;
    let simulated = match (&node.motor, &kind.motor, &kind.travel) {
        (Some(table), Some(motor), _) => {
            let axis = axes.get(usize::from(table.axis))?.as_ref()?;
            SimulatedKind::Drive(drive(check, table, kind, motor, axis)?)
        }
        (_, _, Some(travel)) => SimulatedKind::Legs { travel: travel.value },
        _ => SimulatedKind::Sensor,
    };
    let mut objects = Objects::default();
    objects.communication(kind, source);
    objects.signals(node);
    if let Some(motor) = &kind.motor {
        objects.drive(motor);
    }
    for set in &kind.sets {
        objects.add(set.object, set.kind, Access::Setting, 0);
    }
    Some(SimulatedNode {
        name: node.name.clone(),
        bus: usize::from(node.bus),
        id: node.id.raw(),
        kind: simulated,
        objects: objects.0.into_values().collect(),
    })
}

fn drive(
    check: &Check<'_>,
    table: &MotorTable,
    kind: &TypeSource,
    motor: &Motor,
    axis: &Axis,
) -> Option<SimulatedDrive> {
    let torque_per_count = check.torque_per_count(kind, motor)?;
    let (torque_object, _) = check.entry_type(kind, Signal::Torque, "torque")?;
    Some(SimulatedDrive {
        axis: axis.name.clone(),
        coordinate: axis.coordinate.map(usize::from),
        mounting: table.sign,
        ratio: 1.0 / (axis.counts_per_force * axis.drives.len() as f64 * torque_per_count),
        rated_torque: motor.rated.value,
        peak_torque: motor.peak.value,
        torque_per_count,
        torque_object,
        mode: motor.mode,
        counts_per_revolution: motor.counts.value,
    })
}

/// An object of a PDO by the PDO's number and the sub-index.
type Place = fn(u8, u8) -> Object;

/// Objects by their place.
#[derive(Default)]
struct Objects(BTreeMap<Object, DictionaryObject>);

impl Objects {
    /// Adds an object unless it is there.
    fn add(&mut self, object: Object, kind: DataType, access: Access, value: i64) {
        let new = DictionaryObject { object, kind, access, value, signal: None, scale: 1.0 };
        self.0.entry(object).or_insert(new);
    }

    /// What every node has.
    fn communication(&mut self, kind: &TypeSource, node: &NodeSource) {
        let (id, setting) = (i64::from(node.id.value), Access::Setting);
        let profile = if kind.motor.is_some() { 0x0002_0192 } else { 0 };
        let number = |value: Option<u32>| i64::from(value.unwrap_or(0));
        for (object, value) in [
            (Object::DEVICE_TYPE, profile),
            (Object::VENDOR, number(kind.identity.vendor)),
            (Object::PRODUCT, number(kind.identity.product)),
            (Object::SERIAL, number(node.serial)),
        ] {
            self.add(object, DataType::U32, Access::Constant, value);
        }
        self.add(object(0x1018, 0), DataType::U8, Access::Constant, 4);
        self.add(Object::ERROR_REGISTER, DataType::U8, Access::Transmit, 0);
        self.add(Object::SYNC_COB_ID, DataType::U32, setting, 0x80);
        self.add(Object::CYCLE_PERIOD, DataType::U32, setting, 0);
        self.add(object(0x1014, 0), DataType::U32, setting, 0x80 + id);
        self.add(object(0x1016, 0), DataType::U8, Access::Constant, 1);
        self.add(Object::CONSUMER_HEARTBEAT, DataType::U32, setting, 0);
        self.add(Object::PRODUCER_HEARTBEAT, DataType::U16, setting, 0);
        let predefined = [0x200, 0x180];
        for (way, count) in kind.pdo_counts.into_iter().enumerate() {
            for number in 1..=count {
                let cob_id = predefined[way] + 0x100 * i64::from(number - 1) + id;
                self.pdo(way == 0, number, cob_id);
            }
        }
    }

    /// Parameters and mapping of a PDO that is switched off.
    fn pdo(&mut self, receive: bool, number: u8, cob_id: i64) {
        let (parameters, mapping): (Place, Place) = if receive {
            (Object::receive_parameters, Object::receive_mapping)
        } else {
            (Object::transmit_parameters, Object::transmit_mapping)
        };
        let setting = Access::Setting;
        self.add(parameters(number, 0), DataType::U8, Access::Constant, 5);
        self.add(parameters(number, 1), DataType::U32, setting, 1 << 31 | cob_id);
        self.add(parameters(number, 2), DataType::U8, setting, 255);
        self.add(parameters(number, 5), DataType::U16, setting, 0);
        self.add(mapping(number, 0), DataType::U8, setting, 0);
        for sub in 1..=8 {
            self.add(mapping(number, sub), DataType::U32, setting, 0);
        }
    }

    /// What is in the PDOs, at the sensor: without the sign and the ratio of a motor.
    fn signals(&mut self, node: &Node) {
        let receive = node.receive.iter().map(|pdo| (pdo, Access::Receive));
        let transmit = node.transmit.iter().map(|pdo| (pdo, Access::Transmit));
        for (pdo, access) in receive.chain(transmit) {
            for entry in pdo.entries().iter().filter(|entry| entry.signal != Signal::Gap) {
                let measured = matches!(
                    entry.signal,
                    Signal::Coordinate(_)
                        | Signal::Rate(_)
                        | Signal::Heading
                        | Signal::HeadingRate
                        | Signal::Yaw
                );
                let scale = if measured { entry.scale.into() } else { 1.0 };
                let (object, kind, signal) = (entry.object, entry.kind, Some(entry.signal));
                let new = DictionaryObject { object, kind, access, value: 0, signal, scale };
                self.0.insert(object, new);
            }
        }
    }

    /// What a CiA 402 drive has besides.
    fn drive(&mut self, motor: &Motor) {
        use DataType::{I8, I16, I32, U8, U16, U32};
        let rated = (motor.rated.value * 1e3).round() as i64;
        for (object, kind, access, value) in [
            (object(0x603F, 0), U16, Access::Transmit, 0),
            (Object::CONTROLWORD, U16, Access::Receive, 0),
            (Object::STATUSWORD, U16, Access::Transmit, 0),
            (Object::MODE, I8, Access::Receive, 0),
            (Object::MODE_DISPLAY, I8, Access::Transmit, 0),
            (Object::POSITION, I32, Access::Transmit, 0),
            (Object::VELOCITY, I32, Access::Transmit, 0),
            (Object::TARGET_TORQUE, I16, Access::Receive, 0),
            (Object::MAX_TORQUE, U16, Access::Setting, 0),
            (Object::RATED_TORQUE, U32, Access::Constant, rated),
            (Object::ACTUAL_TORQUE, I16, Access::Transmit, 0),
            (Object::POLARITY, U8, Access::Setting, 0),
            (object(0x60C2, 0), U8, Access::Constant, 2),
            (Object::INTERPOLATION_VALUE, U8, Access::Setting, 1),
            (Object::INTERPOLATION_EXPONENT, I8, Access::Setting, -3),
            // Supported modes: cyclic synchronous torque is bit 9.
            (object(0x6502, 0), U32, Access::Constant, 1 << 9),
        ] {
            self.add(object, kind, access, value);
        }
        for (object, _) in motor.reactions {
            self.add(object, I16, Access::Setting, 0);
        }
    }
}
