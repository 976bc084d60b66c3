//! CANopen master (CiA 301, CiA 402) for cyclic synchronous torque drives of balancing robots.
//!
//! Sans-I/O: frames and time in microseconds go in, frames come out; nothing is allocated, nothing waits,
//! nothing panics. The robot comes in as a [`DriveTable`], which `shapebot-drive-build` makes from a drive
//! description.
//!
//! - [`Master`]: boot and SDO set-up, SYNC, heartbeats both ways, emergency messages, missed inputs, the
//!   state machine of each drive, torques with limits, the yaw frame and heading hold;
//! - [`safety`]: the robot's states as a pure function, small enough to be enumerated;
//! - [`operator`]: commands, plan upload and telemetry;
//! - [`Frame`], [`id`], [`sdo`], [`cia402`], [`Object`]: what both ends of the bus share.
//!
//! Inputs are sampled at SYNC k, the controller runs, and its torques act at SYNC k + 1:
//!
//! ```
//! # use shapebot_drive::*;
//! # let lean = [];
//! # let table = DriveTable {
//! #     name: "none", robot: "none", fingerprint: 1, coordinates: 0,
//! #     timing: Timing {
//! #         period_us: 2000, input_window_us: 1000, jitter_limit_us: 2000, heartbeat_us: 50_000,
//! #         boot_timeout_us: 1_000_000, sdo_timeout_us: 50_000, sdo_retries: 2,
//! #         enable_timeout_us: 1_000_000, missed_warning: 2, missed_fault: 5,
//! #     },
//! #     buses: &[BusTable { name: "main", bit_rate: 1_000_000 }],
//! #     nodes: &[], axes: &[], commands: &[], yaw: None,
//! #     safety: SafetyTable {
//! #         lean: &lean, lean_start: 0.1, lean_limit: 0.3, lean_rate_start: 0.3, stale_fault: 5,
//! #         silent_fault: 3, rise_timeout_us: 1, lower_timeout_us: 1, fault_deadline_us: 1,
//! #     },
//! #     operator: OperatorTable {
//! #         bus: 0, command: 0x521, telemetry: 0x4A1, master: NodeId::clamped(127),
//! #     },
//! # };
//! let mut master = Master::new(&table);
//! let mut sent = Vec::new();
//! for now in [0, 500, 1000, 1500, 2000] {
//!     // With each frame that came: master.receive(bus, &frame, now);
//!     master.poll(now, &mut |bus, frame| sent.push((bus, frame)));
//!     if master.inputs_due(now) {
//!         let measurement = master.measure(now);
//!         let forces = [0.0]; // the controller's, from the measurement
//!         # let _ = measurement.position(0);
//!         master.command(&Command::new(&forces), now, &mut |bus, frame| sent.push((bus, frame)));
//!     }
//! }
//! // Two SYNCs, and a heartbeat of the master.
//! assert_eq!(sent.iter().filter(|(_, frame)| frame.standard_id() == Some(0x080)).count(), 2);
//! assert_eq!(master.state(), safety::State::LegsDown);
//! ```
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), deny(clippy::panic, clippy::unreachable))]

pub mod cia402;
pub mod crc;
mod fault;
mod frame;
pub mod id;
mod jitter;
pub mod legs;
mod master;
mod object;
pub mod operator;
pub mod safety;
pub mod sdo;
mod table;
mod yaw;

pub use fault::{Fault, FaultRecord, Faults};
pub use frame::{Frame, extended, standard};
pub use id::NodeId;
pub use jitter::Jitter;
pub use master::{
    Command, Count, Counters, Master, Measurement, Outputs, Reader, Readings, Writer,
};
pub use object::{DataType, Object, object};
pub use table::{
    AxisTable, BusTable, CommandTable, DriveTable, Entry, Field, MAX_AXES, MAX_BUSES, MAX_COMMANDS,
    MAX_COORDINATES, MAX_ENTRIES, MAX_NODES, MAX_PAIR, MotorTable, NodeTable, OperatorTable, Pdo,
    Role, SafetyTable, SdoStep, Signal, Source, Timing, YawTable,
};
pub use yaw::{HeadingHold, Rotation, wrapped};

/// Cycles from one telemetry frame of the master to the next.
pub const TELEMETRY_CYCLES: u32 = 5;

/// Cycles after which the master repeats a frame that is else sent when its content changes.
pub const REPEAT_CYCLES: u32 = 16;
