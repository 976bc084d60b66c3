//! Declarations: parameters, coordinates, solids.

use super::{Parse, Parser, Reported};
use crate::ast::*;
use crate::lex::Kind;

impl Parser<'_> {
    pub(super) fn params(&mut self) -> Parse<StatementKind> {
        self.open('{', "after `params`")?;
        let mut list = Vec::new();
        loop {
            let docs = self.docs(false);
            if matches!(self.peek(), Kind::Close('}') | Kind::End) {
                break;
            }
            if self.eat_punct(';') {
                continue;
            }
            let from = self.at;
            match self.parameter(docs) {
                Ok(parameter) => {
                    list.push(parameter);
                    self.end_of_statement();
                }
                Err(Reported) => {
                    self.keep_broken_parameter(from, &mut list);
                    self.recover(from);
                }
            }
        }
        self.close('}', "after the parameters")?;
        Ok(StatementKind::Params(list))
    }

    /// Declares the name of a parameter that could not be read, to silence what would follow.
    fn keep_broken_parameter(&mut self, from: usize, list: &mut Vec<Parameter>) {
        let Some((Kind::Ident(text), span)) =
            self.tokens.get(from).map(|t| (t.kind.clone(), t.span))
        else {
            return;
        };
        let unit = WrittenUnit { unit: None, degrees: false, span };
        let value = Expr { kind: ExprKind::Error, span };
        list.push(Parameter {
            name: Name { text, span },
            unit,
            value,
            range: None,
            docs: String::new(),
            span,
        });
    }

    fn parameter(&mut self, docs: String) -> Parse<Parameter> {
        let name = self.name("a parameter `name: unit = value`")?;
        self.punct(':', "and the parameter's unit")?;
        let unit = self.unit()?;
        self.punct('=', "and the parameter's value")?;
        let value = self.expr()?;
        let range = self.bounds()?;
        let span = self.since(name.span);
        Ok(Parameter { name, unit, value, range, docs, span })
    }

    fn bounds(&mut self) -> Parse<Option<Bounds>> {
        if !self.eat_word("in") {
            return Ok(None);
        }
        let lower = self.expr()?;
        self.dots()?;
        let upper = self.expr()?;
        let span = lower.span.to(upper.span);
        Ok(Some(Bounds { lower, upper, span }))
    }

    pub(super) fn coordinates(&mut self, position: bool) -> Parse<StatementKind> {
        let mut names = vec![self.declarator("the name of a coordinate")?];
        while self.eat_punct(',') {
            names.push(self.declarator("the name of a coordinate")?);
        }
        self.punct(':', "and the unit of the coordinates")?;
        let unit = self.unit()?;
        let range = self.bounds()?;
        Ok(StatementKind::Coordinates(Coordinates { position, names, unit, range }))
    }

    pub(super) fn declarator(&mut self, what: &str) -> Parse<Declarator> {
        let name = self.name(what)?;
        let mut brackets = Vec::new();
        while *self.peek() == Kind::Open('[') && brackets.len() < 2 {
            brackets.push(self.labels()?);
        }
        let span = self.since(name.span);
        Ok(Declarator { name, brackets, span })
    }

    pub(super) fn labels(&mut self) -> Parse<Labels> {
        self.open('[', "before the labels")?;
        let first = self.expr()?;
        if self.is_puncts("..") {
            let inclusive = self.dots()?;
            let to = self.expr()?;
            self.close(']', "after the range of labels")?;
            return Ok(Labels::Range { from: first, to, inclusive });
        }
        let mut list = vec![first];
        while self.eat_punct(',') {
            if *self.peek() == Kind::Close(']') {
                break;
            }
            list.push(self.expr()?);
        }
        self.close(']', "after the labels")?;
        Ok(Labels::List(list))
    }

    pub(super) fn is_named_geometry(&self) -> bool {
        let end = match self.peek_at(1) {
            Kind::Punct('=') => return true,
            Kind::Open('[') => (2..8).find(|n| *self.peek_at(*n) == Kind::Close(']')),
            _ => None,
        };
        end.is_some_and(|n| *self.peek_at(n + 1) == Kind::Punct('='))
    }

    pub(super) fn named_geometry(&mut self) -> Parse<StatementKind> {
        let name = self.indexed_name("a name")?;
        self.punct('=', "and a solid")?;
        self.geometry(Some(name))
    }

    pub(super) fn geometry(&mut self, name: Option<IndexedName>) -> Parse<StatementKind> {
        let solid = self.name("a solid such as `sphere(r)`")?;
        let arguments = self.list('(', ')')?;
        let frame = if self.eat_word("on") { Some(self.expr()?) } else { None };
        let at = if self.eat_word("at") { Some(self.expr()?) } else { None };
        Ok(StatementKind::Geometry(Geometry { name, solid, arguments, frame, at }))
    }
}
