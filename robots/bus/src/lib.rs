//! CAN buses behind one trait: in virtual time, SocketCAN, slcan on a serial port; logs and replay.
//!
//! [`Bus`] is what a master or a simulated node needs of a bus: the time, sending, receiving up to a
//! deadline. Frames are [`Frame`], which is an [`embedded_can::Frame`].
//!
//! | bus | what it is |
//! | --- | --- |
//! | [`VirtualBus`], [`Port`] | in one process and in virtual time, exact to the bit, with faults to inject |
//! | [`Slcan`] | a serial adapter that speaks LAWICEL's protocol, or a pseudo-terminal |
//! | `SocketBus` | Linux SocketCAN, with the feature `socketcan` |
//! | [`Slowed`] | another one, on which time runs slower |
//! | [`Replay`] | a log written by `candump -L` or by [`Recorded`] |
//!
//! [`Buses`] are all buses of a drive together; [`Wired`] those in real time, each opened by its
//! [`PortName`].
//!
//! Without the feature `std` (which is on by default) only [`bits`] and [`slcan::codec`] are left, for
//! microcontrollers.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

pub mod bits;
#[cfg(feature = "std")]
mod buses;
#[cfg(feature = "std")]
pub mod candump;
#[cfg(feature = "std")]
mod error;
#[cfg(feature = "std")]
mod port_name;
#[cfg(feature = "std")]
mod random;
#[cfg(all(unix, feature = "std"))]
pub mod serial;
pub mod slcan;
#[cfg(feature = "std")]
mod slowed;
#[cfg(all(feature = "socketcan", target_os = "linux"))]
mod socket;
#[cfg(feature = "std")]
mod virtual_bus;
#[cfg(all(unix, feature = "std"))]
mod wait;

#[cfg(feature = "std")]
pub use buses::{Buses, Wired};
#[cfg(feature = "std")]
pub use candump::{Recorded, Replay};
#[cfg(feature = "std")]
pub use error::BusError;
#[cfg(feature = "std")]
pub use port_name::{BAUD, PortName};
#[cfg(feature = "std")]
pub use random::Random;
pub use shapebot_drive::Frame;
#[cfg(feature = "std")]
pub use slcan::Slcan;
#[cfg(feature = "std")]
pub use slowed::Slowed;
#[cfg(all(feature = "socketcan", target_os = "linux"))]
pub use socket::SocketBus;
#[cfg(feature = "std")]
pub use virtual_bus::{
    Effect, EndpointId, Event, EventKind, Limits, Observer, Port, Rule, Select, VirtualBus,
};

#[cfg(all(unix, feature = "std"))]
use std::os::fd::BorrowedFd;

/// A frame and when it came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Received {
    /// The frame.
    pub frame: Frame,
    /// End of the frame in the time of the bus, µs.
    pub time: u64,
}

/// Error state of a CAN controller (ISO 11898-1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum ErrorState {
    /// Both error counters are below 128.
    #[default]
    Active,
    /// A counter reached 128.
    Passive,
    /// The transmit error counter passed 255: the controller takes no part in the bus.
    BusOff,
}

/// State of a controller and what it counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// Error state.
    pub state: ErrorState,
    /// Transmit error counter.
    pub transmit_errors: u32,
    /// Receive error counter.
    pub receive_errors: u32,
    /// Frames lost because nobody took them.
    pub overruns: u64,
}

/// One controller on a CAN bus.
#[cfg(feature = "std")]
pub trait Bus {
    /// Time of this bus, µs; it starts anywhere and never goes back.
    fn now(&self) -> u64;

    /// Hands a frame to the controller and does not wait until it is sent.
    ///
    /// # Errors
    ///
    /// [`BusError::QueueFull`] and [`BusError::BusOff`], after which the bus can still be used; the
    /// others of [`BusError`], after which it can not.
    fn send(&mut self, frame: &Frame) -> Result<(), BusError>;

    /// The next frame, or `None` once the bus' time has reached `deadline`, µs. A deadline in the past
    /// asks for what is there already.
    ///
    /// # Errors
    ///
    /// See [`BusError`].
    fn receive(&mut self, deadline: u64) -> Result<Option<Received>, BusError>;

    /// Error state of the controller, as far as the bus tells.
    fn health(&self) -> Health {
        Health::default()
    }

    /// What becomes readable when a frame comes; `None` unless that is all that there is to wait for.
    #[cfg(unix)]
    fn descriptor(&self) -> Option<BorrowedFd<'_>> {
        None
    }
}

#[cfg(feature = "std")]
impl<B: Bus + ?Sized> Bus for Box<B> {
    fn now(&self) -> u64 {
        (**self).now()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        (**self).send(frame)
    }

    fn receive(&mut self, deadline: u64) -> Result<Option<Received>, BusError> {
        (**self).receive(deadline)
    }

    fn health(&self) -> Health {
        (**self).health()
    }

    #[cfg(unix)]
    fn descriptor(&self) -> Option<BorrowedFd<'_>> {
        (**self).descriptor()
    }
}
