//! Control of shape-accelerated balancing robots: the law that makes a robot follow a planned motion.
//!
//! [`Controller`] is generic over the runtime traits and knows no robot. Where the position variables
//! are actuated (a ballbot's drive) they balance the unactuated shape; where they are not (a marble on a
//! plate) the shape is servoed and accelerates the position. In both cases an outer loop turns position
//! errors into a compensation shape (Eq. 36), and actuated shape variables are servoed by computed
//! torque. Gains come from a [`ControlDesign`](shapebot_dynamics::control::ControlDesign), which
//! generated modules hold as `CONTROL`, and can be overridden field by field in [`Gains`].
//!
//! [`estimator`] turns encoder counts and an inertial unit's readings into the state.
//!
//! Neither standard library nor heap is needed, nothing panics, and the work of a step does not depend
//! on the state.
#![no_std]
#![forbid(unsafe_code)]

mod clamp;
mod controller;
mod error;
pub mod estimator;
mod gains;
mod law;
mod linear_algebra;
mod observer;
mod plant;
mod signal;

pub use controller::Controller;
pub use error::Error;
pub use gains::{Compensate, Gains};
pub use signal::{Command, State, Target};
