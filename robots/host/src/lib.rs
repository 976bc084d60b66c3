//! The control loop of a robot on Linux, around [`Runtime`](shapebot_runtime::Runtime).
//!
//! [`main`] is all of a robot's program but its robot, its gains and its drive:
//!
//! - [`Options`]: what the program is told on its command line;
//! - [`open`]: the drive's buses, SocketCAN or slcan;
//! - [`rights`]: SCHED_FIFO and locked memory, with a warning where the system does not grant them;
//! - [`Socket`]: the operator protocol on a Unix socket, beside the one on the bus;
//! - [`Service`]: the loop, with [`Deadlines`] counted.
//!
//! The loop ends safely, which is on the legs with torque off. SIGTERM and SIGINT bring the robot to rest
//! and lower its legs; a second signal, a bus that fails and a panic switch the torque off and lower the
//! legs at once. What ends the process without asking it is the drives' business: they react to the
//! heartbeat that stays away.
//!
//! Linux only: elsewhere this crate is empty.
#![forbid(unsafe_code)]
#![cfg(target_os = "linux")]

#[cfg(panic = "abort")]
compile_error!(
    "a panic must unwind, or nobody switches the torque off: remove `panic = \"abort\"`"
);

mod deadlines;
mod error;
mod options;
mod plans;
mod ports;
mod program;
pub mod rights;
mod service;
mod socket;

pub use deadlines::Deadlines;
pub use error::Error;
pub use options::{HELP, Options};
pub use plans::Plans;
pub use ports::open;
pub use program::{Robotics, main, signals};
pub use service::{Ending, Service};
pub use socket::Socket;
