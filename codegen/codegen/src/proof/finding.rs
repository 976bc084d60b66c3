//! A condition that fails, on its way to a diagnostic.

use super::certificate::Reason;
use super::problem::Problem;
use shapebot_model_dsl::{Code, Diagnostic, Span};

/// What fails, by which term, and what would mend it.
#[derive(Clone, Debug)]
pub(super) struct Finding {
    pub(super) code: Code,
    /// Letter of the condition; `-` for what is wrong in any class.
    pub(super) condition: char,
    pub(super) span: Span,
    pub(super) title: String,
    pub(super) label: String,
    pub(super) also: Vec<(Span, String)>,
    pub(super) notes: Vec<String>,
    pub(super) help: Option<String>,
}

impl Finding {
    pub(super) fn new(code: Code, condition: char, span: Span, title: impl Into<String>) -> Self {
        Self {
            code,
            condition,
            span,
            title: title.into(),
            label: String::new(),
            also: Vec::new(),
            notes: Vec::new(),
            help: None,
        }
    }

    pub(super) fn label(mut self, text: impl Into<String>) -> Self {
        self.label = text.into();
        self
    }

    pub(super) fn also(mut self, places: impl IntoIterator<Item = (Span, String)>) -> Self {
        self.also.extend(places);
        self
    }

    pub(super) fn note(mut self, text: impl Into<String>) -> Self {
        self.notes.push(text.into());
        self
    }

    pub(super) fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }

    /// Puts the place on the energy terms that are to blame: the first is underlined, the others are
    /// pointed at as well.
    pub(super) fn blame(mut self, problem: &Problem<'_>, sources: &[usize], what: &str) -> Self {
        let declared = self.span;
        let mut places = sources.iter().map(|&s| &problem.equations.sources[s]);
        if let Some(first) = places.next() {
            self.span = first.span;
            self.label = format!("{} {what}", first.name);
            self.also.extend(places.map(|s| (s.span, format!("{} {what}", s.name))));
            if declared != Span::default() {
                self.also.push((declared, "declared here".to_owned()));
            }
        }
        self
    }

    pub(super) fn reason(&self, problem: &Problem<'_>) -> Reason {
        let text = if self.label.is_empty() {
            self.title.clone()
        } else {
            format!("{}: {}", self.title, self.label)
        };
        Reason {
            code: self.code,
            condition: self.condition,
            text,
            line: problem.model.line_column(self.span).0,
            help: self.help.clone(),
        }
    }

    fn filled(self, mut diagnostic: Diagnostic) -> Diagnostic {
        diagnostic = diagnostic.label(self.label).maybe_help(self.help);
        for (span, text) in self.also {
            diagnostic = diagnostic.also(span, text);
        }
        self.notes.into_iter().fold(diagnostic, Diagnostic::note)
    }

    pub(super) fn error(self) -> Diagnostic {
        let diagnostic = Diagnostic::error(self.code, self.span, self.title.clone());
        self.filled(diagnostic)
    }

    pub(super) fn warning(self) -> Diagnostic {
        let diagnostic = Diagnostic::warning(self.code, self.span, self.title.clone());
        self.filled(diagnostic)
    }
}
