//! From a checked model to proved, specialised Rust.
#![forbid(unsafe_code)]

pub mod build;
pub mod derive;
pub mod emit;
pub mod equations;
pub mod proof;

pub use build::{Addition, Build, BuildError, Extension, Module};
