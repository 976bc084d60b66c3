//! CANopen master (CiA 301, CiA 402) for cyclic synchronous torque drives of balancing robots.
//!
//! Sans-I/O: frames and time in microseconds go in, frames come out; nothing is allocated, nothing waits.
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
pub use master::{Command, Counters, Master, Measurement};
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
