//! From a checked model to proved, specialised Rust.
#![forbid(unsafe_code)]

pub mod derive;
pub mod proof;
