//! Expressions: a Pratt parser whose chains of equal precedence are flat lists.

use super::{Parse, Parser, Reported};
use crate::Span;
use crate::ast::{Expr, ExprKind, Loop, Name, Postfix};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::lex::Kind;
use crate::lex::scan::MAX_DEPTH;

/// Binding powers, weakest first. `-x^2` is `-(x^2)`, `2^-x` is allowed.
const SUM: u8 = 1;
const PRODUCT: u8 = 3;
const SIGN: u8 = 5;
const POWER: u8 = 7;

impl Parser<'_> {
    pub(super) fn expr(&mut self) -> Parse<Expr> {
        self.binding(0)
    }

    /// An expression, or the error node after a report; does not skip anything.
    fn binding(&mut self, least: u8) -> Parse<Expr> {
        self.depth += 1;
        let result =
            if self.depth > 2 * MAX_DEPTH { Err(self.too_deep()) } else { self.climb(least) };
        self.depth -= 1;
        result
    }

    fn too_deep(&mut self) -> Reported {
        let span = self.span();
        self.sink.push(
            Diagnostic::error(codes::E0005, span, "this expression is nested too deeply")
                .help("name parts of it with `let`"),
        );
        Reported
    }

    fn climb(&mut self, least: u8) -> Parse<Expr> {
        let mut left = self.prefix()?;
        loop {
            let (power, c) = match self.peek() {
                Kind::Punct(c @ ('+' | '-')) => (SUM, *c),
                Kind::Punct(c @ ('*' | '/')) => (PRODUCT, *c),
                Kind::Punct('^') => (POWER, '^'),
                _ => return Ok(left),
            };
            if power < least {
                return Ok(left);
            }
            self.advance();
            // A power groups to the right, the others to the left.
            let right = self.binding(if power == POWER { SIGN } else { power + 1 })?;
            left = join(left, c, right);
        }
    }

    fn prefix(&mut self) -> Parse<Expr> {
        let start = self.span();
        let (mut negative, mut signs) = (false, 0_usize);
        while let Kind::Punct(c @ ('-' | '+')) = self.peek() {
            negative ^= *c == '-';
            signs += 1;
            self.advance();
        }
        if signs == 0 {
            let operand = self.primary()?;
            return self.postfix(operand);
        }
        let operand = self.binding(SIGN)?;
        let span = start.to(operand.span);
        Ok(if negative {
            Expr { kind: ExprKind::Neg(Box::new(operand)), span }
        } else {
            Expr { span, ..operand }
        })
    }

    fn primary(&mut self) -> Parse<Expr> {
        let span = self.span();
        match self.peek().clone() {
            Kind::Number(literal) => {
                self.advance();
                let kind = match literal.suffix {
                    None => ExprKind::Number(literal.value),
                    Some(text) => {
                        let unit = Span::new(span.range().start + literal.digits, span.range().end);
                        ExprKind::Quantity(literal.value, Name { text, span: unit })
                    }
                };
                Ok(Expr { kind, span })
            }
            Kind::Ident(text) => self.named(text, span),
            Kind::Open('(') => {
                self.advance();
                let inner = self.expr()?;
                self.close(
                    ')',
                    "after the value in parentheses (or an operator and another argument)",
                )?;
                Ok(Expr { kind: inner.kind, span: self.since(span) })
            }
            Kind::Open('[') => {
                let entries = self.list('[', ']')?;
                Ok(Expr { kind: ExprKind::Array(entries), span: self.since(span) })
            }
            Kind::Punct('|') => {
                self.advance();
                let inner = self.expr()?;
                self.punct('|', "after the value whose norm is taken")?;
                Ok(Expr { kind: ExprKind::Norm(Box::new(inner)), span: self.since(span) })
            }
            Kind::Bad => {
                self.advance();
                Ok(Expr { kind: ExprKind::Error, span })
            }
            _ => Err(self.expected("a value")),
        }
    }

    fn named(&mut self, text: String, span: Span) -> Parse<Expr> {
        if text == "d" && matches!(self.peek_at(1), Kind::Punct('/' | '^')) && self.is_rate() {
            return self.derivative(span);
        }
        self.advance();
        let name = Name { text, span };
        if *self.peek() != Kind::Open('(') {
            return Ok(Expr { kind: ExprKind::Name(name), span });
        }
        if name.text == "sum" && matches!(self.peek_at(2), Kind::Ident(word) if word == "in") {
            return self.sum_over(span);
        }
        let arguments = self.list('(', ')')?;
        Ok(Expr { kind: ExprKind::Call(name, arguments), span: self.since(span) })
    }

    /// Whether `d/dt` or `d^2/dt^2` stands here, and not a quotient of two names.
    fn is_rate(&self) -> bool {
        let dt = |n| matches!(self.peek_at(n), Kind::Ident(word) if word == "dt");
        dt(2) || (*self.peek_at(1) == Kind::Punct('^') && dt(4))
    }

    fn derivative(&mut self, start: Span) -> Parse<Expr> {
        if *self.peek_at(1) == Kind::Punct('^') {
            // `d^2/dt^2`, or what of it is there.
            let last = if *self.peek_at(5) == Kind::Punct('^') { 6 } else { 4 };
            let last = (self.at + last).min(self.tokens.len() - 1);
            let span = start.to(self.tokens[last].span);
            self.sink.push(
                Diagnostic::error(codes::E0108, span, "a Lagrangian holds no second time derivatives")
                    .label("second derivative")
                    .note("energies are functions of coordinates and their first rates; accelerations are what the derivation yields")
                    .help("write the rate as `d/dt(…)`"),
            );
            return Err(Reported);
        }
        (0..3).for_each(|_| self.advance());
        if *self.peek() != Kind::Open('(') {
            let span = self.since(start);
            self.sink.push(
                Diagnostic::error(
                    codes::E0108,
                    span,
                    "`d/dt` needs parentheses around what it differentiates",
                )
                .label("derivative of what?")
                .help("write `d/dt(theta)`"),
            );
            return Err(Reported);
        }
        self.advance();
        let inner = self.expr()?;
        self.close(')', "after the value that is differentiated (or an argument)")?;
        Ok(Expr { kind: ExprKind::Derivative(Box::new(inner)), span: self.since(start) })
    }

    fn sum_over(&mut self, start: Span) -> Parse<Expr> {
        self.advance();
        let (variable, from, to, inclusive) = self.loop_head()?;
        self.punct(',', "after the range of the sum")?;
        let body = self.expr()?;
        self.close(')', "after the value that is summed (or an argument)")?;
        let kind = ExprKind::SumOver(Box::new(Loop { variable, from, to, inclusive, body }));
        Ok(Expr { kind, span: self.since(start) })
    }

    /// `i in 1..=n`
    pub(super) fn loop_head(&mut self) -> Parse<(Name, Expr, Expr, bool)> {
        let variable = self.name("the name of the index")?;
        if !self.eat_word("in") {
            return Err(self.expected("`in` and a range such as `1..=n`"));
        }
        let from = self.expr()?;
        let inclusive = self.dots()?;
        Ok((variable, from, self.expr()?, inclusive))
    }

    /// `..` or `..=`, telling whether the end is included.
    pub(super) fn dots(&mut self) -> Parse<bool> {
        if self.eat_puncts("..=") {
            return Ok(true);
        }
        if self.eat_puncts("..") {
            Ok(false)
        } else {
            Err(self.expected("`..` between the ends of the range"))
        }
    }

    /// A bracketed list with commas; a trailing one is allowed.
    pub(super) fn list(&mut self, open: char, close: char) -> Parse<Vec<Expr>> {
        self.open(open, "before the list")?;
        let mut entries = Vec::new();
        while !self.eat(&Kind::Close(close)) {
            entries.push(self.expr()?);
            if !self.eat_punct(',') {
                self.close(close, "or `,` after the argument")?;
                break;
            }
        }
        Ok(entries)
    }

    fn postfix(&mut self, operand: Expr) -> Parse<Expr> {
        let mut list = Vec::new();
        let start = operand.span;
        loop {
            if self.is_punct('.') && matches!(self.peek_at(1), Kind::Ident(_)) {
                self.advance();
                list.push(Postfix::Member(self.name("a member")?));
            } else if *self.peek() == Kind::Open('[') && is_place(&operand) {
                self.advance();
                list.push(Postfix::Index(self.expr()?));
                self.close(']', "after the index (the only argument)")?;
            } else {
                break;
            }
        }
        if list.is_empty() {
            return Ok(operand);
        }
        Ok(Expr { kind: ExprKind::Postfix(Box::new(operand), list), span: self.since(start) })
    }
}

/// Whether `[…]` behind it is an index and not a forgotten operator.
fn is_place(operand: &Expr) -> bool {
    matches!(operand.kind, ExprKind::Name(_))
}

fn join(left: Expr, operator: char, right: Expr) -> Expr {
    let span = left.span.to(right.span);
    let kind = match operator {
        '+' | '-' => {
            let mut terms = match left.kind {
                ExprKind::Sum(terms) => terms,
                kind => vec![(false, Expr { kind, span: left.span })],
            };
            terms.push((operator == '-', right));
            ExprKind::Sum(terms)
        }
        '*' | '/' => {
            let mut factors = match left.kind {
                ExprKind::Product(factors) => factors,
                kind => vec![(false, Expr { kind, span: left.span })],
            };
            factors.push((operator == '/', right));
            ExprKind::Product(factors)
        }
        _ => ExprKind::Power(Box::new(left), Box::new(right)),
    };
    Expr { kind, span }
}
