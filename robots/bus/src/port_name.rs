//! Ports of the system by name.

#[cfg(unix)]
use crate::Slcan;
#[cfg(unix)]
use crate::serial::Serial;
use crate::{Bus, BusError};
use std::path::{Path, PathBuf};

/// Baud rate of serial adapters; those on USB do not care.
pub const BAUD: u32 = 115_200;

/// Where a bus is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PortName {
    /// A SocketCAN interface.
    Interface(String),
    /// A serial adapter that speaks slcan.
    Serial(PathBuf),
}

impl From<&str> for PortName {
    /// A name with a slash is a path, any other that of an interface.
    fn from(text: &str) -> Self {
        if text.contains('/') {
            Self::Serial(text.into())
        } else {
            Self::Interface(text.to_owned())
        }
    }
}

impl PortName {
    /// Opens the port; `bit_rate`, 1/s, is for adapters: an interface has its own.
    ///
    /// # Errors
    ///
    /// What the system says; [`BusError::Unavailable`] for a kind of port that this build does not have.
    pub fn open(&self, bit_rate: u32) -> Result<Box<dyn Bus>, BusError> {
        match self {
            Self::Interface(name) => interface(name),
            Self::Serial(path) => serial(path, bit_rate),
        }
    }
}

#[cfg(all(feature = "socketcan", target_os = "linux"))]
fn interface(name: &str) -> Result<Box<dyn Bus>, BusError> {
    Ok(Box::new(crate::SocketBus::open(name)?))
}

#[cfg(not(all(feature = "socketcan", target_os = "linux")))]
fn interface(name: &str) -> Result<Box<dyn Bus>, BusError> {
    let why = "built without SocketCAN (feature `socketcan`, on Linux)".to_owned();
    Err(BusError::Unavailable { bus: name.to_owned(), why })
}

#[cfg(unix)]
fn serial(path: &Path, bit_rate: u32) -> Result<Box<dyn Bus>, BusError> {
    let port = Serial::open(path, BAUD)?;
    Ok(Box::new(Slcan::open(port, &path.display().to_string(), bit_rate)?))
}

#[cfg(not(unix))]
fn serial(path: &Path, _: u32) -> Result<Box<dyn Bus>, BusError> {
    let why = "serial ports are for Unix".to_owned();
    Err(BusError::Unavailable { bus: path.display().to_string(), why })
}
