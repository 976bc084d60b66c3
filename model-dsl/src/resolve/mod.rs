//! Names, kinds and dimensions: a syntax tree to a model.
//!
//! Statements are read from top to bottom; only parameters and components are known beforehand. What
//! is refused becomes [`value::Value::Poison`] and silences everything built on it.

mod arena;
mod bodies;
mod call;
mod check;
mod component;
mod coordinates;
mod expr;
mod finish;
mod motors;
mod params;
mod product;
mod scope;
mod value;
mod vector;

use crate::Span;
use crate::ast::{self, Statement, StatementKind};
use crate::codes;
use crate::diagnostic::{Diagnostic, Sink};
use crate::model::{self, ExprId, Frame, FrameId, Model};
use arena::Arena;
use scope::{Binding, Level, Scope};
use std::collections::{BTreeMap, BTreeSet};
use value::Value;

/// Most passes through bodies of repetitions and components.
const MAX_EXPANSIONS: usize = 20_000;

/// A coordinate before positions and shapes are sorted.
struct Draft {
    coordinate: model::Coordinate,
    set: usize,
}

pub(crate) struct Resolver<'a> {
    sink: &'a mut Sink,
    arena: Arena,
    scopes: Vec<Scope<'a>>,
    scope: usize,
    /// Names declared anywhere in the file, for "used before it is declared".
    declared: BTreeMap<String, Span>,
    claimed: BTreeMap<(&'static str, String), Span>,
    /// Components being expanded.
    expanding: Vec<&'a str>,
    expansions: usize,
    stopped: bool,
    /// Some coordinates could not be declared: counting them makes no sense.
    coordinates_broken: bool,
    used_parameters: BTreeSet<u32>,
    parameters: Vec<model::Parameter>,
    parameter_ids: Vec<ExprId>,
    drafts: Vec<Draft>,
    sets: Vec<model::CoordinateSet>,
    frames: Vec<Frame>,
    bodies: Vec<model::RigidBody>,
    kinetic: Vec<model::EnergyTerm>,
    potential: Vec<model::EnergyTerm>,
    lagrangian: Vec<model::EnergyTerm>,
    dissipation: Vec<model::EnergyTerm>,
    gravity: Option<model::Gravity>,
    actuators: Vec<model::Actuator>,
    friction: Vec<model::CoulombFriction>,
    output: Option<model::Output>,
    points: Vec<model::Point>,
    geometry: Vec<model::Geometry>,
    requirements: Vec<model::Required>,
}

/// Resolves a robot. The model is complete only if the sink holds no errors afterwards.
pub(crate) fn resolve(robot: &ast::Robot, source_name: &str, text: &str, sink: &mut Sink) -> Model {
    let mut resolver = Resolver::new(sink);
    collect_names(&robot.body, &mut resolver.declared);
    resolver.robot(robot);
    resolver.finish(robot, source_name, text)
}

impl<'a> Resolver<'a> {
    fn new(sink: &'a mut Sink) -> Self {
        let coordinates_broken = sink.has_errors();
        let mut arena = Arena::default();
        arena.push_frame(None, std::iter::empty());
        let world = Frame {
            name: "world".to_owned(),
            parent: None,
            rotations: Vec::new(),
            span: Span::default(),
        };
        let mut names = BTreeMap::new();
        let binding = Binding { value: Value::Frame(FrameId::WORLD), span: Span::default() };
        names.insert(("world".to_owned(), None), binding);
        Self {
            sink,
            arena,
            scopes: vec![Scope { parent: None, level: Level::Robot, prefix: String::new(), names }],
            scope: 0,
            declared: BTreeMap::new(),
            claimed: BTreeMap::new(),
            expanding: Vec::new(),
            expansions: 0,
            stopped: false,
            coordinates_broken,
            used_parameters: BTreeSet::new(),
            parameters: Vec::new(),
            parameter_ids: Vec::new(),
            drafts: Vec::new(),
            sets: Vec::new(),
            frames: vec![world],
            bodies: Vec::new(),
            kinetic: Vec::new(),
            potential: Vec::new(),
            lagrangian: Vec::new(),
            dissipation: Vec::new(),
            gravity: None,
            actuators: Vec::new(),
            friction: Vec::new(),
            output: None,
            points: Vec::new(),
            geometry: Vec::new(),
            requirements: Vec::new(),
        }
    }

    fn robot(&mut self, robot: &'a ast::Robot) {
        for statement in &robot.body {
            match &statement.kind {
                StatementKind::Params(list) => self.params(list),
                StatementKind::Component(component) => {
                    let value = Value::Component(component, 0);
                    self.bind((component.name.text.clone(), None), value, component.name.span);
                }
                _ => {}
            }
        }
        self.statements(&robot.body);
    }

    fn statements(&mut self, list: &'a [Statement]) {
        for statement in list {
            if self.is_stopped() {
                return;
            }
            self.statement(statement);
        }
    }

    /// Whether a limit was exceeded; reports it once.
    fn is_stopped(&mut self) -> bool {
        if let (false, Some((span, what))) = (self.stopped, self.arena.overflow) {
            self.too_large(span, what);
        }
        self.stopped
    }

    fn too_large(&mut self, span: Span, what: &str) {
        self.stopped = true;
        self.sink.push(
            Diagnostic::error(codes::E0509, span, "the model is too large")
                .label(what.to_owned())
                .help("look for a repetition that runs further than meant"),
        );
    }

    /// Counts a pass through a body; `false` if there have been too many.
    fn expand(&mut self, span: Span) -> bool {
        self.expansions += 1;
        if self.expansions > MAX_EXPANSIONS && !self.stopped {
            self.too_large(span, "repetitions and components expand to more than 20 000 bodies");
        }
        !self.stopped
    }

    fn statement(&mut self, statement: &'a Statement) {
        let (docs, span) = (statement.docs.as_str(), statement.span);
        match &statement.kind {
            StatementKind::Params(list) => {
                self.only_in_robot("params", span);
                if self.level() != Level::Robot {
                    for p in list {
                        self.bind((p.name.text.clone(), None), Value::Poison, p.name.span);
                    }
                }
            }
            StatementKind::Component(_) => self.only_in_robot("component", span),
            StatementKind::Coordinates(coordinates) => self.coordinates(coordinates, docs),
            StatementKind::Let(name, expr) => {
                let value = self.eval(expr);
                self.declare(name, value);
            }
            StatementKind::Const(name, expr) => self.constant(name, expr),
            StatementKind::Frame(name, expr) => self.frame(name, expr, span),
            StatementKind::Energy(kind, expr) => self.energy(kind, expr, docs, span),
            StatementKind::Rigid(rigid) => self.rigid(rigid, docs, span),
            StatementKind::Gravity { acceleration, axis } => {
                self.only_in_robot("gravity", span);
                self.gravity(acceleration, *axis, span);
            }
            StatementKind::Instance { name, component, arguments } => {
                self.instance(name, component, arguments, span)
            }
            StatementKind::Repeat(repeat) => self.repeat(repeat),
            StatementKind::Actuator(actuator) => self.actuator(actuator, docs, span),
            StatementKind::Output(expr, unit) => {
                self.only_in_robot("output", span);
                self.output(expr, unit, span);
            }
            StatementKind::Point(name, expr) => self.point(name, expr, docs, span),
            StatementKind::Geometry(geometry) => self.geometry(geometry, span),
            StatementKind::Friction(level, on) => self.friction(level, on, span),
            StatementKind::Require(requirement) => self.require(requirement, span),
        }
    }

    fn only_in_robot(&mut self, what: &str, span: Span) {
        if self.level() != Level::Robot {
            self.sink.push(
                Diagnostic::error(
                    codes::E0109,
                    span,
                    format!("`{what}` stands directly in the robot"),
                )
                .label("not inside a component or a repetition")
                .help("move it out of the braces"),
            );
        }
    }

    fn declare(&mut self, name: &'a ast::IndexedName, value: Value<'a>) {
        if let Some(key) = self.key(name) {
            self.bind(key, value, name.name.span);
        }
    }

    fn constant(&mut self, name: &'a ast::Name, expr: &'a ast::Expr) {
        let value = self.eval(expr);
        let is_number = match &value {
            Value::Scalar(s) => self.arena.as_number(s.id).is_some(),
            Value::Poison => true,
            _ => false,
        };
        if !is_number {
            self.sink.push(
                Diagnostic::error(
                    codes::E0507,
                    expr.span,
                    "a `const` is a number known while the file is read",
                )
                .label(format!("this is {}", value.kind()))
                .help("use `let` for anything that depends on parameters or coordinates"),
            );
        }
        self.bind(
            (name.text.clone(), None),
            if is_number { value } else { Value::Poison },
            name.span,
        );
    }
}

/// Names that statements declare, with their first place.
fn collect_names(list: &[Statement], into: &mut BTreeMap<String, Span>) {
    for statement in list {
        let names: Vec<&ast::Name> = match &statement.kind {
            StatementKind::Coordinates(c) => c.names.iter().map(|d| &d.name).collect(),
            StatementKind::Let(n, _) | StatementKind::Frame(n, _) | StatementKind::Point(n, _) => {
                vec![&n.name]
            }
            StatementKind::Const(n, _) => vec![n],
            StatementKind::Rigid(r) => vec![&r.name.name],
            StatementKind::Instance { name, .. } => vec![&name.name],
            _ => Vec::new(),
        };
        for name in names {
            into.entry(name.text.clone()).or_insert(name.span);
        }
        match &statement.kind {
            StatementKind::Repeat(r) => collect_names(&r.body, into),
            StatementKind::Component(c) => collect_names(&c.body, into),
            _ => {}
        }
    }
}
