//! What a drive description becomes: plain tables, usable in `const`.
//!
//! `shapebot-drive-build` checks a description and writes these tables; nothing here is checked again.
//! Angles are radians, lengths metres, forces N·m or N, times microseconds unless the name says so.

use crate::id::NodeId;
use crate::master::{Reader, Writer};
use crate::object::{DataType, Object};

/// Largest number of nodes of a drive.
pub const MAX_NODES: usize = 16;
/// Largest number of axes.
pub const MAX_AXES: usize = 8;
/// Largest number of drives on one axis.
pub const MAX_PAIR: usize = 4;
/// Largest number of coordinates of a model.
pub const MAX_COORDINATES: usize = 12;
/// Largest number of buses.
pub const MAX_BUSES: usize = 2;
/// Largest number of frames that the master sends.
pub const MAX_COMMANDS: usize = 32;
/// Largest number of entries of a PDO: eight bytes.
pub const MAX_ENTRIES: usize = 8;

/// A robot's drive: all that the master knows of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveTable<'a> {
    /// Name of the description.
    pub name: &'a str,
    /// Name of the model.
    pub robot: &'a str,
    /// Changes whenever the tables do: CRC-32 of the normalised description.
    pub fingerprint: u32,
    /// Number of coordinates of the model, q = \[q_x, q_s\].
    pub coordinates: u8,
    /// Periods and deadlines.
    pub timing: Timing,
    /// Buses.
    pub buses: &'a [BusTable<'a>],
    /// Nodes, in the order in which they are set up.
    pub nodes: &'a [NodeTable<'a>],
    /// Axes: those of the model's actuated coordinates, in the order of q, then yaw.
    pub axes: &'a [AxisTable<'a>],
    /// Frames that the master sends: the nodes' receive PDOs.
    pub commands: &'a [CommandTable<'a>],
    /// The yaw axis.
    pub yaw: Option<YawTable>,
    /// Limits of the safety logic.
    pub safety: SafetyTable<'a>,
    /// Identifiers of the operator protocol.
    pub operator: OperatorTable,
}

/// Periods and deadlines, µs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// From SYNC to SYNC: 0x1006.
    pub period_us: u32,
    /// From SYNC until inputs count as missing.
    pub input_window_us: u32,
    /// From SYNC to SYNC: deviation that is a fault.
    pub jitter_limit_us: u32,
    /// From heartbeat to heartbeat of the master.
    pub heartbeat_us: u32,
    /// From power-up or reset of a node to its boot-up message.
    pub boot_timeout_us: u32,
    /// From an SDO request to its answer.
    pub sdo_timeout_us: u32,
    /// Repetitions of an SDO request without an answer.
    pub sdo_retries: u8,
    /// From "enable" to all drives in "operation enabled".
    pub enable_timeout_us: u32,
    /// Cycles without a TPDO after which a warning is counted.
    pub missed_warning: u8,
    /// Cycles without a TPDO after which it is a fault.
    pub missed_fault: u8,
}

/// A bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BusTable<'a> {
    /// Name.
    pub name: &'a str,
    /// Bits per second.
    pub bit_rate: u32,
}

/// What a node is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A CiA 402 drive.
    Drive,
    /// Lean and its rate.
    Imu,
    /// An encoder without a drive.
    Encoder,
    /// The legs.
    Legs,
}

/// A node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeTable<'a> {
    /// Name.
    pub name: &'a str,
    /// Index into [`DriveTable::buses`].
    pub bus: u8,
    /// Node-ID.
    pub id: NodeId,
    /// What it is for.
    pub role: Role,
    /// Its heartbeat producer time, ms: 0x1017.
    pub heartbeat_ms: u16,
    /// From heartbeat to heartbeat, at most.
    pub heartbeat_timeout_us: u32,
    /// What is written to it, and expected of it, before it is started, in this order.
    pub setup: &'a [SdoStep],
    /// Its receive PDOs, for who simulates it; the master sends [`DriveTable::commands`].
    pub receive: &'a [Pdo],
    /// Its transmit PDOs.
    pub transmit: &'a [Pdo],
    /// Motor and sensor of a drive.
    pub motor: Option<MotorTable>,
}

/// Motor and sensor of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorTable {
    /// Index into [`DriveTable::axes`].
    pub axis: u8,
    /// Sign of the motor's rotation for a growing coordinate.
    pub sign: i8,
    /// Whether the drive applies the sign itself (0x607E): then its numbers are those of the axis.
    pub sign_in_drive: bool,
    /// Torque at the motor's shaft for one count of the torque object, N·m.
    pub torque_per_count: f32,
    /// Largest magnitude of the torque object, counts: 0x6072 in the object's unit.
    pub torque_limit: i32,
    /// Counts of the position object per revolution of the motor.
    pub counts_per_revolution: u32,
    /// Radians of the motor per unit of the coordinate, positive.
    pub ratio: f32,
    /// Mode of operation: 10 is cyclic synchronous torque.
    pub mode: i8,
}

impl MotorTable {
    /// Sign that the master applies.
    #[must_use]
    pub const fn master_sign(&self) -> i8 {
        if self.sign_in_drive { 1 } else { self.sign }
    }
}

/// A step of the set-up by SDO, expedited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SdoStep {
    /// Writes a value.
    Write {
        /// Where.
        object: Object,
        /// Type on the bus.
        kind: DataType,
        /// Little-endian two's complement.
        value: u32,
    },
    /// Reads a value and compares: otherwise the set-up fails.
    Expect {
        /// Where.
        object: Object,
        /// Type on the bus.
        kind: DataType,
        /// Bits that are compared.
        mask: u32,
        /// What they must be.
        value: u32,
    },
}

impl SdoStep {
    /// Writes a value.
    #[must_use]
    pub const fn write(object: Object, kind: DataType, value: u32) -> Self {
        Self::Write { object, kind, value }
    }

    /// Demands a value of the bits of a mask.
    #[must_use]
    pub const fn expect(object: Object, kind: DataType, mask: u32, value: u32) -> Self {
        Self::Expect { object, kind, mask, value }
    }
}

/// A PDO of a node. Two are equal if they say the same: a [`Reader`] adds nothing to that.
#[derive(Clone, Copy)]
pub struct Pdo {
    /// Identifier.
    pub cob_id: u16,
    /// Number of the PDO in the node, from 1.
    pub number: u8,
    /// Transmission type: 1 to 240 synchronous, 255 event-driven.
    pub transmission: u8,
    len: u8,
    size: u8,
    entries: [Entry; MAX_ENTRIES],
    reader: Option<Reader>,
}

impl PartialEq for Pdo {
    fn eq(&self, other: &Self) -> bool {
        let key = |pdo: &Self| (pdo.cob_id, pdo.number, pdo.transmission);
        key(self) == key(other) && self.entries() == other.entries()
    }
}

/// What it says, however it is kept: fingerprints of drives are made of this.
impl core::fmt::Debug for Pdo {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Pdo")
            .field("cob_id", &self.cob_id)
            .field("number", &self.number)
            .field("transmission", &self.transmission)
            .field("entries", &self.entries())
            .finish()
    }
}

impl Pdo {
    /// A PDO with at most eight entries.
    #[must_use]
    pub const fn new(cob_id: u16, number: u8, transmission: u8, entries: &[Entry]) -> Self {
        let mut own = [Entry::gap(DataType::U8); MAX_ENTRIES];
        let (mut len, mut size) = (0, 0);
        let mut rest = entries;
        while let Some((entry, tail)) = rest.split_first() {
            let Some((_, after)) = own.split_at_mut_checked(len) else { break };
            let Some(place) = after.first_mut() else { break };
            *place = *entry;
            size += entry.kind.bytes();
            len += 1;
            rest = tail;
        }
        let (len, size) = (len as u8, size as u8);
        Self { cob_id, number, transmission, len, size, entries: own, reader: None }
    }

    /// The same, read by code that was made from its entries.
    #[must_use]
    pub const fn read_by(self, reader: Reader) -> Self {
        Self { reader: Some(reader), ..self }
    }

    /// Straight-line code that reads it.
    #[must_use]
    pub const fn reader(&self) -> Option<Reader> {
        self.reader
    }

    /// The same without such code: the master goes through its entries.
    #[must_use]
    pub const fn interpreted(self) -> Self {
        Self { reader: None, ..self }
    }

    /// What it holds, from its first byte.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        self.entries.get(..usize::from(self.len)).unwrap_or(&self.entries)
    }

    /// Bytes of the frame.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        self.size as usize
    }

    /// Whether it goes with SYNC.
    #[must_use]
    pub const fn is_synchronous(&self) -> bool {
        self.transmission <= 240
    }
}

/// An object in a PDO.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Object of the node, or a type's own object: a gap.
    pub object: Object,
    /// Type on the bus.
    pub kind: DataType,
    /// What it is for the master.
    pub signal: Signal,
    /// SI value of one count, with the sign that turns the node's direction into that of the signal.
    pub scale: f32,
}

impl Entry {
    /// An object in a PDO.
    #[must_use]
    pub const fn new(object: Object, kind: DataType, signal: Signal, scale: f32) -> Self {
        Self { object, kind, signal, scale }
    }

    /// Bytes that nobody reads (dummy mapping).
    #[must_use]
    pub const fn gap(kind: DataType) -> Self {
        Self { object: kind.dummy(), kind, signal: Signal::Gap, scale: 0.0 }
    }
}

/// What a number in a PDO is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// Nothing.
    Gap,
    /// Controlword, to a drive.
    Controlword,
    /// Mode of operation, to a drive.
    Mode,
    /// Target torque, to a drive: N·m at the motor.
    Torque,
    /// Command to the legs: see [`LegsCommand`](crate::legs::LegsCommand).
    LegsCommand,
    /// Statusword of a drive.
    Statusword,
    /// Mode of operation that is active in a drive.
    ModeDisplay,
    /// Error register, 0x1001.
    ErrorRegister,
    /// Position of a drive's axis: the coordinate's unit.
    Position,
    /// Rate of a drive's axis.
    Velocity,
    /// Torque of a drive's motor, N·m.
    ActualTorque,
    /// A measured coordinate of the model, by its index in q.
    Coordinate(u8),
    /// Its rate.
    Rate(u8),
    /// Heading of the body against the floor, rad.
    Heading,
    /// Its rate, rad/s.
    HeadingRate,
    /// Angle of the drive unit against the body, rad.
    Yaw,
    /// Counter that grows by one with each sample.
    Sequence,
    /// Health of a sensor: zero is sound.
    Health,
    /// State of the legs: see [`LegsState`](crate::legs::LegsState).
    LegsState,
}

/// An axis: one generalised coordinate and the drives that share it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisTable<'a> {
    /// Name of the coordinate, or of the yaw axis.
    pub name: &'a str,
    /// Index in q; `None` for yaw.
    pub coordinate: Option<u8>,
    /// Index of its force among the model's actuators; `None` for yaw.
    pub force: Option<u8>,
    /// Indices into [`DriveTable::nodes`]: each gets the same share.
    pub drives: &'a [u8],
    /// Whether the robot falls without this axis.
    pub balances: bool,
    /// Counts of each drive's torque object per N·m (or N) at the coordinate.
    pub counts_per_force: f32,
    /// Largest magnitude of the force, N·m or N.
    pub limit: f32,
    /// Largest change of the force, N·m/s or N/s.
    pub slew: f32,
    /// Largest difference of the coordinate between two drives of the axis, since enabling.
    pub pair_tolerance: f32,
}

/// A frame of the master to one or several nodes. Two are equal if they say the same: a [`Writer`] adds
/// nothing to that.
#[derive(Clone, Copy)]
pub struct CommandTable<'a> {
    /// Index into [`DriveTable::buses`].
    pub bus: u8,
    /// Identifier.
    pub cob_id: u16,
    /// Sent in each cycle; else when its content changes.
    pub cyclic: bool,
    /// What it holds, from its first byte.
    pub fields: &'a [Field],
    /// Straight-line code that fills it, made from the fields; without, the master goes through them.
    pub writer: Option<Writer>,
}

impl PartialEq for CommandTable<'_> {
    fn eq(&self, other: &Self) -> bool {
        let key = |command: &Self| (command.bus, command.cob_id, command.cyclic);
        key(self) == key(other) && self.fields == other.fields
    }
}

/// What it says, however it is written.
impl core::fmt::Debug for CommandTable<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("CommandTable")
            .field("bus", &self.bus)
            .field("cob_id", &self.cob_id)
            .field("cyclic", &self.cyclic)
            .field("fields", &self.fields)
            .finish()
    }
}

/// A number in a frame of the master.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Type on the bus.
    pub kind: DataType,
    /// What it is.
    pub source: Source,
}

/// What the master puts into a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Zero.
    Zero,
    /// Controlword of a node.
    Controlword {
        /// Index into [`DriveTable::nodes`].
        node: u8,
    },
    /// Mode of operation of a node.
    Mode {
        /// Index into [`DriveTable::nodes`].
        node: u8,
    },
    /// Torque of an axis' drives, times a sign.
    Torque {
        /// Index into [`DriveTable::axes`].
        axis: u8,
        /// 1 or −1.
        sign: i8,
    },
    /// Command to the legs.
    Legs,
}

/// The yaw axis and the frame that it turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct YawTable {
    /// Index into [`DriveTable::axes`] of the drive that turns the body against the drive unit.
    pub axis: Option<u8>,
    /// Axes along x and y of the drive unit: forces rotate into it, rates out of it.
    pub plane: [u8; 2],
    /// Heading hold: torque per radian of heading error, N·m/rad.
    pub stiffness: f32,
    /// Heading hold: torque per rate, N·m·s/rad.
    pub damping: f32,
    /// Largest rate of the commanded heading, rad/s.
    pub rate_limit: f32,
}

/// Limits of the safety logic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafetyTable<'a> {
    /// Indices in q of the coordinates that are lean: unactuated shape coordinates.
    pub lean: &'a [u8],
    /// Largest lean at which drives are enabled, rad.
    pub lean_start: f32,
    /// Largest lean while balancing, rad: beyond it is a fault.
    pub lean_limit: f32,
    /// Largest lean rate at which drives are enabled, rad/s.
    pub lean_rate_start: f32,
    /// Samples of a sensor that may be older than one cycle before it is a fault.
    pub stale_fault: u8,
    /// Cycles in a row without a torque command of the controller before it is a fault.
    pub silent_fault: u8,
    /// From retracting legs to legs up.
    pub rise_timeout_us: u32,
    /// From lowering legs to legs down, sound.
    pub lower_timeout_us: u32,
    /// From a fault with usable drives to torque zero, at the latest.
    pub fault_deadline_us: u32,
}

/// Identifiers of the operator protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OperatorTable {
    /// Index into [`DriveTable::buses`].
    pub bus: u8,
    /// Commands to the master.
    pub command: u16,
    /// Telemetry of the master.
    pub telemetry: u16,
    /// Node-ID of the master: its heartbeat.
    pub master: NodeId,
}
