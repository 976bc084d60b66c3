//! Specialised code of every bundled robot, generated from the model files of `shapebot-models`.
//!
//! One module per model. Each has the parameters (`Params`), the robot with parameters at run time and
//! the same with the model's own values folded in (`…Baked`), and a `DESCRIPTION`. Its page shows the
//! coordinates, parameters and equations, the proof that the robot is shape-accelerated, and how many
//! operations each function takes. [`for_each_robot!`] iterates over them.
#![no_std]
#![forbid(unsafe_code)]

include!(concat!(env!("OUT_DIR"), "/robots.rs"));
