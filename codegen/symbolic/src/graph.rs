//! The expression graph: every value once.
//!
//! Nodes are hash-consed not by their form but by their *value*: the residues of the expression at two
//! fixed random points of a large prime field (sines and cosines at points of the unit circle). Forms
//! that are equal as functions share one node, zero is recognised as zero, and −x is stored as the
//! negative of x, whatever route built them. See [`crate::field`] for why this decides exactly, up to
//! a probability of about 10⁻³⁰ per pair.

use crate::field::{Residue, UnitPoint, pseudo_random};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::collections::{BTreeMap, HashMap};
use std::hash::{BuildHasherDefault, Hasher};

/// A value of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Id(u32);

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
    const fn key(self) -> [u64; 2] {
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

/// Residues at the two points.
type Fingerprint = [Residue; 2];

/// Angles are multiples of `atom / ANGLE_DENOMINATOR`, so that φ/2, 3φ and φ/12 are all related.
const ANGLE_DENOMINATOR: i64 = 2520;

/// An expression graph.
#[derive(Clone, Debug)]
pub struct Graph {
    nodes: Vec<Node>,
    fingerprints: Vec<Fingerprint>,
    by_value: HashMap<Fingerprint, Id, BuildHasherDefault<ResidueHasher>>,
    labels: BTreeMap<Id, String>,
    singular: Option<Id>,
}

/// Residues are random already: the first is its own hash.
#[derive(Clone, Copy, Debug, Default)]
struct ResidueHasher(u64);

impl Hasher for ResidueHasher {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, _: &[u8]) {}
    fn write_u64(&mut self, value: u64) {
        self.0 = (self.0 << 7) ^ value;
    }
}

impl Default for Graph {
    fn default() -> Self {
        Self::new()
    }
}

impl Graph {
    /// A graph that holds zero and one.
    #[must_use]
    pub fn new() -> Self {
        let mut graph = Self {
            nodes: Vec::new(),
            fingerprints: Vec::new(),
            by_value: HashMap::default(),
            labels: BTreeMap::new(),
            singular: None,
        };
        graph.constant(BigRational::zero());
        graph.constant(BigRational::one());
        graph
    }

    /// Zero.
    #[must_use]
    pub const fn zero(&self) -> Id {
        Id(0)
    }

    /// One.
    #[must_use]
    pub const fn one(&self) -> Id {
        Id(1)
    }

    /// Number of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Never: zero and one are always there.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The node of a value.
    #[must_use]
    pub fn node(&self, id: Id) -> &Node {
        &self.nodes[id.index()]
    }

    /// The exact number, if the value is one.
    #[must_use]
    pub fn as_constant(&self, id: Id) -> Option<&BigRational> {
        match self.node(id) {
            Node::Constant(value) => Some(value),
            _ => None,
        }
    }

    /// Whether a value is zero for all values of its symbols.
    #[must_use]
    pub fn is_zero(&self, id: Id) -> bool {
        id == self.zero()
    }

    /// Whether two values, possibly of different graphs, are the same function of their symbols.
    #[must_use]
    pub fn same_value(&self, id: Id, other: &Self, other_id: Id) -> bool {
        self.fingerprints[id.index()] == other.fingerprints[other_id.index()]
    }

    /// Names a value for the reader of emitted code: `omega_body_x`. The first name stays.
    pub fn label(&mut self, id: Id, name: impl Into<String>) {
        let nameable = !matches!(self.node(id), Node::Constant(_) | Node::Pi | Node::Symbol(_));
        if nameable {
            self.labels.entry(id).or_insert_with(|| name.into());
        }
    }

    /// The name given to a value.
    #[must_use]
    pub fn label_of(&self, id: Id) -> Option<&str> {
        self.labels.get(&id).map(String::as_str)
    }

    /// The first division by (or logarithm of, or ...) identical zero, if one was asked for. Its value
    /// was replaced by zero; a derivation that meets this must fail.
    #[must_use]
    pub const fn singular(&self) -> Option<Id> {
        self.singular
    }

    /// An exact number.
    pub fn constant(&mut self, value: BigRational) -> Id {
        match Residue::from_rational(&value) {
            Some(residue) => self.intern(Node::Constant(value), [residue, residue]),
            // The denominator is a multiple of p: split it off as a quotient of opaque values.
            None => {
                let tag = pseudo_random(&[0xc0, value.denom().bits()]);
                self.intern(Node::Constant(value), [tag, tag])
            }
        }
    }

    /// A small integer.
    pub fn integer(&mut self, value: i64) -> Id {
        self.constant(BigRational::from_integer(BigInt::from(value)))
    }

    /// A small fraction; `denominator` must not be zero.
    pub fn fraction(&mut self, numerator: i64, denominator: i64) -> Id {
        self.constant(BigRational::new(numerator.into(), denominator.into()))
    }

    /// π.
    pub fn pi(&mut self) -> Id {
        let print = [0, 1].map(|point| pseudo_random(&[0xa1, point]));
        self.intern(Node::Pi, print)
    }

    /// An input.
    pub fn symbol(&mut self, symbol: Symbol) -> Id {
        let [kind, index] = symbol.key();
        let print = [0, 1].map(|point| pseudo_random(&[0x51, kind, index, point]));
        self.intern(Node::Symbol(symbol), print)
    }

    /// Sum.
    pub fn add(&mut self, a: Id, b: Id) -> Id {
        let print = self.combine(a, b, Residue::add);
        if let Some(id) = self.fold(a, b, print, |x, y| x + y) {
            return id;
        }
        if let Some(id) = self.find(print) {
            return id;
        }
        if let Some(id) = self.find(print.map(Residue::neg)) {
            return self.neg(id);
        }
        match (self.node(a).clone(), self.node(b).clone()) {
            (Node::Constant(x), Node::Constant(y)) => self.constant(x + y),
            (Node::Neg(x), Node::Neg(y)) => {
                let sum = self.add(x, y);
                self.neg(sum)
            }
            (_, Node::Neg(y)) => self.intern(Node::Sub(a, y), print),
            (Node::Neg(x), _) => self.intern(Node::Sub(b, x), print),
            (_, Node::Constant(y)) if y.is_negative() => {
                let magnitude = self.constant(-y);
                self.intern(Node::Sub(a, magnitude), print)
            }
            _ => self.intern(Node::Add(a, b), print),
        }
    }

    /// Difference.
    pub fn sub(&mut self, a: Id, b: Id) -> Id {
        let negative = self.neg(b);
        self.add(a, negative)
    }

    /// Negative.
    pub fn neg(&mut self, a: Id) -> Id {
        let print = self.fingerprints[a.index()].map(Residue::neg);
        if let Some(id) = self.find(print) {
            return id;
        }
        match *self.node(a) {
            Node::Constant(ref x) => {
                let value = -x.clone();
                self.constant(value)
            }
            _ => self.intern(Node::Neg(a), print),
        }
    }

    /// Product.
    pub fn mul(&mut self, a: Id, b: Id) -> Id {
        let print = self.combine(a, b, Residue::mul);
        if let Some(id) = self.fold(a, b, print, |x, y| x * y) {
            return id;
        }
        if let Some(id) = self.find(print) {
            return id;
        }
        let negated = print.map(Residue::neg);
        if let Some(id) = self.find(negated) {
            return self.neg(id);
        }
        match (self.node(a).clone(), self.node(b).clone()) {
            (Node::Constant(x), Node::Constant(y)) => self.constant(x * y),
            (Node::Neg(x), Node::Neg(y)) => self.mul(x, y),
            (Node::Neg(x), _) => self.negative_product(x, b),
            (_, Node::Neg(y)) => self.negative_product(a, y),
            (Node::Constant(x), _) => self.scaled(x, b, print),
            (_, Node::Constant(y)) => self.scaled(y, a, print),
            (Node::Unary(Unary::Sqrt, x), Node::Unary(Unary::Sqrt, y)) if x == y => x,
            _ => self.intern(Node::Mul(a, b), print),
        }
    }

    fn negative_product(&mut self, a: Id, b: Id) -> Id {
        let product = self.mul(a, b);
        self.neg(product)
    }

    /// Constant times a value: the constant goes first, is positive, and is merged with a constant
    /// factor that the value has already.
    fn scaled(&mut self, factor: BigRational, value: Id, print: Fingerprint) -> Id {
        if factor.is_negative() {
            let positive = self.constant(-factor);
            return self.negative_product(positive, value);
        }
        if let Node::Mul(c, rest) = *self.node(value)
            && let Some(inner) = self.as_constant(c).cloned()
        {
            let merged = self.constant(factor * inner);
            return self.mul(merged, rest);
        }
        let constant = self.constant(factor);
        self.intern(Node::Mul(constant, value), print)
    }

    /// Quotient. Division by an identical zero is recorded in [`Graph::singular`].
    pub fn div(&mut self, a: Id, b: Id) -> Id {
        let divisor = self.fingerprints[b.index()];
        let (Some(i0), Some(i1)) = (divisor[0].inverse(), divisor[1].inverse()) else {
            self.singular.get_or_insert(a);
            return self.zero();
        };
        let top = self.fingerprints[a.index()];
        let print = [top[0].mul(i0), top[1].mul(i1)];
        if let Some(id) = self.fold(a, b, print, |x, y| x / y) {
            return id;
        }
        if let Some(id) = self.find(print) {
            return id;
        }
        if let Some(id) = self.find(print.map(Residue::neg)) {
            return self.neg(id);
        }
        match (self.node(a).clone(), self.node(b).clone()) {
            (_, Node::Constant(y)) => {
                let inverse = self.constant(y.recip());
                self.mul(inverse, a)
            }
            (Node::Neg(x), Node::Neg(y)) => self.div(x, y),
            (Node::Neg(x), _) => {
                let quotient = self.div(x, b);
                self.neg(quotient)
            }
            (_, Node::Neg(y)) => {
                let quotient = self.div(a, y);
                self.neg(quotient)
            }
            _ => self.intern(Node::Div(a, b), print),
        }
    }

    /// Integer power.
    pub fn powi(&mut self, base: Id, exponent: i32) -> Id {
        let mut result = self.one();
        let (mut square, mut left) = (base, exponent.unsigned_abs());
        while left > 0 {
            if left & 1 == 1 {
                result = self.mul(result, square);
            }
            left >>= 1;
            if left > 0 {
                square = self.mul(square, square);
            }
        }
        if exponent < 0 {
            let one = self.one();
            result = self.div(one, result);
        }
        result
    }

    /// Power with a rational exponent: by products and roots where the denominator is 1 or 2, by
    /// exp(r ln x) else.
    pub fn pow(&mut self, base: Id, exponent: &BigRational) -> Id {
        let numerator = exponent.numer().to_i32();
        match (numerator, exponent.denom().to_u8()) {
            (Some(n), Some(1)) => self.powi(base, n),
            (Some(n), Some(2)) => {
                let root = self.unary(Unary::Sqrt, base);
                self.powi(root, n)
            }
            _ => {
                let log = self.unary(Unary::Ln, base);
                let r = self.constant(exponent.clone());
                let product = self.mul(r, log);
                self.unary(Unary::Exp, product)
            }
        }
    }

    /// A function of one argument.
    pub fn unary(&mut self, function: Unary, x: Id) -> Id {
        if let Some(id) = self.special_value(function, x) {
            return id;
        }
        let print = match function {
            Unary::Sin | Unary::Cos => self.circular(function, x),
            Unary::Sqrt => self.root(x),
            _ => self.opaque(0x70 + function as u64, &[x]),
        };
        if let Some(id) = self.find(print) {
            return id;
        }
        if let Some(id) = self.find(print.map(Residue::neg)) {
            return self.neg(id);
        }
        // sin(−x) = −sin x and cos(−x) = cos x: keep the argument without a sign.
        if let Node::Neg(y) = *self.node(x) {
            match function {
                Unary::Sin => {
                    let sine = self.unary(function, y);
                    return self.neg(sine);
                }
                Unary::Cos => return self.unary(function, y),
                _ => {}
            }
        }
        self.intern(Node::Unary(function, x), print)
    }

    /// Sine.
    pub fn sin(&mut self, x: Id) -> Id {
        self.unary(Unary::Sin, x)
    }

    /// Cosine.
    pub fn cos(&mut self, x: Id) -> Id {
        self.unary(Unary::Cos, x)
    }

    /// Angle of the point (x, y).
    pub fn atan2(&mut self, y: Id, x: Id) -> Id {
        let print = self.opaque(0x90, &[y, x]);
        self.find(print).unwrap_or_else(|| self.intern(Node::Atan2(y, x), print))
    }

    /// Exact values at arguments where a function has one.
    fn special_value(&mut self, function: Unary, x: Id) -> Option<Id> {
        let (zero, one) = (self.zero(), self.one());
        match function {
            Unary::Exp if x == zero => Some(one),
            Unary::Ln if x == one => Some(zero),
            Unary::Ln if x == zero => {
                self.singular.get_or_insert(x);
                Some(zero)
            }
            Unary::Asin | Unary::Atan if x == zero => Some(zero),
            Unary::Acos if x == one => Some(zero),
            Unary::Sqrt => {
                let value = self.as_constant(x)?;
                let (n, d) = (value.numer().sqrt(), value.denom().sqrt());
                let exact =
                    !value.is_negative() && &n * &n == *value.numer() && &d * &d == *value.denom();
                exact.then(|| self.constant(BigRational::new(n, d)))
            }
            _ => None,
        }
    }

    fn combine(&self, a: Id, b: Id, op: fn(Residue, Residue) -> Residue) -> Fingerprint {
        let (x, y) = (self.fingerprints[a.index()], self.fingerprints[b.index()]);
        [op(x[0], y[0]), op(x[1], y[1])]
    }

    /// Residues of a function about which nothing is known but that equal arguments give equal values.
    fn opaque(&self, tag: u64, arguments: &[Id]) -> Fingerprint {
        let mut key = vec![tag];
        for x in arguments {
            key.extend(self.fingerprints[x.index()].map(Residue::value));
        }
        [0, 1].map(|point| {
            key.push(point);
            let value = pseudo_random(&key);
            key.pop();
            value
        })
    }

    fn root(&self, x: Id) -> Fingerprint {
        let opaque = self.opaque(0x60, &[x]);
        let print = self.fingerprints[x.index()];
        [0, 1].map(|point| print[point].sqrt().unwrap_or(opaque[point]))
    }

    fn circular(&mut self, function: Unary, x: Id) -> Fingerprint {
        let points = self.unit_points(x);
        points.map(|p| if function == Unary::Sin { p.sin } else { p.cos })
    }

    /// The points of the unit circle that stand for an angle.
    fn unit_points(&mut self, x: Id) -> [UnitPoint; 2] {
        let mut angle = Angle::default();
        self.decompose(x, &BigRational::one(), &mut angle);
        let mut points = [UnitPoint::IDENTITY; 2];
        let half_turns = angle.pi * BigRational::from_integer(2.into());
        if half_turns.is_integer() {
            let turns = (half_turns.to_integer() % BigInt::from(4)).to_i64().unwrap_or(0);
            points = points.map(|_| UnitPoint::QUARTER.multiple(turns));
        } else {
            let pi = self.pi();
            angle.atoms.push((pi, half_turns / BigRational::from_integer(2.into())));
        }
        for (atom, coefficient) in angle.atoms {
            let scaled = &coefficient * BigRational::from_integer(ANGLE_DENOMINATOR.into());
            let (print, count) = match (scaled.is_integer(), scaled.to_integer().to_i64()) {
                (true, Some(count)) => (self.opaque(0x40, &[atom]), count),
                // An odd denominator: this multiple of the atom is an angle of its own.
                _ => {
                    let factor = self.constant(coefficient);
                    let whole = self.mul(factor, atom);
                    (self.opaque(0x41, &[whole]), 1)
                }
            };
            for point in [0, 1] {
                let unit = UnitPoint::from_half_tangent(print[point]);
                points[point] = points[point].compose(unit.multiple(count));
            }
        }
        points
    }

    /// Writes an angle as a rational combination of atoms and π.
    fn decompose(&self, x: Id, factor: &BigRational, angle: &mut Angle) {
        match *self.node(x) {
            Node::Add(a, b) => {
                self.decompose(a, factor, angle);
                self.decompose(b, factor, angle);
            }
            Node::Sub(a, b) => {
                self.decompose(a, factor, angle);
                self.decompose(b, &-factor, angle);
            }
            Node::Neg(a) => self.decompose(a, &-factor, angle),
            Node::Pi => angle.pi += factor,
            Node::Constant(ref c) if c.is_zero() => {}
            Node::Mul(c, rest) if self.as_constant(c).is_some() => {
                let value = self.as_constant(c).cloned().unwrap_or_else(BigRational::one);
                self.decompose(rest, &(factor * value), angle);
            }
            _ => angle.push(x, factor),
        }
    }

    /// The exact result of an operation on two numbers.
    fn fold(
        &mut self,
        a: Id,
        b: Id,
        print: Fingerprint,
        operation: fn(&BigRational, &BigRational) -> BigRational,
    ) -> Option<Id> {
        let (x, y) = (self.as_constant(a)?, self.as_constant(b)?);
        if let Some(&id) = self.by_value.get(&print) {
            return Some(id);
        }
        let value = operation(x, y);
        Some(self.constant(value))
    }

    /// The residues of a value.
    pub(crate) fn residues(&self, id: Id) -> [Residue; 2] {
        self.fingerprints[id.index()]
    }

    /// The node of this graph that has the value of a node of another graph.
    pub(crate) fn locate(&self, other: &Self, id: Id) -> Option<Id> {
        self.by_value.get(&other.fingerprints[id.index()]).copied()
    }

    /// The node that has this value already, or the constant that it is.
    fn find(&mut self, print: Fingerprint) -> Option<Id> {
        if let Some(&id) = self.by_value.get(&print) {
            return Some(id);
        }
        if print[0] != print[1] {
            return None;
        }
        // The same at both points: a constant, if a small one.
        let (n, d) = print[0].small_fraction()?;
        Some(self.fraction(n, d))
    }

    fn intern(&mut self, node: Node, print: Fingerprint) -> Id {
        if let Some(&id) = self.by_value.get(&print) {
            return id;
        }
        let id = Id(u32::try_from(self.nodes.len()).unwrap_or(u32::MAX));
        self.nodes.push(node);
        self.fingerprints.push(print);
        self.by_value.insert(print, id);
        id
    }
}

#[derive(Default)]
struct Angle {
    atoms: Vec<(Id, BigRational)>,
    pi: BigRational,
}

impl Angle {
    fn push(&mut self, atom: Id, coefficient: &BigRational) {
        match self.atoms.iter_mut().find(|(id, _)| *id == atom) {
            Some((_, sum)) => *sum += coefficient,
            None => self.atoms.push((atom, coefficient.clone())),
        }
    }
}
