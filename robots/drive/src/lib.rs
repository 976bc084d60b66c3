//! CANopen master (CiA 301, CiA 402) for cyclic synchronous torque drives of balancing robots.
//!
//! Sans-I/O: frames and time in microseconds go in, frames come out; nothing is allocated, nothing waits.
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), deny(clippy::panic, clippy::unreachable))]

pub mod cia402;
pub mod crc;
mod frame;
pub mod id;
pub mod legs;
mod object;
mod table;

pub use frame::{Frame, extended, standard};
pub use id::NodeId;
pub use object::{DataType, Object, object};
pub use table::{
    AxisTable, BusTable, CommandTable, DriveTable, Entry, Field, MAX_AXES, MAX_BUSES,
    MAX_COORDINATES, MAX_ENTRIES, MAX_NODES, MAX_PAIR, MotorTable, NodeTable, OperatorTable, Pdo,
    Role, SafetyTable, SdoStep, Signal, Source, Timing, YawTable,
};

/// Cycles from one telemetry frame of the master to the next.
pub const TELEMETRY_CYCLES: u32 = 5;
