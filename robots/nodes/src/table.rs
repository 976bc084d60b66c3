//! Nodes as a drive description has them.

use shapebot_drive::{DataType, DriveTable, Entry, NodeTable, Object, Role, SdoStep, Signal};

use crate::{Channel, DriveSettings, NodeKind, NodeSettings, Quantity, Reading};

/// The nodes of a drive description, each with the number of its bus, as a maker would deliver them:
/// objects, types and units; the rest is the set-up's. `travel_us` is the legs' travel time. Drives are
/// numbered as the plant's motors, from zero in the order of the table.
#[must_use]
pub fn node_settings(table: &DriveTable<'_>, travel_us: u64) -> Vec<(usize, NodeSettings)> {
    let mut motors = 0..;
    let nodes = table.nodes.iter().map(|node| {
        let kind = match node.role {
            Role::Drive => NodeKind::Drive(drive(node, motors.next().unwrap_or(0))),
            Role::Imu | Role::Encoder => NodeKind::Sensor(channels(node)),
            Role::Legs => NodeKind::Legs { travel_us },
        };
        let settings =
            NodeSettings { name: node.name.to_owned(), id: node.id, boot_us: 20_000, kind };
        (usize::from(node.bus), settings)
    });
    nodes.collect()
}

fn entry(node: &NodeTable<'_>, signal: Signal) -> Option<Entry> {
    let pdos = node.receive.iter().chain(node.transmit);
    pdos.flat_map(|pdo| pdo.entries()).find(|entry| entry.signal == signal).copied()
}

fn drive(node: &NodeTable<'_>, motor: usize) -> DriveSettings {
    let usual = DriveSettings { motor, ..DriveSettings::default() };
    let Some(table) = node.motor else { return usual };
    let torque = entry(node, Signal::Torque);
    let counts = f64::from(table.counts_per_revolution.max(1));
    // A count of velocity in the coordinate's unit, times the ratio, is one at the shaft.
    let rate = entry(node, Signal::Velocity)
        .map(|entry| f64::from(entry.scale.abs()) * f64::from(table.ratio))
        .filter(|rate| *rate > 0.0);
    DriveSettings {
        motor,
        torque_object: torque.map_or(usual.torque_object, |entry| entry.object),
        torque_kind: torque.map_or(usual.torque_kind, |entry| entry.kind),
        torque_per_count: f64::from(table.torque_per_count),
        rated_torque: written(node, Object::RATED_TORQUE).unwrap_or(usual.rated_torque),
        counts_per_revolution: table.counts_per_revolution,
        rate_per_count: rate.unwrap_or(std::f64::consts::TAU / counts),
        mode: table.mode,
    }
}

/// What the set-up writes to an object or expects in it.
fn written(node: &NodeTable<'_>, at: Object) -> Option<u32> {
    node.setup.iter().find_map(|step| match step {
        SdoStep::Write { object, value, .. } | SdoStep::Expect { object, value, .. }
            if *object == at =>
        {
            Some(*value)
        }
        _ => None,
    })
}

fn channels(node: &NodeTable<'_>) -> Vec<Channel> {
    let entries = node.transmit.iter().flat_map(|pdo| pdo.entries());
    entries.filter_map(|entry| channel(entry.object, entry.kind, *entry)).collect()
}

fn channel(object: Object, kind: DataType, entry: Entry) -> Option<Channel> {
    let quantity = |quantity| Reading::Quantity { quantity, scale: f64::from(entry.scale) };
    let reading = match entry.signal {
        Signal::Coordinate(index) => quantity(Quantity::Coordinate(usize::from(index))),
        Signal::Rate(index) => quantity(Quantity::Rate(usize::from(index))),
        Signal::Heading => quantity(Quantity::Heading),
        Signal::HeadingRate => quantity(Quantity::HeadingRate),
        Signal::Yaw => quantity(Quantity::Yaw),
        Signal::Sequence => Reading::Sequence,
        Signal::Health => Reading::Health,
        _ => return None,
    };
    Some(Channel { object, kind, reading })
}
