//! Why a report is refused.

use std::fmt;
use std::path::PathBuf;

/// Why a report cannot be made or written.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A list has not one entry per shown time, body, column or the like.
    Length {
        /// Where: title of the run or table, and the list.
        place: String,
        /// Entries it should have.
        expected: usize,
        /// Entries it has.
        found: usize,
    },
    /// Times are not finite or do not increase.
    Time {
        /// Title of the run.
        run: String,
    },
    /// A pose, a path or a figure is not finite. (Series of panels may have gaps.)
    NotFinite {
        /// Where: title of the run, and what of it.
        place: String,
    },
    /// A run names a robot that has no page.
    UnknownRobot {
        /// Title of the run.
        run: String,
        /// The name.
        robot: String,
    },
    /// A row links to a run that is not in the report.
    UnknownRun {
        /// Title of the table.
        table: String,
        /// Index of the run.
        run: usize,
    },
    /// The page is longer than [`LIMIT`](crate::LIMIT).
    TooLarge {
        /// Its length in bytes.
        bytes: usize,
    },
    /// The page's template and the data do not fit together: a defect of this crate.
    Template(tera::Error),
    /// The data cannot be written as JSON: a defect of this crate.
    Data(serde_json::Error),
    /// The file cannot be written.
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { place, expected, found } => {
                write!(f, "{place}: {found} entries where {expected} are needed")
            }
            Self::Time { run } => write!(f, "{run}: times must be finite and increase"),
            Self::NotFinite { place } => write!(f, "{place}: a value is not finite"),
            Self::UnknownRobot { run, robot } => {
                write!(f, "{run}: robot `{robot}` has no page in the report")
            }
            Self::UnknownRun { table, run } => {
                write!(f, "{table}: a row links to run {run}, which is not in the report")
            }
            Self::TooLarge { bytes } => write!(
                f,
                "the report takes {bytes} bytes, more than {}: leave out runs or shown times",
                crate::LIMIT
            ),
            Self::Template(_) => f.write_str("the page's template does not fit the data"),
            Self::Data(_) => f.write_str("the data cannot be written as JSON"),
            Self::File { path, source } => write!(f, "{}: {source}", path.display()),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Template(source) => Some(source),
            Self::Data(source) => Some(source),
            Self::File { source, .. } => Some(source),
            _ => None,
        }
    }
}

impl From<tera::Error> for Error {
    fn from(source: tera::Error) -> Self {
        Self::Template(source)
    }
}

impl From<serde_json::Error> for Error {
    fn from(source: serde_json::Error) -> Self {
        Self::Data(source)
    }
}
