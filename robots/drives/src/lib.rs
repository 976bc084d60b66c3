//! The drive descriptions of the bundled robots, as texts.
//!
//! Every `*.toml` file of this crate's folder but its manifest is in the list; there is no other list of
//! drives. The schema is documented in this crate's `README.md`.
#![no_std]
#![forbid(unsafe_code)]

/// Name (the file's stem) and text of every bundled description, in the order of their names.
pub const DRIVES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/drives.rs"));

/// The text of a bundled description.
#[must_use]
pub fn text(name: &str) -> Option<&'static str> {
    DRIVES.iter().find(|(stem, _)| *stem == name).map(|(_, text)| *text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_sorted_and_texts_are_found() {
        assert!(DRIVES.windows(2).all(|pair| pair[0].0 < pair[1].0));
        for (name, drive) in DRIVES {
            assert_eq!(text(name), Some(*drive));
        }
        assert_eq!(text("no such drive"), None);
    }
}
