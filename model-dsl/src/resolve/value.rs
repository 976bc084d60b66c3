//! What an expression of the language stands for while it is being resolved.

use super::arena::Arena;
use crate::Span;
use crate::ast;
use crate::model::{Axis, CoordinateId, Dimension, Expr, ExprId, FrameId, FrameVector, VectorId};
use std::rc::Rc;

/// A scalar; without a dimension if it is a literal zero, which fits everywhere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scalar {
    pub(crate) id: ExprId,
    pub(crate) dimension: Option<Dimension>,
}

/// Scalars with labels, not tied to a frame.
#[derive(Clone, Debug)]
pub(crate) struct Array {
    pub(crate) entries: Vec<Scalar>,
    pub(crate) labels: Rc<[String]>,
    /// Places of the entries, if they were written one by one.
    pub(crate) spans: Rc<[Span]>,
}

impl Array {
    pub(crate) fn new(entries: Vec<Scalar>, labels: Rc<[String]>) -> Self {
        Self { entries, labels, spans: Rc::new([]) }
    }
}

/// A geometric vector.
#[derive(Clone, Debug)]
pub(crate) struct Geometric {
    pub(crate) id: VectorId,
    pub(crate) dimension: Option<Dimension>,
    /// Its terms by frame, if it can be a position.
    pub(crate) terms: Option<Rc<Vec<FrameVector>>>,
}

/// A rigid body as other statements see it.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) mass: Scalar,
    pub(crate) com: Geometric,
    pub(crate) frame: FrameId,
}

/// A component made into a part of the robot.
#[derive(Clone, Debug)]
pub(crate) struct Instance<'a> {
    pub(crate) path: String,
    pub(crate) scope: usize,
    pub(crate) component: &'a ast::Component,
}

#[derive(Clone, Debug)]
pub(crate) enum Value<'a> {
    /// Refused already: silences everything built on it.
    Poison,
    Scalar(Scalar),
    Array(Array),
    Vector(Geometric),
    Frame(FrameId),
    /// `rot_y(a) * rot_x(b)`
    Rotation(Rc<Vec<(Axis, ExprId)>>),
    /// A frame turned further, without a name yet.
    Turned(FrameId, Rc<Vec<(Axis, ExprId)>>),
    Matrix(Rc<[[Scalar; 3]; 3]>),
    Body(Rc<Body>),
    Instance(Rc<Instance<'a>>),
    Component(&'a ast::Component, usize),
}

impl Value<'_> {
    /// The kind with its article, for messages.
    pub(crate) fn kind(&self) -> String {
        match self {
            Self::Poison => "something refused".to_owned(),
            Self::Scalar(_) => "a scalar".to_owned(),
            Self::Array(a) => format!("an array of {}", a.entries.len()),
            Self::Vector(_) => "a vector".to_owned(),
            Self::Frame(_) | Self::Turned(..) => "a frame".to_owned(),
            Self::Rotation(_) => "a rotation".to_owned(),
            Self::Matrix(_) => "a matrix".to_owned(),
            Self::Body(_) => "a rigid body".to_owned(),
            Self::Instance(_) => "an instance of a component".to_owned(),
            Self::Component(..) => "a component".to_owned(),
        }
    }

    /// Coordinates, if it is nothing but plain coordinates.
    pub(crate) fn coordinates(&self, arena: &Arena) -> Option<Vec<CoordinateId>> {
        let plain = |s: &Scalar| match arena.expr(s.id) {
            Expr::Coordinate(id) => Some(*id),
            _ => None,
        };
        match self {
            Self::Scalar(s) => Some(vec![plain(s)?]),
            Self::Array(a) => a.entries.iter().map(plain).collect(),
            _ => None,
        }
    }
}

/// `x, y, z`, or `1, 2, …` beyond three.
pub(crate) fn default_labels(count: usize) -> Rc<[String]> {
    if count <= 3 {
        ["x", "y", "z"].iter().take(count).map(|s| (*s).to_owned()).collect()
    } else {
        (1..=count).map(|i| i.to_string()).collect()
    }
}
