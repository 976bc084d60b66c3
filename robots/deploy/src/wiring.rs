//! What the page of a deployed crate says about the drive.

use crate::derived::Derived;
use serde_derive::Serialize;
use shapebot_drive::Role;
use shapebot_drive_build::{Axis, DriveDescription, Node};

/// Everything that templates may use.
#[derive(Debug, Serialize)]
pub(crate) struct Readme {
    model: String,
    summary: String,
    drive: String,
    title: String,
    fingerprint: String,
    period_ms: f64,
    period_us: u32,
    heartbeat_ms: u32,
    lean_start_deg: String,
    lean_limit_deg: String,
    has_legs: bool,
    has_yaw: bool,
    operator: Operator,
    buses: Vec<Bus>,
    nodes: Vec<Wire>,
    axes: Vec<AxisRow>,
    resolutions: Vec<String>,
    coordinates: Vec<Coordinate>,
}

#[derive(Debug, Serialize)]
struct Operator {
    bus: String,
    command: String,
    telemetry: String,
    master: u8,
}

#[derive(Debug, Serialize)]
struct Bus {
    name: String,
    kbit: u32,
    cyclic: String,
    background: String,
    last_frame_us: String,
    nodes: String,
}

#[derive(Debug, Serialize)]
struct Wire {
    name: String,
    bus: String,
    id: u8,
    role: &'static str,
    kind: String,
    receive: String,
    transmit: String,
    heartbeat_ms: u16,
    /// For drives: axis, sign and who applies it, motor radians per unit.
    axis: String,
    sign: &'static str,
    sign_in: &'static str,
    ratio: String,
    limit: String,
}

#[derive(Debug, Serialize)]
struct AxisRow {
    name: String,
    drives: String,
    limit: String,
    slew: String,
    resolution: String,
}

#[derive(Debug, Serialize)]
struct Coordinate {
    name: String,
    unit: String,
    role: &'static str,
}

impl Readme {
    pub(crate) fn new(derived: &Derived) -> Self {
        let drive = &derived.drive;
        let model = derived.tapes.description();
        let positions = model.position_count;
        let coordinates = model.coordinates.iter().enumerate().map(|(index, c)| Coordinate {
            name: c.name.to_owned(),
            unit: c.unit.to_owned(),
            role: if index < positions { "position" } else { "shape" },
        });
        let limits = &drive.safety.limits;
        let has_legs = drive.nodes.iter().any(|node| node.role == Role::Legs);
        let bus = |index: u8| drive.buses.get(usize::from(index)).map(|bus| bus.name.clone());
        Self {
            model: derived.stem.clone(),
            summary: model.summary.to_owned(),
            drive: drive.name.clone(),
            title: drive.title.clone(),
            fingerprint: format!("{:08x}", drive.fingerprint),
            period_ms: f64::from(drive.timing.period_us) * 1e-3,
            period_us: drive.timing.period_us,
            heartbeat_ms: drive.timing.heartbeat_us / 1000,
            lean_start_deg: format!("{:.1}", limits.lean_start.to_degrees()),
            lean_limit_deg: format!("{:.1}", limits.lean_limit.to_degrees()),
            has_legs,
            has_yaw: drive.yaw.is_some(),
            operator: Operator {
                bus: bus(drive.operator.bus).unwrap_or_default(),
                command: hex(drive.operator.command),
                telemetry: hex(drive.operator.telemetry),
                master: drive.operator.master.raw(),
            },
            buses: buses(drive),
            nodes: drive.nodes.iter().map(|node| wire(drive, node)).collect(),
            axes: drive.axes.iter().map(|axis| axis_row(drive, axis)).collect(),
            resolutions: drive
                .resolutions
                .iter()
                .map(|r| format!("{}: {:.3e} {} a count", r.what, r.step, r.unit))
                .collect(),
            coordinates: coordinates.collect(),
        }
    }
}

fn hex(id: u16) -> String {
    format!("0x{id:03X}")
}

fn buses(drive: &DriveDescription) -> Vec<Bus> {
    let all = drive.buses.iter().zip(&drive.loads).enumerate();
    all.map(|(index, (bus, load))| {
        let on = |node: &&Node| usize::from(node.bus) == index;
        let nodes: Vec<&str> = drive.nodes.iter().filter(on).map(|n| n.name.as_str()).collect();
        Bus {
            name: bus.name.clone(),
            kbit: bus.bit_rate / 1000,
            cyclic: format!("{:.1}", 100.0 * load.cyclic()),
            background: format!("{:.1}", 100.0 * load.background()),
            last_frame_us: format!("{:.0}", 1e6 * load.last_frame()),
            nodes: nodes.join(", "),
        }
    })
    .collect()
}

fn wire(drive: &DriveDescription, node: &Node) -> Wire {
    let ids = |pdos: &[shapebot_drive::Pdo]| {
        let ids: Vec<String> = pdos.iter().map(|pdo| hex(pdo.cob_id)).collect();
        if ids.is_empty() { "none".to_owned() } else { ids.join(" ") }
    };
    let motor = node.motor;
    let axis = motor.and_then(|motor| drive.axes.get(usize::from(motor.axis)));
    let limit = motor.map(|m| f64::from(m.torque_per_count) * f64::from(m.torque_limit));
    Wire {
        name: node.name.clone(),
        bus: drive.buses.get(usize::from(node.bus)).map(|b| b.name.clone()).unwrap_or_default(),
        id: node.id.raw(),
        role: match node.role {
            Role::Drive => "drive",
            Role::Imu => "inertial unit",
            Role::Encoder => "encoder",
            Role::Legs => "legs",
        },
        kind: node.kind.clone(),
        receive: ids(&node.receive),
        transmit: ids(&node.transmit),
        heartbeat_ms: node.heartbeat_ms,
        axis: axis.map(|axis| axis.name.clone()).unwrap_or_default(),
        sign: motor.map_or("", |m| if m.sign < 0 { "-" } else { "+" }),
        sign_in: motor.map_or("", |m| if m.sign_in_drive { "drive (0x607E)" } else { "master" }),
        ratio: motor.map(|m| format!("{:.4}", m.ratio)).unwrap_or_default(),
        limit: limit.map(|limit| format!("{limit:.3} N m")).unwrap_or_default(),
    }
}

fn axis_row(drive: &DriveDescription, axis: &Axis) -> AxisRow {
    let name = |index: &u8| drive.nodes.get(usize::from(*index)).map(|node| node.name.as_str());
    let drives: Vec<&str> = axis.drives.iter().filter_map(name).collect();
    // The unit of the coordinate: an angle is turned by N m, a length moved by N.
    let unit = if axis.unit == "m" { "N" } else { "N m" };
    AxisRow {
        name: axis.name.clone(),
        drives: drives.join(", "),
        limit: format!("{} {unit}", axis.limit),
        slew: format!("{} {unit}/s", axis.slew),
        resolution: format!("{:.4} {unit}", 1.0 / axis.counts_per_force),
    }
}
