//! Plans as values: bytes that a controller evaluates in place, and text for people and programs.
//!
//! A plan's motion q_x and its forces have no closed form. A plan file therefore holds nodes at equal
//! distances, with positions, rates and accelerations of all coordinates and with forces; in between
//! it is a polynomial of fifth degree (forces: third). Evaluating it never calls Γ.
//! [`PlanView::deviation`] says how far it is from the rows it came from.
//!
//! Every form has a version, a checksum and the [`RobotId`] of the robot it is for. [`PlanText`] reads
//! CSV and JSON, [`PlanBytes`] the binary form of whatever size.

mod binary;
mod bytes;
mod crc;
mod read_text;
mod robot;
mod text;
mod view;

pub use binary::{
    HEADER_BYTES, Sizes, VERSION, encode, encode_values, encoded_len, encoded_values_len,
};
pub use bytes::PlanBytes;
pub use read_text::PlanText;
pub use robot::RobotId;
pub use text::{
    ColumnName, TextForm, TextWriter, state_columns, verify_text, write_csv, write_json,
};
pub use view::{Deviation, PlanState, PlanView, Stored};

use core::fmt;

/// Why a plan file is refused, or cannot be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileError {
    /// It does not begin as a plan file does.
    NotAPlan,
    /// It has another version of the format.
    Version {
        /// That of the file.
        found: u16,
    },
    /// It is for another robot, or for other values of its parameters.
    OtherRobot {
        /// Fingerprint in the file.
        found: u32,
        /// Fingerprint of the robot.
        expected: u32,
    },
    /// A line of text is no row of numbers.
    Malformed {
        /// Counted from one.
        line: usize,
    },
    /// It is for another number of coordinates, or another scalar.
    Mismatch {
        /// What differs.
        field: &'static str,
        /// In the file.
        found: usize,
        /// As asked for.
        expected: usize,
    },
    /// It is shorter or longer than it says.
    Truncated {
        /// Bytes there are.
        found: usize,
        /// Bytes there should be.
        expected: usize,
    },
    /// Its checksum is wrong: it was altered.
    Checksum,
    /// The buffer is too small to write to.
    BufferTooSmall {
        /// Bytes there are.
        found: usize,
        /// Bytes it takes.
        expected: usize,
    },
    /// Nodes do not fit the rows: too few, or a stride that does not end at the last row.
    Nodes {
        /// Rows given.
        rows: usize,
        /// From one node to the next.
        stride: usize,
    },
    /// A value of the plan is not finite.
    NonFinite,
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotAPlan => write!(f, "this is no plan file"),
            Self::Version { found } => {
                write!(f, "the plan file has version {found}, expected {VERSION}")
            }
            Self::OtherRobot { found, expected } => write!(
                f,
                "the plan file is for another robot or other parameters: its fingerprint is \
                 {found:08x}, the robot's {expected:08x}"
            ),
            Self::Malformed { line } => {
                write!(f, "line {line} of the plan file is no row of numbers")
            }
            Self::Mismatch { field, found, expected } => {
                write!(f, "the plan file has {found} {field}, expected {expected}")
            }
            Self::Truncated { found, expected } => {
                write!(f, "the plan file has {found} bytes, expected {expected}")
            }
            Self::Checksum => write!(f, "the plan file was altered: its checksum is wrong"),
            Self::BufferTooSmall { found, expected } => {
                write!(f, "the buffer has {found} bytes, the plan takes {expected}")
            }
            Self::Nodes { rows, stride } => {
                write!(f, "{rows} rows cannot be stored with a stride of {stride}")
            }
            Self::NonFinite => write!(f, "a value of the plan is not finite"),
        }
    }
}

impl core::error::Error for FileError {}
