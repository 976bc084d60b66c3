//! The model files of the bundled robots, as texts.
//!
//! Every `*.robot` file of this crate's folder is in the list; there is no other list of robots.
#![no_std]
#![forbid(unsafe_code)]

/// Name (the file's stem) and text of every bundled model, in the order of their names.
pub const MODELS: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/models.rs"));

/// The text of a bundled model.
#[must_use]
pub fn text(name: &str) -> Option<&'static str> {
    MODELS.iter().find(|(stem, _)| *stem == name).map(|(_, text)| *text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_sorted_and_texts_are_found() {
        assert!(MODELS.windows(2).all(|pair| pair[0].0 < pair[1].0));
        for (name, model) in MODELS {
            assert_eq!(text(name), Some(*model));
        }
        assert_eq!(text("no such robot"), None);
    }
}
