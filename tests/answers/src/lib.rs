//! Nodes that answer what a master wants to hear, and tables of bundled drives as constants.
//!
//! [`Nodes`] brings a [`Master`](shapebot_drive::Master) through boot, set-up and enabling without
//! dictionaries, buses or a plant: it knows the master's own table. For tests that run where the
//! simulated nodes cannot (a microcontroller) or that want to be fast (a fuzz target). It proves nothing
//! about set-up; the simulated nodes and foreign ones do.
#![no_std]
#![forbid(unsafe_code)]

mod nodes;

pub use nodes::Nodes;

include!(concat!(env!("OUT_DIR"), "/drives.rs"));
