//! Nodes as a drive description has them.

use shapebot_drive::{NodeId, Object, Signal};
use shapebot_drive_build::{
    Access as Described, DictionaryObject, SimulatedDrive, SimulatedKind, SimulatedNode,
};

use crate::node::ExtraObject;
use crate::{Access, Channel, DriveSettings, Mappable, NodeKind, NodeSettings, Quantity, Reading};

/// The nodes of a drive description, each with the number of its bus, as their makers would deliver
/// them; the rest is the set-up's. Drives are numbered as the plant's motors, from zero in the order of
/// the description.
#[must_use]
pub fn described(nodes: &[SimulatedNode]) -> Vec<(usize, NodeSettings)> {
    let mut motors = 0..;
    let nodes = nodes.iter().map(|node| {
        let kind = match &node.kind {
            SimulatedKind::Drive(drive) => {
                NodeKind::Drive(drive_settings(drive, node, motors.next().unwrap_or(0)))
            }
            SimulatedKind::Sensor => NodeKind::Sensor,
            SimulatedKind::Legs { travel } => NodeKind::Legs { travel_us: micros(*travel) },
        };
        let channels = node.objects.iter().filter_map(channel).collect();
        let objects = node.objects.iter().filter(|o| is_kept(o)).map(extra).collect();
        let usual = NodeSettings::new(&node.name, NodeId::clamped(node.id), kind);
        (node.bus, NodeSettings { channels, objects, ..usual })
    });
    nodes.collect()
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates")]
fn micros(seconds: f64) -> u64 {
    (seconds * 1e6).round() as u64
}

fn drive_settings(drive: &SimulatedDrive, node: &SimulatedNode, motor: usize) -> DriveSettings {
    let usual = DriveSettings::default();
    let counts = f64::from(drive.counts_per_revolution.max(1));
    let of = |at: Object| node.objects.iter().find(|object| object.object == at);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates")]
    let rated_torque = (drive.rated_torque * 1e3).round() as u32;
    DriveSettings {
        motor,
        torque_object: drive.torque_object,
        torque_kind: of(drive.torque_object).map_or(usual.torque_kind, |object| object.kind),
        torque_per_count: drive.torque_per_count,
        rated_torque,
        peak_torque: drive.peak_torque,
        counts_per_revolution: drive.counts_per_revolution,
        rate_per_count: std::f64::consts::TAU / counts,
        mode: drive.mode,
    }
}

/// Identity and what the node has besides its kind's objects: all but what is set up over SDO anyway.
fn is_kept(object: &DictionaryObject) -> bool {
    let communication = (0x1000..0x1018).contains(&object.object.index)
        || (0x1400..0x1C00).contains(&object.object.index);
    !communication && channel(object).is_none()
}

fn extra(object: &DictionaryObject) -> ExtraObject {
    let (access, mappable) = match object.access {
        Described::Constant => (Access::Constant, Mappable::No),
        Described::Setting => (Access::ReadWrite, Mappable::No),
        Described::Receive => (Access::ReadWrite, Mappable::Receive),
        Described::Transmit => (Access::Read, Mappable::Transmit),
    };
    let DictionaryObject { object, kind, value, .. } = *object;
    ExtraObject { object, kind, value, access, mappable }
}

fn channel(object: &DictionaryObject) -> Option<Channel> {
    let quantity = |quantity| Reading::Quantity { quantity, scale: object.scale };
    let reading = match object.signal? {
        Signal::Coordinate(index) => quantity(Quantity::Coordinate(usize::from(index))),
        Signal::Rate(index) => quantity(Quantity::Rate(usize::from(index))),
        Signal::Heading => quantity(Quantity::Heading),
        Signal::HeadingRate => quantity(Quantity::HeadingRate),
        Signal::Yaw => quantity(Quantity::Yaw),
        Signal::Sequence => Reading::Sequence,
        Signal::Health => Reading::Health,
        _ => return None,
    };
    Some(Channel { object: object.object, kind: object.kind, reading })
}
