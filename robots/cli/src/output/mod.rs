//! Forms of output.

mod columns;
mod json;
mod motion;

pub(crate) use columns::{Align, Columns};
pub(crate) use json::Json;
pub(crate) use motion::{csv, json, method, report};
pub(crate) use shapebot_planning::number;

use crate::failure::{Failure, Outcome};
use std::path::Path;

/// Writes a file, making its folder if need be.
pub(crate) fn write_file(path: &Path, text: impl AsRef<[u8]>) -> Outcome {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|e| Failure::file("create", folder, &e))?;
    }
    std::fs::write(path, text).map_err(|e| Failure::file("write", path, &e))
}
