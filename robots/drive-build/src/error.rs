//! What is wrong with a drive description, and where.

use std::cell::RefCell;
use std::fmt;

/// A place in a description.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Spot {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Path of the key: `timing.period`.
    pub key: String,
}

/// A value with the place where it was said.
#[derive(Clone, Debug, PartialEq)]
pub struct Said<T> {
    /// The value.
    pub value: T,
    /// Where it was said.
    pub spot: Spot,
}

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// Name of the file.
    pub file: String,
    /// Where in it.
    pub spot: Spot,
    /// What is wrong there, with the figure.
    pub message: String,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Spot { line, column, key } = &self.spot;
        write!(f, "{}:{line}:{column}: ", self.file)?;
        if !key.is_empty() {
            write!(f, "`{key}`: ")?;
        }
        f.write_str(&self.message)
    }
}

/// All that is wrong with a description, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Errors(pub Vec<Error>);

impl fmt::Display for Errors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, error) in self.0.iter().enumerate() {
            let separator = if index == 0 { "" } else { "\n" };
            write!(f, "{separator}{error}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Errors {}

/// Collects errors.
#[derive(Debug)]
pub(crate) struct Complaints {
    file: String,
    list: RefCell<Vec<Error>>,
}

impl Complaints {
    pub(crate) fn new(file: &str) -> Self {
        Self { file: file.to_owned(), list: RefCell::default() }
    }

    pub(crate) fn add(&self, spot: &Spot, message: impl Into<String>) {
        let (file, spot) = (self.file.clone(), spot.clone());
        self.list.borrow_mut().push(Error { file, spot, message: message.into() });
    }

    /// Adds a complaint unless the condition holds.
    pub(crate) fn demand(&self, holds: bool, spot: &Spot, message: impl FnOnce() -> String) {
        if !holds {
            self.add(spot, message());
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list.borrow().is_empty()
    }

    pub(crate) fn into_errors(self) -> Errors {
        let mut list = self.list.into_inner();
        list.sort_by(|a, b| a.spot.cmp(&b.spot));
        list.dedup();
        Errors(list)
    }
}

/// `; did you mean ...?` for the known name that is closest, or the list of all.
pub(crate) fn suggestion<'k>(name: &str, known: impl IntoIterator<Item = &'k str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    let distance = |other: &str| strsim::damerau_levenshtein(name, other);
    // Longer names are no misspellings, and would take long.
    let near = known.iter().filter(|_| name.len() <= 64).map(|other| (distance(other), *other));
    match near.filter(|(d, other)| *d <= 1 + other.len() / 3).min() {
        Some((_, close)) => format!("; did you mean `{close}`?"),
        None if known.is_empty() => String::new(),
        None => format!("; known here: {}", known.join(", ")),
    }
}
