//! The expression graph: every value once.
//!
//! Nodes are hash-consed not by their form but by their *value*: the residues of the expression at two
//! fixed random points of a large prime field (sines and cosines at points of the unit circle). Forms
//! that are equal as functions share one node, zero is recognised as zero, and −x is stored as the
//! negative of x, whatever route built them. See [`crate::field`] for why this decides exactly, up to
//! a probability of about 10⁻³⁰ per pair.

mod functions;
mod node;

pub use node::{Id, Node, Symbol, Unary};

use crate::field::{Residue, pseudo_random};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::collections::{BTreeMap, HashMap};
use std::hash::{BuildHasherDefault, Hasher};

/// Residues at the two points.
type Fingerprint = [Residue; 2];

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

    fn combine(&self, a: Id, b: Id, op: fn(Residue, Residue) -> Residue) -> Fingerprint {
        let (x, y) = (self.fingerprints[a.index()], self.fingerprints[b.index()]);
        [op(x[0], y[0]), op(x[1], y[1])]
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
