//! A shapebot model behind the runtime traits without compiling it.
//!
//! What [`shapebot_codegen::derive`] derives from a model is executed directly: each function becomes a
//! tape, a list of instructions over a register file, with the parameters' values bound, what depends
//! on parameters alone folded, and the registers of dead values used again. A call allocates nothing.
//! Sines and cosines come from the same library as in emitted code, so that both agree closely.
//!
//! - [`Tapes`]: all functions of a model of any size, results as flat lists;
//! - [`Interpreted`]: the runtime traits of [`shapebot_dynamics`] on top, sizes known at compile time;
//! - [`with_interpreted!`]: picks the sizes of a model among those compiled in.
#![forbid(unsafe_code)]

mod compile;
mod constant;
mod describe;
mod dispatch;
mod error;
mod interpreted;
mod order;
mod parameters;
mod tape;
mod tapes;
#[cfg(test)]
mod tests;

pub use dispatch::sizes;
pub use error::Error;
pub use interpreted::Interpreted;
pub use parameters::check_parameters;
pub use tape::State;
pub use tapes::{Block, Tapes};
