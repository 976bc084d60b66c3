//! Smooth functions, and what the graph knows of them: angles are related by their multiples, roots by
//! their squares, other functions by equal arguments alone.

use super::{Fingerprint, Graph, Id, Node, Unary};
use crate::field::{Residue, UnitPoint, pseudo_random};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// Angles are multiples of `atom / ANGLE_DENOMINATOR`, so that φ/2, 3φ and φ/12 are all related.
const ANGLE_DENOMINATOR: i64 = 2520;

impl Graph {
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
