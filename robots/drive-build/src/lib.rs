//! Drive descriptions: TOML in; checked plain data, Rust tables, DBC, bus load, SDO set-up and simulated
//! nodes out.
//!
//! The schema is documented in `shapebot-drives`. [`read`] checks a description against the model that
//! it drives and reports everything that is wrong at once, each with line, key and figure.
#![forbid(unsafe_code)]

mod check;
mod codec;
mod dbc;
mod description;
mod emit;
mod error;
mod load;
mod message;
mod reader;
mod report;
mod simulation;
mod source;
mod unit;

pub use check::read;
pub use description::{Axis, Bus, Command, DriveDescription, Node, Resolution, Safety, Tables};
pub use error::{Error, Errors, Said, Spot};
pub use load::{BusLoad, LoadFrame, Rate, worst_bits};
pub use message::{Message, MessageSignal};
pub use simulation::{Access, DictionaryObject, SimulatedDrive, SimulatedKind, SimulatedNode};
pub use source::Source;
