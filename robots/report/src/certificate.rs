//! The text of a certificate as HTML.

use crate::text::escape;
use std::fmt::Write as _;

/// Words that say how far something is shown, and the class that marks them.
const VERDICTS: [(&str, &str); 5] = [
    ("not shape-accelerated", "refuted"),
    ("sampled only", "sampled"),
    ("undecided", "sampled"),
    ("shape-accelerated", "proved"),
    ("proved", "proved"),
];

/// Lines that are not indented become headings, the rest keeps its columns. Verdicts are marked.
pub(crate) fn to_html(text: &str) -> String {
    let mut html = String::new();
    for line in text.lines() {
        let class = if line.starts_with(' ') { "line" } else { "head" };
        let _ = writeln!(html, "<span class=\"{class}\">{}</span>", marked(line));
    }
    html
}

/// Escaped text with its first verdict marked.
fn marked(line: &str) -> String {
    let found = VERDICTS.iter().filter_map(|(word, class)| Some((line.find(word)?, *word, *class)));
    // The longest of those that begin first.
    let first = found.min_by_key(|(at, word, _)| (*at, std::cmp::Reverse(word.len())));
    match first {
        Some((at, word, class)) => format!(
            "{}<mark class=\"{class}\">{word}</mark>{}",
            escape(&line[..at]),
            escape(&line[at + word.len()..])
        ),
        None => escape(line),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_are_marked_and_text_is_escaped() {
        let html = to_html("R<2>: not shape-accelerated\n  sampled only at 3 points");
        assert_eq!(
            html,
            "<span class=\"head\">R&lt;2&gt;: <mark class=\"refuted\">not shape-accelerated</mark></span>\n\
             <span class=\"line\">  <mark class=\"sampled\">sampled only</mark> at 3 points</span>\n"
        );
    }
}
