//! Diagnostics as text, in the look of rustc.

use crate::Span;
use crate::diagnostic::{Diagnostic, Severity};
use annotate_snippets::{AnnotationKind, Element, Group, Level, Origin, Renderer, Snippet};
use std::borrow::Cow;
use std::ops::Range;

/// Sources beyond this are shown by place only.
const MAX_WINDOW: usize = 40_000;

/// Renders diagnostics against the text they are about. Places outside of the text are moved to its end.
#[must_use]
pub fn render(diagnostics: &[Diagnostic], source_name: &str, text: &str, color: bool) -> String {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    let mut out = String::new();
    for diagnostic in diagnostics {
        let group = group(diagnostic, source_name, text);
        out.push_str(&renderer.render(&[group]));
        out.push_str("\n\n");
    }
    out
}

fn group<'a>(diagnostic: &'a Diagnostic, source_name: &'a str, text: &'a str) -> Group<'a> {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(diagnostic.title.as_str()).id(diagnostic.code.as_str());
    let mut group = title.element(place(diagnostic, source_name, text));
    for note in &diagnostic.notes {
        group = group.element(Level::NOTE.message(note.as_str()));
    }
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    group
}

fn place<'a>(diagnostic: &'a Diagnostic, source_name: &'a str, text: &'a str) -> Element<'a> {
    let spans = std::iter::once(diagnostic.span).chain(diagnostic.labels.iter().map(|l| l.0));
    let window = window(text, spans.map(|s| clamp(s, text)));
    let line = text[..window.start].matches('\n').count() + 1;
    if window.len() > MAX_WINDOW {
        let start = clamp(diagnostic.span, text).start;
        let line = text[..start].matches('\n').count() + 1;
        return Origin::path(source_name).line(line).into();
    }
    let local = |span: Span| {
        let range = clamp(span, text);
        range.start - window.start..range.end - window.start
    };
    let mut primary = AnnotationKind::Primary.span(local(diagnostic.span));
    if !diagnostic.primary_label.is_empty() {
        primary = primary.label(diagnostic.primary_label.as_str());
    }
    let others = diagnostic
        .labels
        .iter()
        .map(|(span, label)| AnnotationKind::Context.span(local(*span)).label(label.as_str()));
    // Shown as it looks in an editor; a space keeps the places.
    let shown: Cow<'a, str> = match &text[window.clone()] {
        lines if lines.contains('\r') => lines.replace('\r', " ").into(),
        lines => lines.into(),
    };
    Snippet::source(shown)
        .line_start(line)
        .path(source_name)
        .annotation(primary)
        .annotations(others.collect::<Vec<_>>())
        .into()
}

/// Whole lines around all places.
fn window(text: &str, spans: impl Iterator<Item = Range<usize>>) -> Range<usize> {
    let (mut from, mut to) = (text.len(), 0);
    for span in spans {
        (from, to) = (from.min(span.start), to.max(span.end));
    }
    let start = text[..from].rfind('\n').map_or(0, |i| i + 1);
    let end = text[to.max(from)..].find('\n').map_or(text.len(), |i| to.max(from) + i);
    start..end
}

/// A range inside the text, on character boundaries.
fn clamp(span: Span, text: &str) -> Range<usize> {
    let range = span.range();
    let mut start = range.start.min(text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    let mut end = range.end.clamp(start, text.len());
    while !text.is_char_boundary(end) {
        end += 1;
    }
    start..end
}
