//! What is wrong with a task file, and where.

use std::fmt;

/// What is wrong with a task file, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// `file:line:column`, and the key if there is one.
    pub place: String,
    /// What is wrong there.
    pub message: String,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}

impl std::error::Error for Error {}

/// `; did you mean ...?` for the known name that is closest, or the list of all.
pub(crate) fn suggestion(name: &str, known: &[&str]) -> String {
    let distance = |other: &str| strsim::damerau_levenshtein(name, other);
    // Longer names are no misspellings, and would take long.
    let near = known.iter().filter(|_| name.len() <= 64).map(|other| (distance(other), *other));
    match near.filter(|(d, other)| *d <= 1 + other.len() / 3).min() {
        Some((_, close)) => format!("; did you mean `{close}`?"),
        None => format!("; known here: {}", known.join(", ")),
    }
}
