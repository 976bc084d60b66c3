//! The reference data: states whose dynamics were computed exactly, tasks that were planned elsewhere.

use crate::compare::{Array, Numbers};
use crate::environment::root;
use serde_json::Value;
use shapebot_dynamics::nalgebra::SVector;
use std::path::PathBuf;

/// Part of a reference file.
#[derive(Clone, Debug)]
pub struct Data(pub Value);

impl Data {
    /// A field.
    ///
    /// # Panics
    ///
    /// If there is no such field.
    #[must_use]
    #[track_caller]
    pub fn get(&self, field: &str) -> Self {
        self.optional(field).unwrap_or_else(|| panic!("reference data has no `{field}`"))
    }

    /// A field, if it is there and not null.
    #[must_use]
    pub fn optional(&self, field: &str) -> Option<Self> {
        let value = self.0.get(field)?;
        (!value.is_null()).then(|| Self(value.clone()))
    }

    /// Elements of a list; nothing if it is none.
    #[must_use]
    pub fn list(&self) -> Vec<Self> {
        self.0.as_array().into_iter().flatten().cloned().map(Self).collect()
    }

    /// A number.
    ///
    /// # Panics
    ///
    /// If it is none.
    #[must_use]
    #[track_caller]
    pub fn number(&self) -> f64 {
        self.0.as_f64().unwrap_or_else(|| panic!("{} is no number", self.0))
    }

    /// A text.
    ///
    /// # Panics
    ///
    /// If it is none.
    #[must_use]
    #[track_caller]
    pub fn text(&self) -> &str {
        self.0.as_str().unwrap_or_else(|| panic!("{} is no text", self.0))
    }

    /// A list of N numbers.
    ///
    /// # Panics
    ///
    /// If it is none.
    #[must_use]
    #[track_caller]
    pub fn vector<const N: usize>(&self) -> SVector<f64, N> {
        let entries = self.array().entries;
        assert_eq!(entries.len(), N, "reference data has a vector of another size");
        SVector::from_column_slice(&entries)
    }
}

impl Numbers for Data {
    fn array(&self) -> Array {
        let Value::Array(list) = &self.0 else {
            return self.number().array();
        };
        let parts: Vec<Array> = list.iter().map(|value| Self(value.clone()).array()).collect();
        let mut extents = vec![list.len()];
        extents.extend(parts.first().into_iter().flat_map(|part| part.extents.clone()));
        Array { extents, entries: parts.into_iter().flat_map(|part| part.entries).collect() }
    }
}

fn folder(kind: &str) -> PathBuf {
    root().join("tests/reference").join(kind)
}

/// Names of the reference files of a kind: `dynamics`, `planning`.
///
/// # Panics
///
/// If the folder cannot be read.
#[must_use]
pub fn names(kind: &str) -> Vec<String> {
    let folder = folder(kind);
    let entries =
        std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let paths = entries.map(|entry| entry.expect("a folder entry").path());
    let data = paths.filter(|path| path.extension().is_some_and(|e| e == "json"));
    let mut names: Vec<String> =
        data.filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned())).collect();
    names.sort();
    names
}

/// A reference file; `None` if there is none of this name.
///
/// # Panics
///
/// If the file is not JSON.
#[must_use]
pub fn load(kind: &str, name: &str) -> Option<Data> {
    let path = folder(kind).join(format!("{name}.json"));
    let text = std::fs::read_to_string(&path).ok()?;
    let value = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    Some(Data(value))
}
