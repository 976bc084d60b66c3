//! Runtime traits of shape-accelerated balancing robots.
//!
//! Generated code, handwritten types and the interpreter implement the same three traits; the planner
//! and the controller know nothing else about a robot. `no_std`, no heap, no panic.
#![no_std]
#![forbid(unsafe_code)]

mod by_reference;
pub mod control;
mod description;
mod parameter;
mod scalar;
mod sine;
mod system;

pub use description::{
    Actuator, Coordinate, CoulombFriction, Description, Geometry, Parameter, Role, ShapeSet, Solid,
};
pub use nalgebra;
pub use parameter::ParameterError;
pub use scalar::{Ordered, Real};
pub use system::{LagrangianSystem, Motion, Response, Robot, ShapeAccelerated};

/// Includes a robot that `shapebot_codegen::Build` emitted into `OUT_DIR`.
///
/// ```text
/// shapebot_dynamics::include_model!("my_robot");
/// ```
#[macro_export]
macro_rules! include_model {
    ($name:literal) => {
        include!(concat!(env!("OUT_DIR"), "/", $name, ".rs"));
    };
}
