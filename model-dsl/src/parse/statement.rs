//! Statements of a robot, a component or a repetition.

use super::{Parse, Parser, Reported};
use crate::Span;
use crate::ast::*;
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::lex::Kind;
use crate::model::{Axis, Comparison};
use crate::suggest::closest;

/// Words that begin a statement.
pub(crate) const KEYWORDS: &[&str] = &[
    "params",
    "position",
    "shape",
    "let",
    "const",
    "frame",
    "kinetic",
    "potential",
    "lagrangian",
    "dissipation",
    "rigid",
    "gravity",
    "component",
    "repeat",
    "actuator",
    "output",
    "point",
    "friction",
    "require",
    "robot",
];

impl Parser<'_> {
    /// Statements up to the closing brace, which is left.
    pub(super) fn block(&mut self) -> Parse<Vec<Statement>> {
        self.depth += 1;
        let mut list = Vec::new();
        loop {
            let docs = self.docs(false);
            if matches!(self.peek(), Kind::Close('}') | Kind::End) {
                self.depth -= 1;
                return Ok(list);
            }
            if self.eat_punct(';') {
                continue;
            }
            let (at, start) = (self.at, self.span());
            match self.statement() {
                Ok(Some(kind)) => list.push(Statement { kind, docs, span: self.since(start) }),
                Ok(None) => {}
                Err(Reported) => self.recover(at),
            }
        }
    }

    /// Skips to behind the `;` or before the `}` that ends the statement.
    pub(super) fn recover(&mut self, from: usize) {
        // Brackets opened by the broken statement are still open: begin again at its start.
        let reached = self.at;
        self.at = from;
        let mut depth = 0_usize;
        loop {
            match self.peek() {
                Kind::End => return,
                Kind::Open(_) => depth += 1,
                Kind::Close('}') if depth == 0 => return,
                Kind::Close(c) => {
                    let block_ends = *c == '}' && depth == 1;
                    depth = depth.saturating_sub(1);
                    if block_ends && self.at >= reached {
                        self.advance();
                        return;
                    }
                }
                Kind::Punct(';') if depth == 0 => {
                    self.advance();
                    return;
                }
                // A statement without its `;`: go on at the next keyword on a line of its own.
                Kind::Ident(_)
                    if depth == 0 && self.at > from && self.at >= reached && self.at_keyword() =>
                {
                    return;
                }
                _ => {}
            }
            self.advance();
        }
    }

    /// One statement; `None` if it was reported and skipped in full.
    fn statement(&mut self) -> Parse<Option<StatementKind>> {
        let word = match self.peek() {
            Kind::Ident(word) => word.clone(),
            _ => return Err(self.expected("a statement")),
        };
        if !KEYWORDS.contains(&word.as_str()) {
            return self.instance(&word).map(Some);
        }
        let start = self.span();
        self.advance();
        let kind = match word.as_str() {
            "params" => return self.params().map(Some),
            "rigid" => return self.rigid().map(Some),
            "component" => return self.component().map(Some),
            "repeat" => return self.repeat().map(Some),
            "robot" => return Err(self.nested_robot(start)),
            "position" => self.coordinates(true)?,
            "shape" if *self.peek_at(1) == Kind::Open('(') => self.geometry(None)?,
            "shape" if self.is_named_geometry() => self.named_geometry()?,
            "shape" => self.coordinates(false)?,
            "let" => {
                let name = self.indexed_name("a name after `let`")?;
                StatementKind::Let(name, self.definition()?)
            }
            "const" => {
                let name = self.name("a name after `const`")?;
                StatementKind::Const(name, self.definition()?)
            }
            "frame" => {
                let name = self.indexed_name("a name after `frame`")?;
                StatementKind::Frame(name, self.definition()?)
            }
            "point" => {
                let name = self.indexed_name("a name after `point`")?;
                StatementKind::Point(name, self.definition()?)
            }
            "kinetic" => StatementKind::Energy(Energy::Kinetic, self.expr()?),
            "potential" => StatementKind::Energy(Energy::Potential, self.expr()?),
            "lagrangian" => StatementKind::Energy(Energy::Lagrangian, self.expr()?),
            "dissipation" => StatementKind::Energy(Energy::Dissipation, self.expr()?),
            "gravity" => self.gravity()?,
            "actuator" => self.actuator()?,
            "output" => {
                let entries = self.expr()?;
                self.punct(':', "and the unit of the output")?;
                StatementKind::Output(entries, self.unit()?)
            }
            "friction" => {
                let level = self.expr()?;
                self.word("on", "after the level of the friction")?;
                StatementKind::Friction(level, self.expr()?)
            }
            _ => self.require()?,
        };
        if self.end_of_statement() {
            return Ok(Some(kind));
        }
        Ok(without_values(kind))
    }

    /// The `;`. Returns whether the statement before was complete; it is if only the `;` is missing at
    /// the end of its line.
    pub(super) fn end_of_statement(&mut self) -> bool {
        if self.eat_punct(';') {
            return true;
        }
        let from = self.at;
        if self.on_new_line()
            || self.at_keyword()
            || matches!(self.peek(), Kind::Close('}') | Kind::End)
        {
            let span = self.before();
            let found = self.found();
            self.sink.push(
                Diagnostic::error(
                    codes::E0101,
                    span,
                    format!("expected `;` after the statement, found {found}"),
                )
                .label("`;` is missing behind this")
                .help("end every statement with `;`"),
            );
            return true;
        }
        let Reported = self.expected("`;` after the statement");
        self.recover(from);
        false
    }

    /// `= expr`; a broken expression still defines the name.
    fn definition(&mut self) -> Parse<Expr> {
        self.punct('=', "and the definition")?;
        let start = self.span();
        let from = self.at;
        if let Ok(expr) = self.expr() {
            return Ok(expr);
        }
        self.at = from;
        let mut depth = 0_usize;
        while !(depth == 0 && matches!(self.peek(), Kind::Punct(';') | Kind::Close(_) | Kind::End))
        {
            match self.peek() {
                Kind::Open(_) => depth += 1,
                Kind::Close(_) => depth -= 1,
                Kind::End => break,
                _ => {}
            }
            self.advance();
        }
        Ok(Expr { kind: ExprKind::Error, span: start })
    }

    fn word(&mut self, word: &str, after: &str) -> Parse<()> {
        if self.eat_word(word) { Ok(()) } else { Err(self.expected(&format!("`{word}` {after}"))) }
    }

    pub(super) fn indexed_name(&mut self, what: &str) -> Parse<IndexedName> {
        let name = self.name(what)?;
        let mut index = None;
        if self.eat(&Kind::Open('[')) {
            index = Some(self.expr()?);
            self.close(']', "after the index (the only argument)")?;
        }
        Ok(IndexedName { name, index })
    }

    fn nested_robot(&mut self, start: Span) -> Reported {
        self.sink.push(
            Diagnostic::error(codes::E0107, start, "a robot inside a robot")
                .help("one file describes one robot; parts that repeat are a `component`"),
        );
        Reported
    }

    fn rigid(&mut self) -> Parse<StatementKind> {
        let name = self.indexed_name("a name after `rigid`")?;
        self.open('{', "after the name of the rigid body")?;
        let mut fields = Vec::new();
        while !matches!(self.peek(), Kind::Close('}') | Kind::End) {
            let field = self.name("a field such as `mass: …`")?;
            self.punct(':', "after the name of the field")?;
            fields.push((field, self.expr()?));
            if !self.eat_punct(',') && !self.eat_punct(';') && *self.peek() != Kind::Close('}') {
                return Err(self.expected("`,` or `}` behind the field"));
            }
        }
        self.close('}', "after the fields")?;
        self.eat_punct(';');
        Ok(StatementKind::Rigid(Rigid { name, fields }))
    }

    fn gravity(&mut self) -> Parse<StatementKind> {
        let acceleration = self.expr()?;
        self.word("along", "and a world axis after the acceleration")?;
        let start = self.span();
        let sign = if self.eat_punct('-') { -1 } else { 1 };
        self.eat_punct('+');
        let axis = if self.eat_word("world") && self.eat_punct('.') {
            let name = self.name("`x`, `y` or `z`")?;
            match name.text.as_str() {
                "x" => Some(Axis::X),
                "y" => Some(Axis::Y),
                "z" => Some(Axis::Z),
                _ => None,
            }
        } else {
            None
        };
        if axis.is_none() {
            while !matches!(self.peek(), Kind::Punct(';') | Kind::Close(_) | Kind::End) {
                self.advance();
            }
            let span = self.since(start);
            self.sink.push(
                Diagnostic::error(codes::E0106, span, "gravity points along an axis of the world")
                    .help("write `-world.z` for downwards"),
            );
        }
        Ok(StatementKind::Gravity { acceleration, axis: axis.map(|a| (a, sign)) })
    }

    fn component(&mut self) -> Parse<StatementKind> {
        let name = self.name("a name after `component`")?;
        self.open('(', "before the arguments of the component")?;
        let mut arguments = Vec::new();
        while !self.eat(&Kind::Close(')')) {
            let name = self.name("the name of an argument")?;
            self.punct(':', "and the type of the argument")?;
            arguments.push(Argument { name, kind: self.argument_type()? });
            if !self.eat_punct(',') {
                self.close(')', "after the arguments of the component")?;
                break;
            }
        }
        let body = self.braced_block("before the body of the component")?;
        Ok(StatementKind::Component(Component { name, arguments, body }))
    }

    fn argument_type(&mut self) -> Parse<ArgumentType> {
        if self.eat_word("frame") {
            return Ok(ArgumentType::Frame);
        }
        if self.eat_word("point") {
            return Ok(ArgumentType::Point);
        }
        let unit = self.unit()?;
        if *self.peek() == Kind::Open('[') {
            return Ok(ArgumentType::Array(unit, Box::new(self.labels()?)));
        }
        Ok(ArgumentType::Scalar(unit))
    }

    fn braced_block(&mut self, after: &str) -> Parse<Vec<Statement>> {
        self.open('{', after)?;
        let body = self.block()?;
        self.close('}', "at the end of the block")?;
        Ok(body)
    }

    fn repeat(&mut self) -> Parse<StatementKind> {
        let (variable, from, to, inclusive) = self.loop_head()?;
        let body = self.braced_block("before the statements that repeat")?;
        Ok(StatementKind::Repeat(Loop { variable, from, to, inclusive, body }))
    }

    fn instance(&mut self, word: &str) -> Parse<StatementKind> {
        let start = self.span();
        if !matches!(self.peek_at(1), Kind::Punct('=') | Kind::Open('[')) {
            let help =
                closest(word, KEYWORDS.iter().copied()).map(|k| format!("did you mean `{k}`?"));
            self.sink.push(
                Diagnostic::error(codes::E0103, start, format!("`{word}` begins no statement"))
                    .label("unknown statement")
                    .note(format!(
                        "statements begin with {}",
                        KEYWORDS[..KEYWORDS.len() - 1].join(", ")
                    ))
                    .maybe_help(help),
            );
            return Err(Reported);
        }
        let name = self.indexed_name("a name")?;
        self.punct('=', "and a component")?;
        let component = self.name("the name of a component")?;
        if *self.peek() != Kind::Open('(') {
            let span = start.to(component.span);
            self.sink.push(
                Diagnostic::error(
                    codes::E0103,
                    span,
                    "a bare `name = …` makes an instance of a component",
                )
                .help(format!("write `let {} = …;` to name a value", name.name.text)),
            );
            return Err(Reported);
        }
        let arguments = self.list('(', ')')?;
        self.end_of_statement();
        Ok(StatementKind::Instance { name, component, arguments })
    }

    fn actuator(&mut self) -> Parse<StatementKind> {
        let name = self.declarator("a name after `actuator`")?;
        self.word("on", "and the rate that the motor works on")?;
        let on = self.expr()?;
        let limit = if self.eat_word("limit") { Some(self.expr()?) } else { None };
        Ok(StatementKind::Actuator(Actuator { name, on, limit }))
    }

    fn require(&mut self) -> Parse<StatementKind> {
        if self.is_word("shape_accelerated") && *self.peek_at(1) == Kind::Punct(';') {
            self.advance();
            return Ok(StatementKind::Require(Requirement::ShapeAccelerated));
        }
        if self.is_word("mirror") && *self.peek_at(1) == Kind::Open('(') {
            return self.mirror();
        }
        let left = self.expr()?;
        let comparison = match () {
            () if self.eat_puncts("<=") => Comparison::LessOrEqual,
            () if self.eat_puncts(">=") => Comparison::GreaterOrEqual,
            () if self.eat_punct('<') => Comparison::Less,
            () if self.eat_punct('>') => Comparison::Greater,
            () => return Err(self.expected("a comparison `<`, `<=`, `>` or `>=`")),
        };
        Ok(StatementKind::Require(Requirement::Compare(left, comparison, self.expr()?)))
    }

    fn mirror(&mut self) -> Parse<StatementKind> {
        self.advance();
        let start = self.span();
        let mut list = self.list('(', ')')?.into_iter();
        if let (Some(a), Some(b), None) = (list.next(), list.next(), list.next()) {
            return Ok(StatementKind::Require(Requirement::Mirror(a, b)));
        }
        let span = self.since(start);
        self.sink.push(
            Diagnostic::error(codes::E0407, span, "`mirror` takes two instances")
                .help("write `mirror(left, right)`"),
        );
        Err(Reported)
    }
}

/// What is left of a statement whose end could not be read: the names that it declares.
fn without_values(kind: StatementKind) -> Option<StatementKind> {
    let broken = |e: Expr| Expr { kind: ExprKind::Error, ..e };
    match kind {
        StatementKind::Let(name, e) => Some(StatementKind::Let(name, broken(e))),
        StatementKind::Const(name, e) => Some(StatementKind::Const(name, broken(e))),
        StatementKind::Frame(name, e) => Some(StatementKind::Frame(name, broken(e))),
        StatementKind::Point(name, e) => Some(StatementKind::Point(name, broken(e))),
        StatementKind::Coordinates(c) => Some(StatementKind::Coordinates(c)),
        _ => None,
    }
}
