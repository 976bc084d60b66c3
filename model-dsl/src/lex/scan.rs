//! The first look at the raw text: characters that no lexer takes, and brackets.
//!
//! Nothing here recurses. Characters with an obvious meaning are replaced by their ASCII spelling of
//! the same length in bytes, so that later stages report the other errors of the file as well.

use crate::Span;
use crate::codes;
use crate::diagnostic::{Diagnostic, Sink};

/// Deepest nesting of brackets.
pub(crate) const MAX_DEPTH: usize = 256;

/// Most tokens of a file, so that even nonsense is answered within a second or two.
const MAX_TOKENS: usize = 400_000;

/// Outcome of the scan.
pub(crate) struct Scan {
    /// Text of the same length that the lexer takes.
    pub(crate) text: String,
    /// Whether brackets match, so that lexing makes sense.
    pub(crate) balanced: bool,
}

struct Scanner<'a> {
    text: &'a str,
    out: String,
    open: Vec<(char, usize)>,
    balanced: bool,
    tokens: usize,
    in_word: bool,
    sink: &'a mut Sink,
}

/// Looks at every character once.
pub(crate) fn scan(text: &str, sink: &mut Sink) -> Scan {
    let mut scanner = Scanner {
        text,
        out: String::with_capacity(text.len()),
        open: Vec::new(),
        balanced: true,
        tokens: 0,
        in_word: false,
        sink,
    };
    // A byte order mark at the very start is how some editors say UTF-8.
    let mut at = if text.starts_with('\u{feff}') { scanner.keep(0, 3) } else { 0 };
    while let Some(c) = text[at..].chars().next() {
        let end = scanner.step(at, c);
        scanner.count(at, c);
        if !scanner.balanced {
            break;
        }
        at = end;
    }
    scanner.close_all();
    Scan { text: scanner.out, balanced: scanner.balanced }
}

impl Scanner<'_> {
    /// Handles what begins at `at`; returns where it ends.
    fn step(&mut self, at: usize, c: char) -> usize {
        let rest = &self.text[at..];
        let end = at + c.len_utf8();
        if rest.starts_with("//") {
            let stop = rest.find('\n').map_or(self.text.len(), |i| at + i);
            return self.keep(at, stop);
        }
        if rest.starts_with("/*") {
            return self.block_comment(at);
        }
        match c {
            '(' | '[' | '{' => self.opens(c, at),
            ')' | ']' | '}' => self.closes(c, at),
            '"' => return self.string(at),
            _ => {}
        }
        match judge(c) {
            None => self.keep(at, end),
            Some(verdict) => {
                self.complain(at, c, &verdict);
                self.replace(verdict.instead, end)
            }
        }
    }

    /// Counts tokens roughly: every word, number and sign.
    fn count(&mut self, at: usize, c: char) {
        let word = c.is_alphanumeric() || c == '_';
        let begins = if word { !self.in_word } else { !c.is_whitespace() };
        self.in_word = word;
        self.tokens += usize::from(begins);
        if self.tokens > MAX_TOKENS && self.balanced {
            self.balanced = false;
            self.sink.push(
                Diagnostic::error(
                    codes::E0002,
                    Span::new(at, at + c.len_utf8()),
                    "the file is too large",
                )
                .label(format!("token number {MAX_TOKENS}"))
                .help("a robot with many like parts is written with `component` and `repeat`"),
            );
        }
    }

    fn keep(&mut self, from: usize, to: usize) -> usize {
        self.out.push_str(&self.text[from..to]);
        to
    }

    fn replace(&mut self, instead: &str, end: usize) -> usize {
        self.out.push_str(instead);
        while self.out.len() < end {
            self.out.push(' ');
        }
        end
    }

    fn complain(&mut self, at: usize, c: char, verdict: &Verdict) {
        let span = Span::new(at, at + c.len_utf8());
        let shown = if c.is_control() { format!("U+{:04X}", c as u32) } else { format!("`{c}`") };
        self.sink.push(
            Diagnostic::error(
                codes::E0004,
                span,
                format!("{shown} is no character of the language"),
            )
            .label(verdict.what)
            .maybe_help((!verdict.help.is_empty()).then(|| verdict.help.to_owned())),
        );
    }

    fn opens(&mut self, c: char, at: usize) {
        self.open.push((c, at));
        if self.open.len() > MAX_DEPTH {
            self.balanced = false;
            self.sink.push(
                Diagnostic::error(
                    codes::E0005,
                    Span::new(at, at + 1),
                    format!("more than {MAX_DEPTH} nested brackets"),
                )
                .label("this bracket is too deep")
                .help("name parts of the expression with `let`"),
            );
        }
    }

    fn closes(&mut self, c: char, at: usize) {
        let here = Span::new(at, at + 1);
        match self.open.pop() {
            None => {
                self.balanced = false;
                self.sink.push(
                    Diagnostic::error(codes::E0006, here, format!("`{c}` closes nothing"))
                        .label("no bracket is open here")
                        .help(format!(
                            "remove the `{c}`, or look for a bracket closed too early before it"
                        )),
                );
            }
            Some((o, from)) if partner(o) != c => {
                self.balanced = false;
                self.sink.push(
                    Diagnostic::error(codes::E0006, here, format!("`{c}` does not close `{o}`"))
                        .label(format!("`{}` was expected before this", partner(o)))
                        .also(Span::new(from, from + 1), "the bracket opened here")
                        .help(format!("close it with `{}`", partner(o))),
                );
            }
            Some(_) => {}
        }
    }

    fn close_all(&mut self) {
        if !self.balanced {
            return;
        }
        if let Some((o, from)) = self.open.pop() {
            self.balanced = false;
            self.sink.push(
                Diagnostic::error(
                    codes::E0006,
                    Span::new(from, from + 1),
                    format!("`{o}` is never closed"),
                )
                .label("opened here")
                .help(format!("add the missing `{}`", partner(o))),
            );
        }
    }

    fn block_comment(&mut self, at: usize) -> usize {
        let bytes = self.text.as_bytes();
        let (mut i, mut depth) = (at + 2, 1_usize);
        while depth > 0 {
            match bytes.get(i..i + 2) {
                Some(b"/*") => (i, depth) = (i + 2, depth + 1),
                Some(b"*/") => (i, depth) = (i + 2, depth - 1),
                Some(_) => i += 1,
                None => {
                    self.balanced = false;
                    self.sink.push(
                        Diagnostic::error(
                            codes::E0006,
                            Span::new(at, at + 2),
                            "this comment is never closed",
                        )
                        .label("opened here")
                        .help("add the missing `*/`"),
                    );
                    return self.text.len();
                }
            }
        }
        self.keep(at, i)
    }

    fn string(&mut self, at: usize) -> usize {
        let rest = &self.text[at + 1..];
        let stop = rest.find(['"', '\n']).unwrap_or(rest.len());
        let end = at + 1 + stop + usize::from(rest[stop..].starts_with('"'));
        self.sink.push(
            Diagnostic::error(codes::E0009, Span::new(at, end), "the language has no strings")
                .label("text in quotes")
                .help("documentation goes into `///` comments"),
        );
        // A zero fits wherever a value is expected.
        self.replace("0", end)
    }
}

fn partner(open: char) -> char {
    match open {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

struct Verdict {
    what: &'static str,
    help: &'static str,
    instead: &'static str,
}

/// `None` if the lexer takes the character.
fn judge(c: char) -> Option<Verdict> {
    let verdict = |what, help, instead| Some(Verdict { what, help, instead });
    match c {
        '\t' | '\n' | '\r' => None,
        '\\' | '`' => verdict("stray character", "remove it", ""),
        '\'' | '′' | '’' | '‘' => {
            verdict("a prime", "a time derivative is written `d/dt(q)`", "")
        }
        ' '..='~' => None,
        '²' => verdict("a raised digit", "write the exponent as `^2`", "^2"),
        '³' => verdict("a raised digit", "write the exponent as `^3`", "^3"),
        '¹' | '⁰' | '⁴'..='⁹' | '⁻' | '⁺' => {
            verdict("a raised digit", "write exponents with `^`, as in `x^4`", "")
        }
        '₀'..='₉' => verdict("a lowered digit", "write `q_1` for q with an index", "_"),
        '½' | '¼' | '¾' | '⅓' => {
            verdict("a fraction in one character", "write `1/2`; numbers are exact", "1")
        }
        '·' | '×' | '⋅' | '∙' | '•' | '∗' | '⨯' => {
            verdict("a multiplication sign", "write `*`", "*")
        }
        '÷' => verdict("a division sign", "write `/`", "/"),
        '−' | '–' | '—' => {
            verdict("a minus sign that is not the ASCII one", "write `-`", "-")
        }
        '°' => verdict("a degree sign", "write degrees as `80deg`", ""),
        '″' | '“' | '”' => verdict("a quote", "", ""),
        '√' => verdict("a root sign", "write `sqrt(x)`", ""),
        '∂' => {
            verdict("a partial derivative", "the total time derivative is written `d/dt(q)`", "")
        }
        '≤' => verdict("a comparison", "write `<=`", "<="),
        '≥' => verdict("a comparison", "write `>=`", ">="),
        '∈' => verdict("an element sign", "a range is written `in a..b`", "in"),
        '…' | '‥' => verdict("dots", "a range is written `a..b`", ".."),
        '∥' | '‖' => verdict("a norm sign", "write `|v|`", "|"),
        '\u{feff}' => verdict("a byte order mark inside the text", "remove it", ""),
        _ if c.is_alphabetic() || unicode_normalization::char::is_combining_mark(c) => None,
        _ => verdict("it has no meaning here", "remove it", ""),
    }
}
