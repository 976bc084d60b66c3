//! Frames, rigid bodies, points, solids, gravity.

use super::Resolver;
use super::scope::identifier;
use super::value::{Body, Scalar, Value};
use crate::Span;
use crate::ast::{self, Expr as AstExpr, IndexedName};
use crate::codes;
use crate::diagnostic::Diagnostic;
use crate::model::{self, Axis, Dimension, ExprId, FrameId, Gravity, Point, RigidBody, Solid};
use crate::units::ratio;
use std::rc::Rc;

const FIELDS: &[&str] = &["mass", "inertia", "frame", "com"];

impl<'a> Resolver<'a> {
    pub(super) fn frame(&mut self, name: &'a IndexedName, expr: &'a AstExpr, span: Span) {
        let value = self.eval(expr);
        let Some(key) = self.key(name) else { return };
        let path = self.path(&key);
        let value = match value {
            Value::Turned(parent, turns) => {
                self.claim("frames", &identifier(&path), name.name.span);
                Value::Frame(self.new_frame(path, parent, &turns, span))
            }
            // Another name for a frame.
            Value::Frame(id) => Value::Frame(id),
            Value::Poison => Value::Poison,
            other => {
                self.not_a_frame(&other, expr.span);
                Value::Poison
            }
        };
        self.bind(key, value, name.name.span);
    }

    fn not_a_frame(&mut self, value: &Value<'a>, span: Span) {
        self.sink.push(
            Diagnostic::error(codes::E0404, span, "a frame is needed here")
                .label(format!("this is {}", value.kind()))
                .help("write `world`, the name of a frame, or a frame turned further: `world * rot_y(phi)`"),
        );
    }

    /// The frame that an expression stands for.
    pub(super) fn frame_of(&mut self, expr: &'a AstExpr) -> Option<FrameId> {
        match self.eval(expr) {
            Value::Frame(id) => Some(id),
            Value::Turned(parent, turns) => Some(self.unnamed_frame(parent, &turns, expr.span)),
            Value::Poison => None,
            other => {
                self.not_a_frame(&other, expr.span);
                None
            }
        }
    }

    pub(super) fn rigid(&mut self, rigid: &'a ast::Rigid, docs: &str, span: Span) {
        let key = self.key(&rigid.name);
        let body = key.as_ref().and_then(|key| {
            let path = self.path(key);
            self.body(rigid, path, docs, span)
        });
        let value = body.map_or(Value::Poison, |b| Value::Body(Rc::new(b)));
        self.bind(key.unwrap_or((rigid.name.name.text.clone(), None)), value, rigid.name.name.span);
    }

    fn field(&self, rigid: &'a ast::Rigid, name: &str) -> Option<&'a AstExpr> {
        rigid.fields.iter().find(|(n, _)| n.text == name).map(|(_, e)| e)
    }

    fn body(
        &mut self,
        rigid: &'a ast::Rigid,
        path: String,
        docs: &str,
        span: Span,
    ) -> Option<Body> {
        self.check_fields(rigid);
        let head = rigid.name.name.span;
        let mass = match self.field(rigid, "mass") {
            Some(expr) => self
                .constant_quantity(expr, "a mass", Dimension::MASS)
                .filter(|m| self.not_negative(*m, true, expr.span, "a mass")),
            None => self.missing(head, "mass"),
        };
        let frame = match self.field(rigid, "frame") {
            Some(expr) => self.frame_of(expr),
            None => Some(FrameId::WORLD),
        };
        let inertia = match self.field(rigid, "inertia") {
            Some(expr) => self.inertia(expr),
            None => Some(self.no_inertia(span)),
        };
        if let (Some(expr), Some(FrameId::WORLD)) = (self.field(rigid, "inertia"), frame) {
            self.sink.push(
                Diagnostic::warning(codes::W0502, expr.span, "this inertia has no effect")
                    .label("the body keeps the orientation of the world")
                    .help("name the `frame` that turns with the body, or leave the inertia out"),
            );
        }
        let com = match self.field(rigid, "com") {
            Some(expr) => {
                let value = self.eval(expr);
                self.position(&value, expr.span, "a centre of mass")
            }
            None => self.missing(head, "com"),
        };
        let (mass, frame, inertia, (position, com)) = (mass?, frame?, inertia?, com?);
        self.claim("rigid bodies", &identifier(&path), head);
        let docs = self.copy_of(docs, span);
        self.bodies.push(RigidBody {
            name: path,
            mass: mass.id,
            inertia,
            frame,
            com: position,
            docs,
            span,
        });
        Some(Body { mass, com, frame })
    }

    fn missing<T>(&mut self, span: Span, field: &str) -> Option<T> {
        self.sink.push(
            Diagnostic::error(codes::E0110, span, format!("the rigid body has no `{field}`"))
                .label(format!("`{field}: …` is missing"))
                .help("a rigid body is `{ mass: …, inertia: …, frame: …, com: … }`; a point mass needs `mass` and `com`"),
        );
        None
    }

    fn check_fields(&mut self, rigid: &'a ast::Rigid) {
        for (i, (name, _)) in rigid.fields.iter().enumerate() {
            if let Some((first, _)) = rigid.fields[..i].iter().find(|(n, _)| n.text == name.text) {
                self.sink.push(
                    Diagnostic::error(
                        codes::E0110,
                        name.span,
                        format!("`{}` is given twice", name.text),
                    )
                    .also(first.span, "first given here"),
                );
            }
            if !FIELDS.contains(&name.text.as_str()) {
                let close = crate::suggest::closest(&name.text, FIELDS.iter().copied());
                self.sink.push(
                    Diagnostic::error(
                        codes::E0110,
                        name.span,
                        format!("a rigid body has no field `{}`", name.text),
                    )
                    .note("its fields are `mass`, `inertia`, `frame` and `com`")
                    .maybe_help(close.map(|c| format!("did you mean `{c}`?"))),
                );
            }
        }
    }

    fn no_inertia(&mut self, span: Span) -> [[ExprId; 3]; 3] {
        let zero = self.arena.number(ratio(0, 1), span);
        [[zero; 3]; 3]
    }

    fn inertia(&mut self, expr: &'a AstExpr) -> Option<[[ExprId; 3]; 3]> {
        let matrix = match self.eval(expr) {
            Value::Matrix(m) => *m,
            Value::Scalar(s) => {
                let zero =
                    Scalar { id: self.arena.number(ratio(0, 1), expr.span), dimension: None };
                let mut m = [[zero; 3]; 3];
                (0..3).for_each(|i| m[i][i] = s);
                m
            }
            Value::Poison => return None,
            other => {
                self.sink.push(
                    Diagnostic::error(codes::E0409, expr.span, "an inertia is a scalar or a symmetric matrix")
                        .label(format!("this is {}", other.kind()))
                        .help("write `diag(xx, yy, zz)` or `sym(xx, yy, zz, xy, xz, yz)`; a scalar is that of a sphere"),
                );
                return None;
            }
        };
        for i in 0..3 {
            if !self.not_negative(matrix[i][i], true, expr.span, "a moment of inertia") {
                return None;
            }
        }
        for entry in matrix.iter().flatten() {
            if !self.demand(*entry, Dimension::INERTIA, expr.span, "an inertia") {
                return None;
            }
            if !self.arena.depends(entry.id).is_constant() {
                self.sink.push(
                    Diagnostic::error(
                        codes::E0507,
                        expr.span,
                        "an inertia is a constant in its body's frame",
                    )
                    .label("this changes while the robot moves")
                    .help("name the body's `frame`; its inertia turns with it"),
                );
                return None;
            }
        }
        Some(matrix.map(|row| row.map(|s| s.id)))
    }

    pub(super) fn point(
        &mut self,
        name: &'a IndexedName,
        expr: &'a AstExpr,
        docs: &str,
        span: Span,
    ) {
        let value = self.eval(expr);
        let Some(key) = self.key(name) else { return };
        let value = match self.position(&value, expr.span, "a point") {
            Some((position, vector)) => {
                let path = self.path(&key);
                self.claim("points", &identifier(&path), name.name.span);
                let docs = self.copy_of(docs, span);
                self.points.push(Point { name: path, position, docs, span });
                Value::Vector(vector)
            }
            None => Value::Poison,
        };
        self.bind(key, value, name.name.span);
    }

    pub(super) fn gravity(
        &mut self,
        acceleration: &'a AstExpr,
        axis: Option<(Axis, i8)>,
        span: Span,
    ) {
        let value = self.constant_quantity(
            acceleration,
            "the acceleration of gravity",
            Dimension::ACCELERATION,
        );
        let value = value.filter(|v| {
            self.not_negative(*v, true, acceleration.span, "the acceleration of gravity")
        });
        if let Some(first) = &self.gravity {
            let diagnostic = Diagnostic::error(codes::E0506, span, "gravity is declared twice")
                .also(first.span, "first here");
            self.sink.push(diagnostic);
            return;
        }
        if let (Some(value), Some((axis, sign))) = (value, axis) {
            self.gravity = Some(Gravity { acceleration: value.id, axis, sign, span });
        }
    }

    pub(super) fn geometry(&mut self, geometry: &'a ast::Geometry, span: Span) {
        let solid = self.solid(geometry);
        let frame = match &geometry.frame {
            Some(expr) => self.frame_of(expr),
            None => Some(FrameId::WORLD),
        };
        let center = match &geometry.at {
            Some(expr) => {
                let value = self.eval(expr);
                self.position(&value, expr.span, "the place of a solid").map(|p| p.0)
            }
            None => {
                self.sink.push(
                    Diagnostic::error(codes::E0101, span, "a solid needs a place")
                        .label("`at …` is missing")
                        .help("write `shape sphere(r) at ball;` or `shape box(a, b, c) on body at center;`"),
                );
                None
            }
        };
        let name = self.geometry_name(geometry);
        if let (Some(solid), Some(frame), Some(center), Some(name)) = (solid, frame, center, name) {
            self.claim("solids", &identifier(&name), span);
            self.geometry.push(model::Geometry { name, solid, frame, center, span });
        }
    }

    fn geometry_name(&mut self, geometry: &'a ast::Geometry) -> Option<String> {
        if let Some(name) = &geometry.name {
            let key = self.key(name)?;
            return Some(self.path(&key));
        }
        let prefix = self.scopes[self.scope].prefix.clone();
        let solid = &geometry.solid.text;
        let free = (1..).map(|i| format!("{prefix}{solid}_{i}"));
        free.take(100_000).find(|n| !self.claimed.contains_key(&("solids", identifier(n))))
    }

    fn solid(&mut self, geometry: &'a ast::Geometry) -> Option<Solid> {
        const SOLIDS: &[(&str, usize, &str)] = &[
            ("sphere", 1, "sphere(radius)"),
            ("box", 3, "box(a, b, c) with full edge lengths"),
            ("capsule", 2, "capsule(radius, length)"),
            ("cylinder", 2, "cylinder(radius, length)"),
        ];
        let name = geometry.solid.text.as_str();
        let Some((_, count, usage)) = SOLIDS.iter().find(|(n, ..)| *n == name) else {
            let close = crate::suggest::closest(name, SOLIDS.iter().map(|s| s.0));
            self.sink.push(
                Diagnostic::error(
                    codes::E0208,
                    geometry.solid.span,
                    format!("there is no solid `{name}`"),
                )
                .note("solids are sphere, box, capsule and cylinder")
                .maybe_help(close.map(|c| format!("did you mean `{c}`?"))),
            );
            return None;
        };
        if geometry.arguments.len() != *count {
            self.sink.push(
                Diagnostic::error(
                    codes::E0407,
                    geometry.solid.span,
                    format!("`{name}` takes {count} lengths"),
                )
                .label(format!("{} given", geometry.arguments.len()))
                .help(format!("write `{usage}`")),
            );
            return None;
        }
        let mut sizes = Vec::with_capacity(3);
        for expr in &geometry.arguments {
            sizes.push(
                self.constant_quantity(expr, "a size of a solid", Dimension::LENGTH)
                    .filter(|s| self.not_negative(*s, true, expr.span, "a size of a solid"))
                    .map(|s| s.id),
            );
        }
        let sizes: Vec<ExprId> = sizes.into_iter().collect::<Option<_>>()?;
        Some(match (name, sizes.as_slice()) {
            ("sphere", [r]) => Solid::Sphere(*r),
            ("box", [a, b, c]) => Solid::Box([*a, *b, *c]),
            ("capsule", [r, l]) => Solid::Capsule(*r, *l),
            (_, [r, l]) => Solid::Cylinder(*r, *l),
            _ => return None,
        })
    }
}
