//! A checked description, as plain data.

use crate::load::BusLoad;
use crate::simulation::SimulatedNode;
use shapebot_drive::{
    AxisTable, BusTable, CommandTable, DriveTable, Field, MotorTable, NodeId, NodeTable,
    OperatorTable, Pdo, Role, SafetyTable, SdoStep, Timing, YawTable,
};

/// A checked drive description.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveDescription {
    /// The file's stem.
    pub name: String,
    /// Title, for people.
    pub title: String,
    /// Name of the model.
    pub robot: String,
    /// Names of the model's coordinates, q = \[q_x, q_s\], and their SI units.
    pub coordinates: Vec<(String, String)>,
    /// CRC-32 of all that the master is told.
    pub fingerprint: u32,
    /// Periods and deadlines.
    pub timing: Timing,
    /// Buses.
    pub buses: Vec<Bus>,
    /// Nodes.
    pub nodes: Vec<Node>,
    /// Axes: those of the actuated coordinates in the order of q, then yaw.
    pub axes: Vec<Axis>,
    /// Frames of the master.
    pub commands: Vec<Command>,
    /// The yaw axis.
    pub yaw: Option<YawTable>,
    /// Limits of the safety logic.
    pub safety: Safety,
    /// Identifiers of the operator protocol.
    pub operator: OperatorTable,
    /// Worst-case load of each bus.
    pub loads: Vec<BusLoad>,
    /// What a count of each sensor and motor is worth.
    pub resolutions: Vec<Resolution>,
    /// The nodes to simulate, one for each of [`Self::nodes`].
    pub simulated: Vec<SimulatedNode>,
}

/// A bus.
#[derive(Clone, Debug, PartialEq)]
pub struct Bus {
    /// Name.
    pub name: String,
    /// Bits per second.
    pub bit_rate: u32,
    /// Largest load that is accepted, 0 to 1.
    pub load_limit: f64,
}

/// A node: see [`NodeTable`].
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Name.
    pub name: String,
    /// Name of its type.
    pub kind: String,
    /// Index of its bus.
    pub bus: u8,
    /// Node-ID.
    pub id: NodeId,
    /// What it is for.
    pub role: Role,
    /// Heartbeat producer time, ms.
    pub heartbeat_ms: u16,
    /// From heartbeat to heartbeat at most, µs.
    pub heartbeat_timeout_us: u32,
    /// Set-up by SDO.
    pub setup: Vec<SdoStep>,
    /// Receive PDOs.
    pub receive: Vec<Pdo>,
    /// Transmit PDOs.
    pub transmit: Vec<Pdo>,
    /// Motor and encoder of a drive.
    pub motor: Option<MotorTable>,
}

/// An axis: see [`AxisTable`].
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Name.
    pub name: String,
    /// SI unit of the coordinate.
    pub unit: String,
    /// Index in q.
    pub coordinate: Option<u8>,
    /// Index among the model's actuators.
    pub force: Option<u8>,
    /// Indices of its drives' nodes.
    pub drives: Vec<u8>,
    /// Whether the robot falls without this axis.
    pub balances: bool,
    /// Counts of each drive's torque object per N·m (or N) at the coordinate.
    pub counts_per_force: f64,
    /// Largest force, N·m or N.
    pub limit: f64,
    /// Largest change of the force, per second.
    pub slew: f64,
    /// Largest difference between drives, in the coordinate's unit.
    pub pair_tolerance: f64,
}

/// A frame of the master: see [`CommandTable`].
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// Name, for people.
    pub name: String,
    /// Index of its bus.
    pub bus: u8,
    /// Identifier.
    pub cob_id: u16,
    /// Sent in each cycle.
    pub cyclic: bool,
    /// Content.
    pub fields: Vec<Field>,
}

impl Command {
    /// Bytes of the frame.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.fields.iter().map(|field| field.kind.bytes()).sum()
    }
}

/// Limits of the safety logic: see [`SafetyTable`].
#[derive(Clone, Debug, PartialEq)]
pub struct Safety {
    /// Indices in q of lean.
    pub lean: Vec<u8>,
    /// The numbers; its `lean` is empty.
    pub limits: SafetyTable<'static>,
}

/// What one count is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolution {
    /// What: `torque of theta_x`.
    pub what: String,
    /// One count, SI.
    pub step: f64,
    /// SI unit.
    pub unit: String,
    /// Largest magnitude that the object holds, SI.
    pub range: f64,
    /// Largest step that was asked for, SI.
    pub wanted: Option<f64>,
}

/// The parts of a [`DriveTable`] that hold references; made by [`DriveDescription::tables`].
#[derive(Clone, Debug)]
pub struct Tables<'a> {
    description: &'a DriveDescription,
    buses: Vec<BusTable<'a>>,
    nodes: Vec<NodeTable<'a>>,
    axes: Vec<AxisTable<'a>>,
    commands: Vec<CommandTable<'a>>,
}

impl DriveDescription {
    /// Owner of the table's parts: `description.tables().table()`.
    #[must_use]
    pub fn tables(&self) -> Tables<'_> {
        Tables {
            description: self,
            buses: self
                .buses
                .iter()
                .map(|bus| BusTable { name: &bus.name, bit_rate: bus.bit_rate })
                .collect(),
            nodes: self.nodes.iter().map(Node::table).collect(),
            axes: self.axes.iter().map(Axis::table).collect(),
            commands: self.commands.iter().map(Command::table).collect(),
        }
    }

    /// The index of a node by its name.
    #[must_use]
    pub fn node(&self, name: &str) -> Option<usize> {
        self.nodes.iter().position(|node| node.name == name)
    }
}

impl Tables<'_> {
    /// What the master is given.
    #[must_use]
    pub fn table(&self) -> DriveTable<'_> {
        let from = self.description;
        DriveTable {
            name: &from.name,
            robot: &from.robot,
            fingerprint: from.fingerprint,
            coordinates: from.coordinates.len() as u8,
            timing: from.timing,
            buses: &self.buses,
            nodes: &self.nodes,
            axes: &self.axes,
            commands: &self.commands,
            yaw: from.yaw,
            safety: SafetyTable { lean: &from.safety.lean, ..from.safety.limits },
            operator: from.operator,
        }
    }
}

impl Node {
    fn table(&self) -> NodeTable<'_> {
        NodeTable {
            name: &self.name,
            bus: self.bus,
            id: self.id,
            role: self.role,
            heartbeat_ms: self.heartbeat_ms,
            heartbeat_timeout_us: self.heartbeat_timeout_us,
            setup: &self.setup,
            receive: &self.receive,
            transmit: &self.transmit,
            motor: self.motor,
        }
    }
}

impl Axis {
    fn table(&self) -> AxisTable<'_> {
        AxisTable {
            name: &self.name,
            coordinate: self.coordinate,
            force: self.force,
            drives: &self.drives,
            balances: self.balances,
            counts_per_force: self.counts_per_force as f32,
            limit: self.limit as f32,
            slew: self.slew as f32,
            pair_tolerance: self.pair_tolerance as f32,
        }
    }
}

impl Command {
    fn table(&self) -> CommandTable<'_> {
        let (bus, cob_id, cyclic) = (self.bus, self.cob_id, self.cyclic);
        CommandTable { bus, cob_id, cyclic, fields: &self.fields, writer: None }
    }
}
