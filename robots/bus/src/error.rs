//! What can go wrong on a bus.

use std::{fmt, io};

/// Why a frame could not be sent or received, or a bus not be opened.
#[derive(Debug)]
#[non_exhaustive]
pub enum BusError {
    /// The transmit queue holds as many frames as it may.
    QueueFull {
        /// Frames that wait.
        waiting: usize,
    },
    /// The controller is bus-off: its transmit error counter passed 255.
    BusOff,
    /// No such endpoint is attached to the bus.
    UnknownEndpoint(usize),
    /// The frame is of a kind that this bus does not carry.
    Unsupported(&'static str),
    /// The other side closed the connection.
    Closed(String),
    /// The machine lacks what the bus needs.
    Unavailable {
        /// The bus that was asked for.
        bus: String,
        /// What is missing and where it can be had.
        why: String,
    },
    /// The system refused.
    Io {
        /// What was being done, to what.
        place: String,
        /// The system's error.
        source: io::Error,
    },
}

impl BusError {
    /// An error of the system with what was being done.
    pub(crate) fn io(place: impl Into<String>, source: io::Error) -> Self {
        Self::Io { place: place.into(), source }
    }
}

impl fmt::Display for BusError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::QueueFull { waiting } => {
                write!(f, "the transmit queue is full: {waiting} frames wait")
            }
            Self::BusOff => write!(f, "the controller is bus-off"),
            Self::UnknownEndpoint(index) => write!(f, "the bus has no endpoint {index}"),
            Self::Unsupported(what) => write!(f, "this bus does not carry {what}"),
            Self::Closed(place) => write!(f, "{place}: closed by the other side"),
            Self::Unavailable { bus, why } => write!(f, "{bus}: {why}"),
            Self::Io { place, source } => write!(f, "{place}: {source}"),
        }
    }
}

impl std::error::Error for BusError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}

impl embedded_can::Error for BusError {
    fn kind(&self) -> embedded_can::ErrorKind {
        match self {
            Self::QueueFull { .. } => embedded_can::ErrorKind::Overrun,
            _ => embedded_can::ErrorKind::Other,
        }
    }
}
