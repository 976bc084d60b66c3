//! The checked model: what a model file means, before any calculus.
//!
//! Everything here has passed name resolution and dimension checking. Scalars live in one arena
//! ([`Model::expressions`]), geometric vectors in another ([`Model::vectors`]); both keep the span of
//! the text they came from. The kinematic tree (frames, rigid bodies and the frames their centres of
//! mass are written in) is kept as a tree; nothing is multiplied out.

use crate::Span;
use num_rational::BigRational;

/// Index of a scalar expression in [`Model::expressions`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ExprId(pub u32);

/// Index of a geometric vector in [`Model::vectors`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VectorId(pub u32);

/// Index of a frame in [`Model::frames`]; [`FrameId::WORLD`] is the inertial frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FrameId(pub u32);

impl FrameId {
    /// The inertial frame, always the first of [`Model::frames`].
    pub const WORLD: Self = Self(0);
}

/// Index into [`Model::parameters`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ParameterId(pub u32);

/// Index into [`Model::coordinates`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CoordinateId(pub u32);

/// A physical dimension: exponents of metre, kilogram and second. Angles are dimensionless.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Dimension {
    /// Exponents of (m, kg, s), each as a fraction `numerator / denominator` in lowest terms.
    pub exponents: [(i16, i16); 3],
}

/// A unit as written in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Its dimension.
    pub dimension: Dimension,
    /// Its text, normalised: `kg*m^2`, `rad`, `1`.
    pub text: String,
    /// How many SI units one such unit is (`deg` as a unit is refused for parameters; `mm` is 1/1000).
    pub scale: BigRational,
}

/// A scalar constant of the robot.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Identifier in emitted code and on the command line: `I_b_xx`.
    pub name: String,
    /// As the file addresses it: `I_b.xx`, `r_w`.
    pub path: String,
    /// Unit.
    pub unit: Unit,
    /// The model's own value in SI units: a constant expression (numbers and pi only).
    pub value: ExprId,
    /// The same, rounded to the nearest double.
    pub value_f64: f64,
    /// Allowed values in SI units, if declared.
    pub range: Option<Range>,
    /// Doc comment, lines joined by `\n`.
    pub docs: String,
    /// Where it is declared.
    pub span: Span,
}

/// A closed interval in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Smallest allowed value.
    pub lower: f64,
    /// Largest allowed value.
    pub upper: f64,
}

/// Role of a coordinate in the paper's sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// One of q_x.
    Position,
    /// One of q_s.
    Shape,
}

/// A generalised coordinate. Order in [`Model::coordinates`]: all position coordinates in the order
/// of the file, then all shape coordinates in the order of the file.
#[derive(Clone, Debug)]
pub struct Coordinate {
    /// Identifier in emitted code: `phi_x`.
    pub name: String,
    /// As the file addresses it: `phi.x`.
    pub path: String,
    /// Position or shape.
    pub role: Role,
    /// Index of its declared vector in [`Model::sets`].
    pub set: usize,
    /// Unit.
    pub unit: Unit,
    /// Declared range in SI units.
    pub range: Option<Range>,
    /// Where it is declared.
    pub span: Span,
}

/// A declared vector of coordinates. Shape coordinates declared together form a shape set.
#[derive(Clone, Debug)]
pub struct CoordinateSet {
    /// Identifier: `alpha_l`.
    pub name: String,
    /// Position or shape.
    pub role: Role,
    /// Members, in order.
    pub coordinates: Vec<CoordinateId>,
    /// Doc comment.
    pub docs: String,
    /// Where it is declared.
    pub span: Span,
}

/// A smooth function of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Sqrt,
    Exp,
    Ln,
    /// Two arguments: y, x.
    Atan2,
}

/// A scalar expression, resolved and dimension-checked. `let` bindings are shared nodes.
#[derive(Clone, Debug)]
pub enum Expr {
    /// An exact number in SI units.
    Number(BigRational),
    /// Ratio of a circle's circumference to its diameter.
    Pi,
    /// A parameter.
    Parameter(ParameterId),
    /// A generalised coordinate.
    Coordinate(CoordinateId),
    /// Sum.
    Add(ExprId, ExprId),
    /// Difference.
    Sub(ExprId, ExprId),
    /// Product.
    Mul(ExprId, ExprId),
    /// Quotient.
    Div(ExprId, ExprId),
    /// Negative.
    Neg(ExprId),
    /// Power with an exact rational exponent.
    Power(ExprId, BigRational),
    /// A smooth function.
    Call(Function, Vec<ExprId>),
    /// Total time derivative.
    TimeDerivative(ExprId),
    /// Scalar product of two geometric vectors.
    Dot(VectorId, VectorId),
    /// Component of a geometric vector along an axis (0, 1, 2) of the world frame.
    Component(VectorId, u8),
}

/// A geometric vector: never flattened to world components.
#[derive(Clone, Debug)]
pub enum Vector {
    /// Components along the axes of a frame.
    InFrame(FrameVector),
    /// Sum.
    Sum(Vec<VectorId>),
    /// Scalar multiple.
    Scaled(ExprId, VectorId),
    /// Vector product.
    Cross(VectorId, VectorId),
    /// Total time derivative as seen from the world frame.
    TimeDerivative(VectorId),
    /// Angular velocity of a frame relative to the world.
    AngularVelocity(FrameId),
}

/// Three components along the axes of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameVector {
    /// The frame.
    pub frame: FrameId,
    /// Components along its x, y and z axes.
    pub entries: [ExprId; 3],
}

/// A position relative to the world's origin, as the sum of terms each written in a frame:
/// `ball + body*[0, 0, l_b]` has a world term and a body term. Terms of one frame are merged.
#[derive(Clone, Debug, PartialEq)]
pub struct Position {
    /// Terms, parents before children.
    pub terms: Vec<FrameVector>,
}

/// Coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Axis {
    X,
    Y,
    Z,
}

/// An orientation relative to a parent: successive rotations about the axes of the turned frame,
/// `world * rot_y(a) * rot_x(b)` being `R_y(a) R_x(b)`.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Path with the instance: `left.arm`, `body`, `world`.
    pub name: String,
    /// Parent; the world has none.
    pub parent: Option<FrameId>,
    /// Elementary rotations, first applied first.
    pub rotations: Vec<(Axis, ExprId)>,
    /// Where it is declared.
    pub span: Span,
}

/// A rigid body.
#[derive(Clone, Debug)]
pub struct RigidBody {
    /// Path with the instance: `left.weight`.
    pub name: String,
    /// Mass.
    pub mass: ExprId,
    /// Inertia about the centre of mass along the axes of `frame`, symmetric.
    pub inertia: [[ExprId; 3]; 3],
    /// Its orientation.
    pub frame: FrameId,
    /// Its centre of mass.
    pub com: Position,
    /// Doc comment.
    pub docs: String,
    /// Where it is declared.
    pub span: Span,
}

/// A term of the Lagrangian, with the place it was written.
#[derive(Clone, Debug)]
pub struct EnergyTerm {
    /// The expression.
    pub expr: ExprId,
    /// Doc comment.
    pub docs: String,
    /// Where it is written.
    pub span: Span,
}

/// Uniform gravity acting on all rigid bodies.
#[derive(Clone, Debug)]
pub struct Gravity {
    /// Magnitude.
    pub acceleration: ExprId,
    /// World axis and sign it points along: `-world.z` is `(Z, -1)`.
    pub axis: Axis,
    /// +1 or -1.
    pub sign: i8,
    /// Where it is declared.
    pub span: Span,
}

/// One motor: its generalised force does work on the rate of `displacement`.
#[derive(Clone, Debug)]
pub struct Actuator {
    /// Identifier: `tau_ball_x`.
    pub name: String,
    /// The motor acts on d/dt of this.
    pub displacement: ExprId,
    /// Largest magnitude of its force or torque in SI units, if declared.
    pub limit: Option<ExprId>,
    /// Unit of its force: energy per unit of displacement.
    pub unit: Unit,
    /// Doc comment.
    pub docs: String,
    /// Where it is declared.
    pub span: Span,
}

/// Dry friction: a force of constant magnitude against the rate of `displacement`.
#[derive(Clone, Debug)]
pub struct CoulombFriction {
    /// Magnitude.
    pub level: ExprId,
    /// It acts against d/dt of this.
    pub displacement: ExprId,
    /// Where it is declared.
    pub span: Span,
}

/// Task-space output h(q), in which motions are desired and errors counted.
#[derive(Clone, Debug)]
pub struct Output {
    /// Entries.
    pub entries: Vec<ExprId>,
    /// Their names: the last path segment where an entry is a plain path (`ball.x`), else `out_0`.
    pub names: Vec<String>,
    /// Their unit.
    pub unit: Unit,
    /// Where it is declared.
    pub span: Span,
}

/// A named point.
#[derive(Clone, Debug)]
pub struct Point {
    /// Path with the instance.
    pub name: String,
    /// Where it is.
    pub position: Position,
    /// Doc comment.
    pub docs: String,
    /// Where it is declared.
    pub span: Span,
}

/// Form of a body for animation and pushes.
#[derive(Clone, Debug)]
pub enum Solid {
    /// Radius.
    Sphere(ExprId),
    /// Full edge lengths along the frame's axes.
    Box([ExprId; 3]),
    /// Radius and length between the centres of the caps, along the frame's z axis.
    Capsule(ExprId, ExprId),
    /// Radius and length, along the frame's z axis.
    Cylinder(ExprId, ExprId),
}

/// A solid placed in a frame.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// Name for the animation; unique.
    pub name: String,
    /// Its form.
    pub solid: Solid,
    /// Its orientation.
    pub frame: FrameId,
    /// Its centre.
    pub center: Position,
    /// Where it is declared.
    pub span: Span,
}

/// A comparison between constant expressions of the parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Comparison {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

/// What the author demands of the model.
#[derive(Clone, Debug)]
pub enum Requirement {
    /// `require shape_accelerated;`
    ShapeAccelerated,
    /// `require mirror(left, right);`: reflecting the robot in its x-z plane while exchanging the two
    /// instances leaves the dynamics unchanged. Pairs of exchanged coordinates are listed.
    Mirror {
        /// Names of the two instances.
        instances: (String, String),
        /// Coordinates passed to the first and to the second instance, in the order of the arguments.
        exchanged: Vec<(CoordinateId, CoordinateId)>,
    },
    /// A condition on parameters, checked by `Params::validate` as well.
    Compare(ExprId, Comparison, ExprId),
}

/// A requirement with its place.
#[derive(Clone, Debug)]
pub struct Required {
    /// What is required.
    pub requirement: Requirement,
    /// Where it is written.
    pub span: Span,
}

/// A robot.
#[derive(Clone, Debug)]
pub struct Model {
    /// Type name: `BallbotWithArms`.
    pub name: String,
    /// The `//!` lines of the file and the doc comment of the robot, joined by `\n`.
    pub docs: String,
    /// Name of the source for messages: a path or `<inline>`.
    pub source_name: String,
    /// The text itself.
    pub source: String,
    /// Parameters, in the order of the file.
    pub parameters: Vec<Parameter>,
    /// Coordinates: q = [q_x, q_s].
    pub coordinates: Vec<Coordinate>,
    /// Declared vectors of coordinates, in the order of their first coordinate.
    pub sets: Vec<CoordinateSet>,
    /// Scalar arena; an expression refers only to earlier ones.
    pub expressions: Vec<(Expr, Span)>,
    /// Vector arena; a vector refers only to earlier ones.
    pub vectors: Vec<(Vector, Span)>,
    /// Frames, parents before children; the first is the world.
    pub frames: Vec<Frame>,
    /// Rigid bodies.
    pub bodies: Vec<RigidBody>,
    /// Kinetic energy terms beside those of the rigid bodies.
    pub kinetic: Vec<EnergyTerm>,
    /// Potential energy terms beside gravity on the rigid bodies.
    pub potential: Vec<EnergyTerm>,
    /// Bare Lagrangian terms, T - V in one.
    pub lagrangian: Vec<EnergyTerm>,
    /// Gravity.
    pub gravity: Option<Gravity>,
    /// Motors.
    pub actuators: Vec<Actuator>,
    /// Rayleigh dissipation functions.
    pub dissipation: Vec<EnergyTerm>,
    /// Dry friction.
    pub friction: Vec<CoulombFriction>,
    /// Task-space output; the position coordinates themselves if none is declared.
    pub output: Option<Output>,
    /// Named points.
    pub points: Vec<Point>,
    /// Solids.
    pub geometry: Vec<Geometry>,
    /// Requirements.
    pub requirements: Vec<Required>,
}

impl Model {
    /// A scalar expression.
    #[must_use]
    pub fn expr(&self, id: ExprId) -> &Expr {
        &self.expressions[id.0 as usize].0
    }

    /// Where a scalar expression was written.
    #[must_use]
    pub fn expr_span(&self, id: ExprId) -> Span {
        self.expressions[id.0 as usize].1
    }

    /// A geometric vector.
    #[must_use]
    pub fn vector(&self, id: VectorId) -> &Vector {
        &self.vectors[id.0 as usize].0
    }

    /// The text of a span.
    #[must_use]
    pub fn text(&self, span: Span) -> &str {
        self.source.get(span.start as usize..span.end as usize).unwrap_or("")
    }

    /// Line and column (both from 1, columns in characters) of the start of a span.
    #[must_use]
    pub fn line_column(&self, span: Span) -> (usize, usize) {
        let before = self.source.get(..span.start as usize).unwrap_or("");
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }

    /// Number of position coordinates, n_x.
    #[must_use]
    pub fn position_count(&self) -> usize {
        self.coordinates.iter().filter(|c| c.role == Role::Position).count()
    }
}
