//! What a value of the graph is made of.

use num_rational::BigRational;

/// A value of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Id(pub(super) u32);

impl Id {
    /// Position in the graph; operands come before the nodes that use them.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// What a symbol stands for. The number is the index of the parameter or coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Symbol {
    /// A parameter of the model.
    Parameter(u32),
    /// A generalised coordinate q_i.
    Coordinate(u32),
    /// Its rate q̇_i.
    Rate(u32),
    /// Its acceleration q̈_i.
    Acceleration(u32),
    /// A generalised force.
    Force(u32),
    /// A placeholder of a derivation, gone before emission.
    Auxiliary(u32),
}

impl Symbol {
    pub(super) const fn key(self) -> [u64; 2] {
        match self {
            Self::Parameter(i) => [1, i as u64],
            Self::Coordinate(i) => [2, i as u64],
            Self::Rate(i) => [3, i as u64],
            Self::Acceleration(i) => [4, i as u64],
            Self::Force(i) => [5, i as u64],
            Self::Auxiliary(i) => [6, i as u64],
        }
    }
}

/// A smooth function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)]
pub enum Unary {
    Sqrt,
    Sin,
    Cos,
    Exp,
    Ln,
    Asin,
    Acos,
    Atan,
}

/// How a value is computed from others.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// An exact number.
    Constant(BigRational),
    /// π.
    Pi,
    /// An input.
    Symbol(Symbol),
    /// Sum.
    Add(Id, Id),
    /// Difference.
    Sub(Id, Id),
    /// Product.
    Mul(Id, Id),
    /// Quotient.
    Div(Id, Id),
    /// Negative.
    Neg(Id),
    /// A function of one argument.
    Unary(Unary, Id),
    /// Angle of the point (x, y): `Atan2(y, x)`.
    Atan2(Id, Id),
}

impl Node {
    /// Operands, in order.
    #[must_use]
    pub fn operands(&self) -> [Option<Id>; 2] {
        match *self {
            Self::Constant(_) | Self::Pi | Self::Symbol(_) => [None, None],
            Self::Neg(a) | Self::Unary(_, a) => [Some(a), None],
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::Div(a, b)
            | Self::Atan2(a, b) => [Some(a), Some(b)],
        }
    }
}
