//! A robot on a test rig: the [`Runtime`](shapebot_runtime::Runtime) on its buses, against real nodes or
//! against simulated ones over a simulated plant.
//!
//! - [`Body`]: the plant of `shapebot-sim` with legs, as what the simulated motors and sensors are on.
//! - [`network`]: the drive's buses in virtual time with simulated nodes; [`BusList`] opens real ones.
//! - [`Job`] takes a robot, its drive and a plan through a task, by itself or (on Linux) under an operator.
//! - [`OnDrive`] does so with robots whose sizes are known when the program runs.
//! - [`serve`] lets a runtime work on buses; [`run`] takes it through a whole task.
//! - [`DriveSim`] is the other side in real time: simulated nodes on real or virtual interfaces.
//! - [`campaign`] injects faults in every state, and judges what follows.
#![forbid(unsafe_code)]

#[cfg(target_os = "linux")]
mod attend;
mod body;
mod bus_list;
pub mod campaign;
mod drive_sim;
mod error;
#[cfg(unix)]
mod on_drive;
mod paced;
mod serve;
mod session;
mod task;
mod world;

pub use body::{Body, Stance, Touchdown};
pub use bus_list::BusList;
pub use drive_sim::DriveSim;
pub use error::Error;
#[cfg(unix)]
pub use on_drive::{Log, OnDrive};
pub use paced::Paced;
pub use serve::serve;
pub use session::{Cycle, Outcome, Script, Stage, run};
pub use task::Job;
pub use world::{World, hold_unless_driven, log_to, network};
