//! slcan: CAN over a serial port in LAWICEL's ASCII protocol.
//!
//! [`Slcan`] is the host's side: the bus behind an adapter. [`Adapter`] is the adapter's side, so that
//! another program, or firmware, can talk to simulated nodes through a pseudo-terminal.

#[cfg(feature = "std")]
mod adapter;
pub mod codec;
#[cfg(feature = "std")]
mod host;
#[cfg(feature = "std")]
mod lines;

#[cfg(feature = "std")]
pub use adapter::Adapter;
#[cfg(feature = "std")]
pub use host::Slcan;
#[cfg(feature = "std")]
pub use lines::{Sleeping, Wait};
