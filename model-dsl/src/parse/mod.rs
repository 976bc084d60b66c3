//! Flat tokens to a syntax tree. A broken statement is skipped to its `;` and the rest is read.

mod declare;
mod expr;
mod statement;
mod unit;

use crate::Span;
use crate::ast::{Name, Robot};
use crate::codes;
use crate::diagnostic::{Diagnostic, Sink};
use crate::lex::{Kind, Token};
pub(crate) use statement::KEYWORDS;

/// The error has been reported.
#[derive(Debug)]
pub(crate) struct Reported;

pub(crate) type Parse<T> = Result<T, Reported>;

/// Reads a file's tokens.
pub(crate) fn parse(text: &str, tokens: Vec<Token>, sink: &mut Sink) -> Option<Robot> {
    let mut parser = Parser { text, tokens, at: 0, depth: 0, sink };
    parser.robot().ok()
}

pub(crate) struct Parser<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
    sink: &'a mut Sink,
}

impl Parser<'_> {
    fn peek(&self) -> &Kind {
        self.peek_at(0)
    }

    fn peek_at(&self, n: usize) -> &Kind {
        self.tokens.get(self.at + n).map_or(&Kind::End, |t| &t.kind)
    }

    fn span(&self) -> Span {
        self.tokens.get(self.at).or(self.tokens.last()).map_or(Span::default(), |t| t.span)
    }

    /// Span of the token before.
    fn before(&self) -> Span {
        self.at.checked_sub(1).and_then(|i| self.tokens.get(i)).map_or(Span::default(), |t| t.span)
    }

    fn since(&self, start: Span) -> Span {
        start.to(self.before())
    }

    fn advance(&mut self) {
        if self.at + 1 < self.tokens.len() {
            self.at += 1;
        }
    }

    fn is_punct(&self, c: char) -> bool {
        *self.peek() == Kind::Punct(c)
    }

    fn is_puncts(&self, text: &str) -> bool {
        text.chars().enumerate().all(|(i, c)| {
            *self.peek_at(i) == Kind::Punct(c)
                && (i == 0
                    || self.tokens[self.at + i].span.start == self.tokens[self.at + i - 1].span.end)
        })
    }

    fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Kind::Ident(text) if text == word)
    }

    fn eat_punct(&mut self, c: char) -> bool {
        let found = self.is_punct(c);
        if found {
            self.advance();
        }
        found
    }

    fn eat_puncts(&mut self, text: &str) -> bool {
        let found = self.is_puncts(text);
        if found {
            text.chars().for_each(|_| self.advance());
        }
        found
    }

    fn eat_word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        if found {
            self.advance();
        }
        found
    }

    fn eat(&mut self, kind: &Kind) -> bool {
        let found = self.peek() == kind;
        if found {
            self.advance();
        }
        found
    }

    fn punct(&mut self, c: char, after: &str) -> Parse<()> {
        if self.eat_punct(c) { Ok(()) } else { Err(self.expected(&format!("`{c}` {after}"))) }
    }

    fn open(&mut self, c: char, after: &str) -> Parse<()> {
        if self.eat(&Kind::Open(c)) {
            Ok(())
        } else {
            Err(self.expected(&format!("`{c}` {after}")))
        }
    }

    fn close(&mut self, c: char, after: &str) -> Parse<()> {
        if self.eat(&Kind::Close(c)) {
            Ok(())
        } else {
            Err(self.expected(&format!("`{c}` {after}")))
        }
    }

    fn name(&mut self, what: &str) -> Parse<Name> {
        let span = self.span();
        if let Kind::Ident(text) = self.peek() {
            let text = text.clone();
            self.advance();
            return Ok(Name { text, span });
        }
        Err(self.expected(what))
    }

    /// How the next token is named in a message.
    fn found(&self) -> String {
        match self.peek() {
            Kind::Ident(text) => format!("`{text}`"),
            Kind::Number(_) => "a number".to_owned(),
            Kind::Punct(c) | Kind::Open(c) | Kind::Close(c) => format!("`{c}`"),
            Kind::Doc { .. } => "a documentation comment".to_owned(),
            Kind::Bad => "an unreadable token".to_owned(),
            Kind::End => "the end of the file".to_owned(),
        }
    }

    /// Reports what was expected instead of the next token.
    fn expected(&mut self, what: &str) -> Reported {
        if *self.peek() == Kind::Bad {
            return Reported;
        }
        let after_operand = self.at > 0
            && matches!(
                self.tokens[self.at - 1].kind,
                Kind::Ident(_) | Kind::Number(_) | Kind::Close(')' | ']')
            );
        let before_operand =
            matches!(self.peek(), Kind::Ident(_) | Kind::Number(_) | Kind::Open('('));
        let same_line = what.contains("statement")
            || what.contains("after the value")
            || what.contains("argument");
        if after_operand && before_operand && same_line && !self.at_keyword() && !self.on_new_line()
        {
            return self.missing_operator();
        }
        let (span, help) = (self.span(), self.hint());
        let title = format!("expected {what}, found {}", self.found());
        self.sink.push(
            Diagnostic::error(codes::E0101, span, title)
                .label("not expected here")
                .maybe_help(help),
        );
        Reported
    }

    fn hint(&self) -> Option<String> {
        if self.is_puncts("==") || (self.is_punct('=') && self.before_is('=')) {
            return Some("a definition is written with one `=`".to_owned());
        }
        if self.is_puncts("..") {
            return Some("a range stands behind `in`, as in `in -90deg..90deg`".to_owned());
        }
        if self.is_punct('.') && matches!(self.peek_at(1), Kind::Number(_)) {
            return Some("write the zero before the point, as in `0.5`".to_owned());
        }
        if self.is_puncts("**") || (self.is_punct('*') && self.before_is('*')) {
            return Some("a power is written `x^2`".to_owned());
        }
        None
    }

    /// Whether a line ends between the token before and the next.
    fn on_new_line(&self) -> bool {
        let between = self.before().range().end..self.span().range().start;
        self.text.get(between).is_some_and(|t| t.contains('\n'))
    }

    fn before_is(&self, c: char) -> bool {
        self.at > 0 && self.tokens[self.at - 1].kind == Kind::Punct(c)
    }

    fn at_keyword(&self) -> bool {
        matches!(self.peek(), Kind::Ident(text) if statement::KEYWORDS.contains(&text.as_str()))
    }

    fn missing_operator(&mut self) -> Reported {
        let (left, right) = (self.before(), self.span());
        let (a, b) = (self.text_of(self.at - 1), self.text_of(self.at));
        let diagnostic = Diagnostic::error(
            codes::E0104,
            left.to(right),
            "an operator is missing between two factors",
        )
        .label("every product is written out")
        .help(if b == "(" {
            format!("write `{a}*(…)`")
        } else {
            format!("write `{a}*{b}`")
        });
        self.sink.push(diagnostic);
        Reported
    }

    fn text_of(&self, index: usize) -> String {
        match self.tokens.get(index).map(|t| &t.kind) {
            Some(Kind::Ident(text)) => text.clone(),
            Some(Kind::Number(literal)) => {
                let (n, suffix) = (&literal.value, literal.suffix.as_deref().unwrap_or(""));
                format!("{}{suffix}", crate::units::decimal(n))
            }
            Some(Kind::Close(_)) => "(…)".to_owned(),
            Some(Kind::Open(c)) => c.to_string(),
            _ => String::new(),
        }
    }

    /// Collects documentation lines; inner ones are reported unless `inner` is wanted.
    fn docs(&mut self, inner_wanted: bool) -> String {
        let mut lines: Vec<String> = Vec::new();
        while let Kind::Doc { text, inner } = self.peek() {
            if *inner && !inner_wanted {
                let span = self.span();
                self.sink.push(
                    Diagnostic::error(
                        codes::E0107,
                        span,
                        "`//!` documents the whole file and stands at its top",
                    )
                    .help("document a statement with `///`"),
                );
            } else {
                lines.push(text.clone());
            }
            self.advance();
        }
        lines.join("\n")
    }

    fn robot(&mut self) -> Parse<Robot> {
        let docs = self.docs(true);
        let start = self.span();
        if !self.eat_word("robot") {
            return Err(self.no_robot());
        }
        let name = self.name("the robot's name after `robot`")?;
        let span = self.since(start);
        self.open('{', "after the robot's name")?;
        let body = self.block()?;
        self.close('}', "at the end of the robot")?;
        let _ = self.docs(true);
        if *self.peek() != Kind::End {
            let span = self.span();
            let title = format!("nothing may follow the robot, found {}", self.found());
            self.sink.push(
                Diagnostic::error(codes::E0107, span, title)
                    .help("one file describes one robot; move this inside its braces or into a file of its own"),
            );
        }
        Ok(Robot { name, docs, body, span })
    }

    fn no_robot(&mut self) -> Reported {
        let span = self.span();
        let diagnostic = if *self.peek() == Kind::End {
            Diagnostic::error(codes::E0003, span, "the file holds no robot")
        } else {
            Diagnostic::error(
                codes::E0102,
                span,
                format!("a model begins with `robot`, found {}", self.found()),
            )
            .label("expected `robot Name {`")
        };
        self.sink.push(diagnostic.help("write `robot Name { … }`"));
        Reported
    }
}
