//! Simulated CANopen nodes: CiA 402 drives, IMU, encoders and legs over a plant.
//!
//! A [`Node`] is sans-I/O: frames and time in, frames out. It knows nothing of the master's tables but
//! what a maker of drives would build: objects, their types and units, the motor. All else (PDO mapping,
//! heartbeats, deadlines, limits) is written to it over SDO, with the checks and abort codes of CiA 301.
//! [`Network`] puts nodes, plant and [`VirtualBus`](shapebot_bus::VirtualBus) together and is a bus for
//! the master; [`Attached`] puts nodes and plant on any other bus in real time.
//!
//! Inputs are sampled at SYNC k; torque that arrives after SYNC k acts at SYNC k + 1.
#![forbid(unsafe_code)]

mod abort;
mod attached;
mod cia402;
#[cfg(feature = "description")]
mod described;
mod device;
mod dictionary;
#[cfg(feature = "description")]
mod drive_unit;
mod legs;
mod network;
mod node;
mod pdo;
mod plant;
mod sdo;
mod sensor;

pub use abort::Abort;
pub use attached::Attached;
pub use cia402::{CYCLIC_SYNCHRONOUS_TORQUE, DriveSettings, PowerState};
#[cfg(feature = "description")]
pub use described::described;
pub use device::NmtState;
pub use dictionary::{Access, Dictionary, Mappable, Value, Variable};
#[cfg(feature = "description")]
pub use drive_unit::{DriveUnit, Mechanism, YawAxis};
pub use network::Network;
pub use node::{ExtraObject, Node, NodeFault, NodeKind, NodeSettings};
pub use plant::{Motion, Physical, Plant, Quantity, Rotors};
pub use sensor::{Channel, Reading};
