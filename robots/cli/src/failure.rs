//! How a command can end badly, and what is said about it.

use anstyle::{AnsiColor, Style};
use shapebot_planning::{Refusal, suggestion};
use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;

const ERROR: Style = AnsiColor::Red.on_default().bold();
const HELP: Style = AnsiColor::Cyan.on_default().bold();

/// How a command can end badly.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The model or the plan was refused: exit code 1.
    Refused(String),
    /// The same, with everything already said on standard error.
    Reported,
    /// Wrong usage or input: exit code 2, with a suggestion if there is one.
    Usage(String, Option<String>),
    /// The reader of standard output went away, which is no failure.
    BrokenPipe,
}

/// What a command returns.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    pub(crate) fn refused(message: impl Display) -> Self {
        Self::Refused(message.to_string())
    }

    pub(crate) fn usage(message: impl Display) -> Self {
        Self::Usage(message.to_string(), None)
    }

    /// An unknown name, with the closest of the known ones.
    pub(crate) fn unknown<'a>(
        what: &str,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let known: Vec<&str> = known.into_iter().collect();
        Self::Usage(format!("no {what} `{name}`"), suggestion(name, &known))
    }

    /// The same with the place of what it is about ahead of it, unless it has one.
    pub(crate) fn at(self, place: &str) -> Self {
        let placed = |message: String| {
            if place.is_empty() || message.starts_with(place) {
                return message;
            }
            format!("{place}: {message}")
        };
        match self {
            Self::Refused(message) => Self::Refused(placed(message)),
            Self::Usage(message, help) => Self::Usage(placed(message), help),
            other => other,
        }
    }

    /// An error of reading or writing, with the file's name.
    pub(crate) fn file(action: &str, path: impl AsRef<std::path::Path>, error: &io::Error) -> Self {
        Self::usage(format!("cannot {action} {}: {error}", path.as_ref().display()))
    }

    /// Says what there is to say and gives the exit code.
    pub(crate) fn report(&self) -> ExitCode {
        match self {
            Self::BrokenPipe => ExitCode::SUCCESS,
            Self::Reported => ExitCode::from(1),
            Self::Refused(message) => {
                say(message, None);
                ExitCode::from(1)
            }
            Self::Usage(message, help) => {
                say(message, help.as_deref());
                ExitCode::from(2)
            }
        }
    }
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Task { message, help } => Self::Usage(message, help),
            Refusal::Plan { message } => Self::Refused(message),
        }
    }
}

impl From<shapebot_experiments::Error> for Failure {
    fn from(error: shapebot_experiments::Error) -> Self {
        match error {
            shapebot_experiments::Error::Task(refusal) => refusal.into(),
            other => Self::refused(other),
        }
    }
}

/// What a failure is to a room below; one that was reported already has nothing more to say.
impl From<Failure> for Refusal {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Usage(message, help) => Self::Task { message, help },
            Failure::Refused(message) => Self::Plan { message },
            Failure::Reported | Failure::BrokenPipe => Self::plan("the model was refused"),
        }
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Self::BrokenPipe;
        }
        Self::usage(error)
    }
}

fn say(message: &str, help: Option<&str>) {
    let mut stderr = anstream::stderr().lock();
    // Nowhere left to complain if standard error is closed.
    let _ = writeln!(stderr, "{ERROR}error{ERROR:#}: {message}");
    if let Some(help) = help {
        let _ = writeln!(stderr, "{HELP}help{HELP:#}: {help}");
    }
}
