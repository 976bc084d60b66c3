//! The model language: text to a checked, dimension-correct mechanical model.
#![forbid(unsafe_code)]

pub mod model;

/// A half-open range of byte offsets into the model's text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}
