//! Text to flat tokens with byte spans. proc-macro2's lexer says what a token is.

mod names;
pub(crate) mod number;
pub(crate) mod scan;

use crate::Span;
use crate::codes;
use crate::diagnostic::{Diagnostic, Sink};
use number::{BadNumber, Literal};
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::str::FromStr;
use unicode_normalization::UnicodeNormalization;

/// Longest name.
const LONGEST_NAME: usize = 120;

/// What a token is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Kind {
    /// Name or keyword, in ASCII.
    Ident(String),
    /// Number, perhaps with a unit.
    Number(Literal),
    /// One character of punctuation.
    Punct(char),
    /// Opening bracket.
    Open(char),
    /// Closing bracket.
    Close(char),
    /// A line of documentation; `//!` if inner.
    Doc { text: String, inner: bool },
    /// Something refused already; stands for an operand.
    Bad,
    /// End of the text.
    End,
}

/// A token with its place.
#[derive(Clone, Debug)]
pub(crate) struct Token {
    pub(crate) kind: Kind,
    pub(crate) span: Span,
}

/// Lexes text that [`scan::scan`] found balanced. The last token is [`Kind::End`].
pub(crate) fn lex(text: &str, sink: &mut Sink) -> Option<Vec<Token>> {
    // The lexer would skip a byte order mark and count from behind it.
    let skipped = if text.starts_with('\u{feff}') { 3 } else { 0 };
    let stream = match TokenStream::from_str(&text[skipped..]) {
        Ok(stream) => stream,
        Err(error) => {
            let range = error.span().byte_range();
            sink.push(unreadable(text, range.start + skipped));
            return None;
        }
    };
    let mut flat = Flattener { text, skipped, tokens: Vec::new(), sink };
    flat.run(stream);
    let end = text.len();
    flat.tokens.push(Token { kind: Kind::End, span: Span::new(end, end) });
    Some(flat.tokens)
}

fn unreadable(text: &str, at: usize) -> Diagnostic {
    let at = at.min(text.len());
    let c = text.get(at..).and_then(|t| t.chars().next());
    let span = Span::new(at, at + c.map_or(0, char::len_utf8));
    Diagnostic::error(codes::E0004, span, "this cannot be read as a token")
        .label("reading stopped here")
}

struct Flattener<'a> {
    text: &'a str,
    skipped: usize,
    tokens: Vec<Token>,
    sink: &'a mut Sink,
}

impl Flattener<'_> {
    fn run(&mut self, stream: TokenStream) {
        let mut stack = vec![(stream.into_iter().peekable(), None)];
        while let Some((iter, close)) = stack.last_mut() {
            let Some(tree) = iter.next() else {
                if let Some(token) = close.take() {
                    self.tokens.push(token);
                }
                stack.pop();
                continue;
            };
            match tree {
                TokenTree::Group(group) => {
                    let (open, end) = brackets(group.delimiter());
                    let (from, to) = (self.span(group.span_open()), self.span(group.span_close()));
                    self.tokens.push(Token { kind: Kind::Open(open), span: from });
                    let close = Token { kind: Kind::Close(end), span: to };
                    stack.push((group.stream().into_iter().peekable(), Some(close)));
                }
                TokenTree::Punct(punct)
                    if punct.as_char() == '#' && self.is_comment(self.span(punct.span())) =>
                {
                    let span = self.span(punct.span());
                    // The attribute that the lexer makes of the comment: `!` and `[doc = "…"]`.
                    if matches!(iter.peek(), Some(TokenTree::Punct(p)) if p.as_char() == '!') {
                        iter.next();
                    }
                    iter.next();
                    self.doc(span);
                }
                other => self.leaf(&other),
            }
        }
    }

    fn span(&self, span: proc_macro2::Span) -> Span {
        let range = span.byte_range();
        Span::new(range.start + self.skipped, range.end + self.skipped)
    }

    fn source(&self, span: Span) -> &str {
        self.text.get(span.range()).unwrap_or("")
    }

    fn is_comment(&self, span: Span) -> bool {
        let text = self.source(span);
        text.starts_with("//") || text.starts_with("/*")
    }

    fn doc(&mut self, span: Span) {
        let text = self.source(span);
        let inner = text.starts_with("//!") || text.starts_with("/*!");
        let body = text.get(3..).unwrap_or("");
        let body =
            if text.starts_with("/*") { body.strip_suffix("*/").unwrap_or(body) } else { body };
        let body = body.strip_prefix(' ').unwrap_or(body).trim_end().to_owned();
        self.tokens.push(Token { kind: Kind::Doc { text: body, inner }, span });
    }

    fn leaf(&mut self, tree: &TokenTree) {
        let span = self.span(tree.span());
        let kind = match tree {
            TokenTree::Punct(punct) => Kind::Punct(punct.as_char()),
            TokenTree::Ident(_) => self.ident(span),
            _ => self.literal(span),
        };
        self.tokens.push(Token { kind, span });
    }

    fn ident(&mut self, span: Span) -> Kind {
        let text = self.source(span);
        let diagnostic = match names::ascii(text) {
            Ok(_) if text.starts_with("r#") => Diagnostic::error(
                codes::E0008,
                span,
                "raw identifiers are not part of the language",
            ),
            Ok(name) if name.len() > LONGEST_NAME => Diagnostic::error(
                codes::E0008,
                span,
                format!("a name has at most {LONGEST_NAME} characters"),
            ),
            Ok(name) => return Kind::Ident(name),
            Err(c) => {
                let marked =
                    std::iter::once(c).nfd().any(unicode_normalization::char::is_combining_mark);
                Diagnostic::error(
                    codes::E0008,
                    span,
                    format!("`{c}` in a name has no ASCII spelling"),
                )
                .label("names are Latin letters, digits, `_` and Greek letters")
                .note("the names of a model become names of Rust fields and command line options")
                .maybe_help(marked.then(|| "a time derivative is written `d/dt(q)`".to_owned()))
            }
        };
        self.sink.push(diagnostic);
        Kind::Bad
    }

    fn literal(&mut self, span: Span) -> Kind {
        let error = match number::parse(self.source(span)) {
            Ok(literal) => return Kind::Number(literal),
            Err(error) => error,
        };
        let (code, title, help) = match error {
            BadNumber::TooLong => {
                (codes::E0007, "this number has too many digits", "200 digits are the limit")
            }
            BadNumber::ExponentTooLarge => {
                (codes::E0007, "this number's exponent is too large", "write at most e400")
            }
            BadNumber::Radix => (codes::E0007, "numbers are decimal", "write it in decimal digits"),
            BadNumber::NotANumber => {
                (codes::E0009, "this literal is not part of the language", "write a number")
            }
        };
        self.sink.push(Diagnostic::error(code, span, title).help(help));
        Kind::Bad
    }
}

fn brackets(delimiter: Delimiter) -> (char, char) {
    match delimiter {
        Delimiter::Brace => ('{', '}'),
        Delimiter::Bracket => ('[', ']'),
        Delimiter::Parenthesis | Delimiter::None => ('(', ')'),
    }
}
