//! What the fuzz targets do with their bytes. A target is a file here and one in `bin/`.
#![forbid(unsafe_code)]

pub mod master;
pub mod plan;
