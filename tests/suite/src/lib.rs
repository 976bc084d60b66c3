//! Tests across the rooms of shapebot: what they share.
//!
//! The tests themselves are in `tests/`, the measurements in `benches/`. Robots are found through
//! `shapebot_generated::for_each_robot!`, never listed by hand: a model dropped into `robots/models` is
//! tested by being there.
#![forbid(unsafe_code)]

pub mod checkout;
pub mod checks;
pub mod closed_loop;
pub mod compare;
pub mod copies;
pub mod dual;
pub mod emulator;
pub mod environment;
pub mod linear_algebra;
pub mod models;
pub mod operations;
pub mod planning;
pub mod reference;
pub mod states;
