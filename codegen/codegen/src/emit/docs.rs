//! Documentation of emitted code: what users wrote is escaped, tables are filled from templates.

use syn::Attribute;

/// Texts for the module page that other parts of the generator write.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Documentation {
    /// Equations of motion as plain text.
    pub equations: String,
    /// The structure proof as plain text.
    pub certificate: String,
}

/// Doc attributes, one per line of the text.
pub(super) fn attributes(text: &str) -> Vec<Attribute> {
    let attribute = |line: &str| -> Attribute {
        let line = if line.is_empty() { String::new() } else { format!(" {line}") };
        syn::parse_quote!(#[doc = #line])
    };
    text.trim_end().lines().map(attribute).collect()
}

/// Characters that turn the direction of text are refused by the compiler in comments.
fn is_printable(c: char) -> bool {
    let turns = matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    !turns && (c == '\n' || !c.is_control())
}

fn printable(text: &str) -> String {
    text.replace('\t', "    ").chars().filter(|&c| is_printable(c)).collect()
}

/// One line of text, for a comment.
pub(super) fn one_line(text: &str) -> String {
    printable(&text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// A text that stands in a `text` fence.
pub(super) fn fenced(text: &str) -> String {
    printable(text.trim_end()).replace("```", "'''")
}

/// What an author wrote, as documentation that neither breaks a link nor becomes a test.
pub(super) fn paragraph(text: &str) -> String {
    let text = printable(text);
    let mut lines = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        let trimmed = line.trim();
        if trimmed.starts_with("```") || trimmed.starts_with("~~~") {
            lines.push(if inside { "```" } else { "```text" }.to_owned());
            inside = !inside;
        } else if inside {
            lines.push(line.trim_end().to_owned());
        } else {
            lines.push(escaped(trimmed));
        }
    }
    if inside {
        lines.push("```".to_owned());
    }
    lines.join("\n")
}

/// A text for one cell of a table.
pub(super) fn cell(text: &str) -> String {
    let text = one_line(text);
    if text.is_empty() { String::from("—") } else { escaped(&text).replace('|', "\\|") }
}

/// Markdown that means nothing but its characters, code spans and links apart.
fn escaped(line: &str) -> String {
    let mut out = String::new();
    let mut rest = line;
    while let Some(c) = rest.chars().next() {
        if let Some(span) = code_span(rest).or_else(|| address(rest)) {
            out.push_str(&span.0);
            rest = &rest[span.1..];
            continue;
        }
        let first = out.is_empty() && matches!(c, '#' | '>' | '=');
        if first || matches!(c, '[' | ']' | '<' | '>' | '*' | '\\' | '`') {
            out.push('\\');
        }
        out.push(c);
        rest = &rest[c.len_utf8()..];
    }
    out
}

/// A code span at the start of the text, with its length.
fn code_span(text: &str) -> Option<(String, usize)> {
    let inner = text.strip_prefix('`')?;
    let end = inner.find('`').filter(|&end| end > 0)?;
    let length = end + 2;
    Some((text[..length].to_owned(), length))
}

/// A web address at the start of the text, as a link.
fn address(text: &str) -> Option<(String, usize)> {
    if !text.starts_with("http://") && !text.starts_with("https://") {
        return None;
    }
    let stops = |c: char| c.is_whitespace() || matches!(c, '<' | '>' | ')' | ']' | '|' | '"' | '`');
    let end = text.find(stops).unwrap_or(text.len());
    let end = text[..end].trim_end_matches(['.', ',', ';', ':']).len();
    Some((format!("<{}>", &text[..end]), end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_tags_and_emphasis_are_escaped() {
        assert_eq!(paragraph("see [0] and Vec<T>"), "see \\[0\\] and Vec\\<T\\>");
        assert_eq!(paragraph("r_w*theta*2"), "r_w\\*theta\\*2");
        assert_eq!(paragraph("`q[0]` stays, ` alone not"), "`q[0]` stays, \\` alone not");
        assert_eq!(paragraph("# no heading"), "\\# no heading");
    }

    #[test]
    fn indented_and_fenced_text_never_becomes_a_test() {
        assert_eq!(paragraph("a\n    let x = 1;"), "a\nlet x = 1;");
        assert_eq!(paragraph("```\nx = [1]\n```"), "```text\nx = [1]\n```");
        assert_eq!(paragraph("```rust\nx"), "```text\nx\n```");
    }

    #[test]
    fn addresses_become_links() {
        assert_eq!(paragraph("see https://a.b/c."), "see <https://a.b/c>.");
    }

    #[test]
    fn cells_stay_in_their_column() {
        assert_eq!(cell("a | b\nc"), "a \\| b c");
        assert_eq!(cell(""), "—");
    }

    #[test]
    fn control_characters_and_turned_text_vanish() {
        assert_eq!(paragraph("a\r\nb\u{202e}c\tx"), "a\nbc    x");
    }
}
