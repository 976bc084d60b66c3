//! The files of a crate.

use shapebot_drive::crc::crc32;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Name of the list of all files.
pub(crate) const LIST: &str = "deployed.txt";

/// First line of that list.
pub(crate) const HEAD: &str = "Written by shapebot deploy: CRC-32 and path of each file.";

/// Files by their paths with `/`, in a fixed order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Files {
    files: BTreeMap<String, Vec<u8>>,
}

impl Files {
    pub(crate) fn add(&mut self, path: impl Into<String>, content: impl Into<Vec<u8>>) {
        self.files.insert(path.into(), content.into());
    }

    /// Adds the list of all files.
    pub(crate) fn seal(&mut self) {
        let mut text = format!("{HEAD}\n");
        for (path, content) in &self.files {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{:08x} {path}", crc32(content));
        }
        self.add(LIST, text);
    }

    /// Paths and contents.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.files.iter().map(|(path, content)| (path.as_str(), content.as_slice()))
    }

    /// A file's content.
    #[must_use]
    pub fn get(&self, path: &str) -> Option<&[u8]> {
        self.files.get(path).map(Vec::as_slice)
    }
}
