//! Why a build script generated nothing.

use std::path::PathBuf;
use std::{fmt, io};

/// Why nothing was generated. Both `{}` and `{:?}` print messages for a reader, so that
/// `fn main() -> Result<(), BuildError>` does.
#[non_exhaustive]
pub enum BuildError {
    /// A model file cannot be read.
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// A model is wrong.
    Model {
        /// The file, or the name of the text.
        path: PathBuf,
        /// All messages about it, with their places.
        rendered: String,
    },
    /// Two models would make the same module.
    Duplicate {
        /// Its name.
        module: String,
    },
    /// A module cannot be written.
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// Neither `OUT_DIR` nor [`Build::out_dir`](crate::Build::out_dir) says where to write.
    NoOutDir,
    /// Several of these.
    Several(Vec<Self>),
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read { path, error } => {
                write!(f, "cannot read the model {}: {error}", path.display())
            }
            Self::Model { rendered, .. } => f.write_str(rendered.trim_end()),
            Self::Duplicate { module } => {
                write!(f, "two models would make the module `{module}`: rename one of the files")
            }
            Self::Write { path, error } => write!(f, "cannot write {}: {error}", path.display()),
            Self::NoOutDir => {
                f.write_str("no output folder: run from a build script, or set `Build::out_dir`")
            }
            Self::Several(errors) => {
                let texts: Vec<String> = errors.iter().map(Self::to_string).collect();
                f.write_str(&texts.join("\n\n"))
            }
        }
    }
}

impl fmt::Debug for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no robot was generated\n\n{self}")
    }
}

impl std::error::Error for BuildError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Read { error, .. } | Self::Write { error, .. } => Some(error),
            _ => None,
        }
    }
}
