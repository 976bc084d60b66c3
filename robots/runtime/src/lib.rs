//! The control step of a robot on its buses: frames and time in microseconds go in, frames come out.
//!
//! [`Runtime`] puts together the [`Master`](shapebot_drive::Master) of the drive, the
//! [`Controller`](shapebot_control::Controller) and a plan. Once a cycle it decodes what encoders and
//! inertial unit sent, makes a state of it, finds what is wanted now, asks the controller for forces and
//! hands them to the master, which limits, allocates and encodes them.
//!
//! What the controller does follows the safety state:
//!
//! | state | controller |
//! | --- | --- |
//! | no torque | reset in each cycle |
//! | rising | holds the place where it was enabled; no integrals, no observers: the legs may still stand |
//! | balancing | lean and velocity; the position is free |
//! | station keeping, yawing | goes to rest and stays; near the start of a plan it goes there |
//! | tracking | the plan, from the SYNC at which the state was entered |
//! | legs lowering, also after a fault | goes to rest |
//!
//! Nothing is allocated, nothing waits, nothing panics.
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), deny(clippy::panic, clippy::unreachable))]

mod error;
mod polynomial;
mod runtime;
mod sensing;
mod settings;
mod stand;
mod tuning;

pub use error::Error;
pub use runtime::{Runtime, Snapshot};
pub use settings::Settings;
pub use tuning::{TUNABLE, Tunable};
