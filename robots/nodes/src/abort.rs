//! Reasons for which an SDO transfer is aborted.

use std::fmt;

/// An abort code of CiA 301.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Abort {
    /// Toggle bit not alternated.
    Toggle = 0x0503_0000,
    /// Command specifier not valid or unknown.
    Command = 0x0504_0001,
    /// Out of memory: a segmented download that is longer than any object.
    Memory = 0x0504_0005,
    /// Attempt to read a write-only object.
    WriteOnly = 0x0601_0001,
    /// Attempt to write a read-only object.
    ReadOnly = 0x0601_0002,
    /// The object does not exist.
    NoObject = 0x0602_0000,
    /// The object cannot be mapped to the PDO.
    NotMappable = 0x0604_0041,
    /// The objects to be mapped are longer than a PDO.
    MappingLength = 0x0604_0042,
    /// Length of the data does not match: too long.
    TooLong = 0x0607_0012,
    /// Length of the data does not match: too short.
    TooShort = 0x0607_0013,
    /// The sub-index does not exist.
    NoSubIndex = 0x0609_0011,
    /// Value not valid.
    Value = 0x0609_0030,
    /// Value too high.
    TooHigh = 0x0609_0031,
    /// Value too low.
    TooLow = 0x0609_0032,
    /// Data cannot be stored in the present state of the device.
    DeviceState = 0x0800_0022,
}

impl Abort {
    /// The code as it is sent.
    #[must_use]
    pub const fn code(self) -> u32 {
        self as u32
    }
}

impl fmt::Display for Abort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SDO abort {:#010x}", self.code())
    }
}

impl std::error::Error for Abort {}
