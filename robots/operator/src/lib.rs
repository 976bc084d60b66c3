//! An operator's side of [`shapebot_drive::operator`]: commands that are waited for, telemetry that is
//! put together, and a view of it as text.
//!
//! A [`Link`] carries eight bytes either way: [`BusLink`] as frames on the robot's bus, [`SocketLink`] as
//! records of a byte stream. A [`Client`] gives orders over it; [`Telemetry`] keeps the last of each page.
#![forbid(unsafe_code)]

mod client;
mod error;
mod link;
mod telemetry;
mod view;
mod words;

pub use client::Client;
pub use error::Error;
pub use link::{BusLink, Link, SocketLink};
pub use telemetry::{Health, Status, Telemetry, Tuning, Upload};
pub use view::{line, view};
pub use words::{fault, refusal, request, state};
