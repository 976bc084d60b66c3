//! What is said to the author of a model: code, place, physics and help.

use crate::Span;
use std::fmt;

/// A stable diagnostic code such as `E0301`; each has a page, see [`crate::explain`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Code(&'static str);

impl Code {
    pub(crate) const fn new(text: &'static str) -> Self {
        Self(text)
    }

    /// The code as it is printed.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        self.0
    }

    /// Its one-line title.
    #[must_use]
    pub fn title(self) -> &'static str {
        crate::codes::entry(self.0).map_or("", |e| e.title)
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// No model comes out.
    Error,
    /// The model stands, but something in it is probably not meant.
    Warning,
}

/// One message with its places.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Stable code.
    pub code: Code,
    /// Error or warning.
    pub severity: Severity,
    /// What is wrong, in one line.
    pub title: String,
    /// The offending text.
    pub span: Span,
    /// What to say under the offending text; may be empty.
    pub primary_label: String,
    /// Further places that matter.
    pub labels: Vec<(Span, String)>,
    /// Background: the physics, the rule.
    pub notes: Vec<String>,
    /// What to do about it.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error at a place.
    #[must_use]
    pub fn error(code: Code, span: Span, title: impl Into<String>) -> Self {
        Self {
            code,
            severity: Severity::Error,
            title: title.into(),
            span,
            primary_label: String::new(),
            labels: Vec::new(),
            notes: Vec::new(),
            help: None,
        }
    }

    /// A warning at a place.
    #[must_use]
    pub fn warning(code: Code, span: Span, title: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, span, title) }
    }

    /// Sets the text under the offending place.
    #[must_use]
    pub fn label(mut self, text: impl Into<String>) -> Self {
        self.primary_label = text.into();
        self
    }

    /// Adds a further place.
    #[must_use]
    pub fn also(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push((span, text.into()));
        self
    }

    /// Adds a note.
    #[must_use]
    pub fn note(mut self, text: impl Into<String>) -> Self {
        self.notes.push(text.into());
        self
    }

    /// Sets the help line.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }

    /// Sets the help line if there is one to give.
    #[must_use]
    pub fn maybe_help(mut self, text: Option<String>) -> Self {
        if text.is_some() {
            self.help = text;
        }
        self
    }

    /// Whether it is an error.
    #[must_use]
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

/// The collector that every stage writes to.
#[derive(Default)]
pub(crate) struct Sink {
    list: Vec<Diagnostic>,
    /// Messages beyond what is kept.
    dropped: usize,
}

/// More than this many are counted, not shown.
const SHOWN: usize = 100;
/// More than this many are not even kept: the file is no model.
const KEPT: usize = 2000;

impl Sink {
    pub(crate) fn push(&mut self, diagnostic: Diagnostic) {
        if self.list.len() < KEPT || self.list.iter().all(|d| !d.is_error()) {
            self.list.push(diagnostic);
        } else {
            self.dropped += 1;
        }
    }

    pub(crate) fn has_errors(&self) -> bool {
        self.list.iter().any(Diagnostic::is_error)
    }

    /// Whether it makes sense to spend time on suggestions.
    pub(crate) fn is_crowded(&self) -> bool {
        self.list.len() > SHOWN
    }

    /// In the order of the text, without repetitions, at most [`SHOWN`].
    pub(crate) fn finish(mut self) -> Vec<Diagnostic> {
        self.list.sort_by(|a, b| {
            (a.span.start, a.severity, a.span.end, a.code, &a.title).cmp(&(
                b.span.start,
                b.severity,
                b.span.end,
                b.code,
                &b.title,
            ))
        });
        self.list.dedup();
        let hidden = self.list.len().saturating_sub(SHOWN) + self.dropped;
        if hidden > 0 {
            self.list.truncate(SHOWN);
            if let Some(last) = self.list.last_mut() {
                last.notes.push(format!("{hidden} further messages are not shown"));
            }
        }
        self.list
    }
}
