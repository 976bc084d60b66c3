//! The syntax tree: what is written, before anything is known about it.

use crate::Span;
use crate::model::{Axis, Comparison, Unit};
use num_rational::BigRational;

/// A name and its place.
#[derive(Clone, Debug)]
pub(crate) struct Name {
    pub(crate) text: String,
    pub(crate) span: Span,
}

/// An expression.
#[derive(Clone, Debug)]
pub(crate) struct Expr {
    pub(crate) kind: ExprKind,
    pub(crate) span: Span,
}

/// Chains of one precedence are lists, so that a long sum is not a deep tree.
#[derive(Clone, Debug)]
pub(crate) enum ExprKind {
    /// Refused already.
    Error,
    Number(BigRational),
    /// `80deg`
    Quantity(BigRational, Name),
    Name(Name),
    Postfix(Box<Expr>, Vec<Postfix>),
    Array(Vec<Expr>),
    Neg(Box<Expr>),
    /// Terms with "is subtracted".
    Sum(Vec<(bool, Expr)>),
    /// Factors with "is divided by".
    Product(Vec<(bool, Expr)>),
    Power(Box<Expr>, Box<Expr>),
    Call(Name, Vec<Expr>),
    Norm(Box<Expr>),
    Derivative(Box<Expr>),
    SumOver(Box<Loop<Expr>>),
}

#[derive(Clone, Debug)]
pub(crate) enum Postfix {
    Member(Name),
    Index(Expr),
}

/// `i in from..=to` over a body.
#[derive(Clone, Debug)]
pub(crate) struct Loop<B> {
    pub(crate) variable: Name,
    pub(crate) from: Expr,
    pub(crate) to: Expr,
    pub(crate) inclusive: bool,
    pub(crate) body: B,
}

/// `name` or `name[i]`.
#[derive(Clone, Debug)]
pub(crate) struct IndexedName {
    pub(crate) name: Name,
    pub(crate) index: Option<Expr>,
}

/// Labels of the entries of a vector.
#[derive(Clone, Debug)]
pub(crate) enum Labels {
    /// `[x, y]`; one label alone may turn out to be an index.
    List(Vec<Expr>),
    /// `[1..=n]`
    Range { from: Expr, to: Expr, inclusive: bool },
}

/// `name`, `name[x, y]`, `name[i][x, y]`.
#[derive(Clone, Debug)]
pub(crate) struct Declarator {
    pub(crate) name: Name,
    pub(crate) brackets: Vec<Labels>,
    pub(crate) span: Span,
}

#[derive(Clone, Debug)]
pub(crate) struct Bounds {
    pub(crate) lower: Expr,
    pub(crate) upper: Expr,
    pub(crate) span: Span,
}

/// A unit with its place; `None` if it was refused.
#[derive(Clone, Debug)]
pub(crate) struct WrittenUnit {
    pub(crate) unit: Option<Unit>,
    /// Contains `deg`, which is no rational multiple of the radian.
    pub(crate) degrees: bool,
    pub(crate) span: Span,
}

#[derive(Clone, Debug)]
pub(crate) struct Parameter {
    pub(crate) name: Name,
    pub(crate) unit: WrittenUnit,
    pub(crate) value: Expr,
    pub(crate) range: Option<Bounds>,
    pub(crate) docs: String,
    pub(crate) span: Span,
}

#[derive(Clone, Debug)]
pub(crate) struct Coordinates {
    pub(crate) position: bool,
    pub(crate) names: Vec<Declarator>,
    pub(crate) unit: WrittenUnit,
    pub(crate) range: Option<Bounds>,
}

/// Type of an argument of a component.
#[derive(Clone, Debug)]
pub(crate) enum ArgumentType {
    Scalar(WrittenUnit),
    /// With labels.
    Array(WrittenUnit, Box<Labels>),
    Frame,
    Point,
}

#[derive(Clone, Debug)]
pub(crate) struct Argument {
    pub(crate) name: Name,
    pub(crate) kind: ArgumentType,
}

#[derive(Clone, Debug)]
pub(crate) struct Component {
    pub(crate) name: Name,
    pub(crate) arguments: Vec<Argument>,
    pub(crate) body: Vec<Statement>,
}

#[derive(Clone, Debug)]
pub(crate) enum Energy {
    Kinetic,
    Potential,
    Lagrangian,
    Dissipation,
}

#[derive(Clone, Debug)]
pub(crate) struct Rigid {
    pub(crate) name: IndexedName,
    pub(crate) fields: Vec<(Name, Expr)>,
}

#[derive(Clone, Debug)]
pub(crate) struct Actuator {
    pub(crate) name: Declarator,
    pub(crate) on: Expr,
    pub(crate) limit: Option<Expr>,
}

#[derive(Clone, Debug)]
pub(crate) struct Geometry {
    pub(crate) name: Option<IndexedName>,
    pub(crate) solid: Name,
    pub(crate) arguments: Vec<Expr>,
    pub(crate) frame: Option<Expr>,
    pub(crate) at: Option<Expr>,
}

#[derive(Clone, Debug)]
pub(crate) enum Requirement {
    ShapeAccelerated,
    Mirror(Expr, Expr),
    Compare(Expr, Comparison, Expr),
}

#[derive(Clone, Debug)]
pub(crate) enum StatementKind {
    Params(Vec<Parameter>),
    Coordinates(Coordinates),
    Let(IndexedName, Expr),
    Const(Name, Expr),
    Frame(IndexedName, Expr),
    Energy(Energy, Expr),
    Rigid(Rigid),
    Gravity { acceleration: Expr, axis: Option<(Axis, i8)> },
    Component(Component),
    Instance { name: IndexedName, component: Name, arguments: Vec<Expr> },
    Repeat(Loop<Vec<Statement>>),
    Actuator(Actuator),
    Output(Expr, WrittenUnit),
    Point(IndexedName, Expr),
    Geometry(Geometry),
    Friction(Expr, Expr),
    Require(Requirement),
}

#[derive(Clone, Debug)]
pub(crate) struct Statement {
    pub(crate) kind: StatementKind,
    pub(crate) docs: String,
    pub(crate) span: Span,
}

#[derive(Clone, Debug)]
pub(crate) struct Robot {
    pub(crate) name: Name,
    pub(crate) docs: String,
    pub(crate) body: Vec<Statement>,
    /// Span of `robot Name`.
    pub(crate) span: Span,
}
