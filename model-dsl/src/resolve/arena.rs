//! The arenas of scalars and vectors while they grow, with what each node depends on.

use crate::Span;
use crate::model::{Expr, ExprId, FrameId, FrameVector, Vector, VectorId};
use crate::units::{too_big, whole_power};
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};

/// Most nodes of a model.
pub(crate) const MAX_NODES: usize = 100_000;
/// Longest chain of operations, so that a reader of the model may recurse.
const MAX_DEPTH: u32 = 2_000;

/// Most entries of copied lists.
const MAX_COPIES: usize = 4_000_000;

/// What an expression depends on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Depends {
    pub(crate) parameters: bool,
    pub(crate) coordinates: bool,
    pub(crate) rates: bool,
}

impl Depends {
    fn or(self, other: Self) -> Self {
        Self {
            parameters: self.parameters || other.parameters,
            coordinates: self.coordinates || other.coordinates,
            rates: self.rates || other.rates,
        }
    }

    /// Neither coordinates nor rates.
    pub(crate) fn is_constant(self) -> bool {
        !self.coordinates && !self.rates
    }
}

#[derive(Clone, Copy, Default)]
struct Info {
    depends: Depends,
    depth: u32,
}

impl Info {
    fn or(self, other: Self) -> Self {
        Self { depends: self.depends.or(other.depends), depth: self.depth.max(other.depth) }
    }
}

/// Grows by pushing; a node refers only to earlier ones.
#[derive(Default)]
pub(crate) struct Arena {
    pub(crate) expressions: Vec<(Expr, Span)>,
    pub(crate) vectors: Vec<(Vector, Span)>,
    info: Vec<Info>,
    vector_info: Vec<Info>,
    frame_info: Vec<Info>,
    /// Copies made of lists and texts, in entries.
    copies: usize,
    /// Where a limit was exceeded.
    pub(crate) overflow: Option<(Span, &'static str)>,
}

impl Arena {
    pub(crate) fn push(&mut self, expr: Expr, span: Span) -> ExprId {
        let mut info = self.info_of(&expr);
        info.depth += 1;
        self.check(info.depth, span);
        self.expressions.push((expr, span));
        self.info.push(info);
        ExprId(index(self.expressions.len() - 1))
    }

    pub(crate) fn push_vector(&mut self, vector: Vector, span: Span) -> VectorId {
        let mut info = self.vector_info_of(&vector);
        info.depth += 1;
        self.check(info.depth, span);
        self.vectors.push((vector, span));
        self.vector_info.push(info);
        VectorId(index(self.vectors.len() - 1))
    }

    /// Registers what a new frame's rotations depend on.
    pub(crate) fn push_frame(
        &mut self,
        parent: Option<FrameId>,
        angles: impl Iterator<Item = ExprId>,
    ) {
        let mut info = parent.map_or(Info::default(), |p| self.frame(p));
        for angle in angles {
            info = info.or(self.of(angle));
        }
        info.depth += 1;
        self.frame_info.push(info);
    }

    /// Accounts for a copy of a list or a text, which repetitions multiply.
    pub(crate) fn charge(&mut self, entries: usize, span: Span) {
        self.copies = self.copies.saturating_add(entries);
        if self.copies > MAX_COPIES && self.overflow.is_none() {
            self.overflow =
                Some((span, "repetitions multiply long vectors or texts beyond reason"));
        }
    }

    fn check(&mut self, depth: u32, span: Span) {
        if self.overflow.is_some() {
            return;
        }
        if self.expressions.len() + self.vectors.len() > MAX_NODES {
            self.overflow = Some((span, "the model has more than 100 000 terms"));
        } else if depth > MAX_DEPTH {
            self.overflow = Some((span, "this builds on a chain of more than 2000 operations"));
        }
    }

    pub(crate) fn expr(&self, id: ExprId) -> &Expr {
        &self.expressions[id.0 as usize].0
    }

    pub(crate) fn depends(&self, id: ExprId) -> Depends {
        self.of(id).depends
    }

    pub(crate) fn number(&mut self, value: BigRational, span: Span) -> ExprId {
        self.push(Expr::Number(value), span)
    }

    /// The value, if the node is a plain number.
    pub(crate) fn as_number(&self, id: ExprId) -> Option<&BigRational> {
        match self.expr(id) {
            Expr::Number(value) => Some(value),
            _ => None,
        }
    }

    pub(crate) fn is_zero(&self, id: ExprId) -> bool {
        self.as_number(id).is_some_and(Zero::is_zero)
    }

    fn is_one(&self, id: ExprId) -> bool {
        self.as_number(id).is_some_and(One::is_one)
    }

    fn fold(
        &self,
        a: ExprId,
        b: ExprId,
        f: impl Fn(&BigRational, &BigRational) -> BigRational,
    ) -> Option<Expr> {
        let value = f(self.as_number(a)?, self.as_number(b)?);
        (!too_big(&value)).then_some(Expr::Number(value))
    }

    pub(crate) fn add(&mut self, a: ExprId, b: ExprId, span: Span) -> ExprId {
        let folded = self.fold(a, b, |x, y| x + y);
        self.push(folded.unwrap_or(Expr::Add(a, b)), span)
    }

    pub(crate) fn sub(&mut self, a: ExprId, b: ExprId, span: Span) -> ExprId {
        let folded = self.fold(a, b, |x, y| x - y);
        self.push(folded.unwrap_or(Expr::Sub(a, b)), span)
    }

    pub(crate) fn mul(&mut self, a: ExprId, b: ExprId, span: Span) -> ExprId {
        if self.is_one(a) || self.is_zero(b) {
            return b;
        }
        if self.is_one(b) || self.is_zero(a) {
            return a;
        }
        let folded = self.fold(a, b, |x, y| x * y);
        self.push(folded.unwrap_or(Expr::Mul(a, b)), span)
    }

    /// The divisor must not be the number zero.
    pub(crate) fn div(&mut self, a: ExprId, b: ExprId, span: Span) -> ExprId {
        if self.is_one(b) {
            return a;
        }
        let folded = if self.is_zero(b) { None } else { self.fold(a, b, |x, y| x / y) };
        self.push(folded.unwrap_or(Expr::Div(a, b)), span)
    }

    pub(crate) fn neg(&mut self, a: ExprId, span: Span) -> ExprId {
        let expr = match self.as_number(a) {
            Some(value) => Expr::Number(-value),
            None => Expr::Neg(a),
        };
        self.push(expr, span)
    }

    pub(crate) fn power(&mut self, a: ExprId, exponent: BigRational, span: Span) -> ExprId {
        if exponent.is_one() {
            return a;
        }
        let whole = exponent.is_integer().then(|| exponent.to_i32()).flatten();
        let folded = whole.and_then(|e| whole_power(self.as_number(a)?, e));
        self.push(folded.map_or(Expr::Power(a, exponent), Expr::Number), span)
    }

    fn of(&self, id: ExprId) -> Info {
        self.info[id.0 as usize]
    }

    fn vector(&self, id: VectorId) -> Info {
        self.vector_info[id.0 as usize]
    }

    fn frame(&self, id: FrameId) -> Info {
        self.frame_info.get(id.0 as usize).copied().unwrap_or_default()
    }

    fn info_of(&self, expr: &Expr) -> Info {
        let leaf = |depends| Info { depends, depth: 0 };
        match expr {
            Expr::Number(_) | Expr::Pi => Info::default(),
            Expr::Parameter(_) => leaf(Depends { parameters: true, ..Depends::default() }),
            Expr::Coordinate(_) => leaf(Depends { coordinates: true, ..Depends::default() }),
            Expr::Add(a, b) | Expr::Sub(a, b) | Expr::Mul(a, b) | Expr::Div(a, b) => {
                self.of(*a).or(self.of(*b))
            }
            Expr::Neg(a) | Expr::Power(a, _) => self.of(*a),
            Expr::Call(_, list) => list.iter().fold(Info::default(), |i, a| i.or(self.of(*a))),
            Expr::TimeDerivative(a) => rate(self.of(*a)),
            Expr::Dot(a, b) => self.vector(*a).or(self.vector(*b)),
            Expr::Component(v, _) => self.vector(*v),
        }
    }

    fn vector_info_of(&self, vector: &Vector) -> Info {
        match vector {
            Vector::InFrame(v) => self.frame_vector_info(v),
            Vector::Sum(list) => list.iter().fold(Info::default(), |i, v| i.or(self.vector(*v))),
            Vector::Scaled(e, v) => self.of(*e).or(self.vector(*v)),
            Vector::Cross(a, b) => self.vector(*a).or(self.vector(*b)),
            Vector::TimeDerivative(v) => rate(self.vector(*v)),
            Vector::AngularVelocity(f) => rate(self.frame(*f)),
        }
    }

    fn frame_vector_info(&self, vector: &FrameVector) -> Info {
        vector.entries.iter().fold(self.frame(vector.frame), |i, e| i.or(self.of(*e)))
    }
}

/// A time derivative depends on rates if its argument moves at all.
fn rate(mut info: Info) -> Info {
    info.depends.rates |= info.depends.coordinates;
    info
}

fn index(length: usize) -> u32 {
    u32::try_from(length).unwrap_or(u32::MAX)
}
