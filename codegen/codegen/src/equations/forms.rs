//! Values of the graph in normal form: rational functions of atoms.

use super::fraction::Fraction;
use super::polynomial::{Polynomial, Ring, TooLarge};
use num_rational::BigRational;
use shapebot_model_dsl::model::Model;
use shapebot_symbolic::{Graph, Id, Node, Symbol, Unary, needed};
use std::collections::HashMap;

/// What normal forms are polynomials in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Atom {
    /// A symbol.
    Symbol(Symbol),
    /// π.
    Pi,
    /// Sine or cosine of a value.
    Circular(Unary, Id),
    /// Another function: nothing is known about it.
    Opaque(Id),
}

/// A graph with the normal forms of some of its values.
pub(super) struct Forms {
    pub(super) graph: Graph,
    pub(super) ring: Ring,
    pub(super) atoms: Vec<Atom>,
    /// Sums that long polynomials are split by in print.
    pub(super) factors: Vec<Polynomial>,
    place: HashMap<Id, usize>,
    known: HashMap<Id, Result<Fraction, TooLarge>>,
}

impl Forms {
    /// Prepares for values that are made of what `ids` are made of.
    pub(super) fn new(model: &Model, graph: Graph, ids: &[Id]) -> Self {
        let mut forms = Self {
            graph,
            ring: Ring::default(),
            atoms: Vec::new(),
            factors: Vec::new(),
            place: HashMap::new(),
            known: HashMap::new(),
        };
        let mut found: Vec<(Rank, Atom, Id)> = Vec::new();
        for id in needed(&forms.graph, ids, |_| false) {
            let atom = match *forms.graph.node(id) {
                Node::Symbol(symbol) => Atom::Symbol(symbol),
                Node::Pi => Atom::Pi,
                // Both partners, so that squares of sines have somewhere to go.
                Node::Unary(function @ (Unary::Sin | Unary::Cos), x) => {
                    let other = if function == Unary::Sin { Unary::Cos } else { Unary::Sin };
                    let partner = forms.graph.unary(other, x);
                    if *forms.graph.node(partner) == Node::Unary(other, x) {
                        found.push((
                            rank(model, &forms.graph, Atom::Circular(other, x)),
                            Atom::Circular(other, x),
                            partner,
                        ));
                    }
                    Atom::Circular(function, x)
                }
                Node::Unary(..) | Node::Atan2(..) => Atom::Opaque(id),
                _ => continue,
            };
            found.push((rank(model, &forms.graph, atom), atom, id));
        }
        found.sort_by(|a, b| (&a.0, a.2).cmp(&(&b.0, b.2)));
        found.dedup_by_key(|entry| entry.2);
        for (_, atom, id) in found {
            forms.place.insert(id, forms.atoms.len());
            forms.atoms.push(atom);
        }
        forms.ring = Ring::new(forms.atoms.iter().map(|&atom| forms.partner(atom)).collect());
        forms
    }

    fn partner(&self, atom: Atom) -> Option<usize> {
        let Atom::Circular(Unary::Sin, x) = atom else { return None };
        self.atoms.iter().position(|&a| a == Atom::Circular(Unary::Cos, x))
    }

    /// Normal form of a value.
    pub(super) fn of(&mut self, id: Id) -> Result<Fraction, TooLarge> {
        for step in needed(&self.graph, &[id], |x| {
            self.known.contains_key(&x) || self.place.contains_key(&x)
        }) {
            let form = self.step(step);
            self.known.insert(step, form);
        }
        self.look_up(id)
    }

    fn look_up(&self, id: Id) -> Result<Fraction, TooLarge> {
        match self.place.get(&id) {
            Some(&place) => Ok(Fraction::of(&self.ring, self.ring.atom(place))),
            None => self.known.get(&id).cloned().unwrap_or(Err(TooLarge)),
        }
    }

    fn step(&self, id: Id) -> Result<Fraction, TooLarge> {
        let ring = &self.ring;
        let of = |x: Id| self.look_up(x);
        match *self.graph.node(id) {
            Node::Constant(ref c) => Ok(Fraction::of(ring, ring.constant(c.clone()))),
            Node::Add(a, b) => of(a)?.add(ring, &of(b)?),
            Node::Sub(a, b) => of(a)?.add(ring, &of(b)?.neg()),
            Node::Mul(a, b) => of(a)?.mul(ring, &of(b)?),
            Node::Div(a, b) => of(a)?.div(ring, &of(b)?),
            Node::Neg(a) => Ok(of(a)?.neg()),
            Node::Symbol(_) | Node::Pi | Node::Unary(..) | Node::Atan2(..) => Err(TooLarge),
        }
    }

    /// The value of a normal form, back in the graph: equal values are one node there.
    pub(super) fn value(&mut self, form: &Fraction) -> Id {
        let top = self.polynomial_value(&form.numerator);
        let bottom = self.polynomial_value(&form.denominator);
        self.graph.div(top, bottom)
    }

    pub(super) fn polynomial_value(&mut self, p: &Polynomial) -> Id {
        let ids: Vec<Id> = (0..self.atoms.len()).map(|i| self.atom_id(i)).collect();
        let mut sum = self.graph.zero();
        for (monomial, coefficient) in &p.terms {
            let mut term = self.graph.constant(coefficient.clone());
            for (&atom, &exponent) in ids.iter().zip(monomial) {
                if exponent > 0 {
                    let power = self.graph.powi(atom, i32::from(exponent));
                    term = self.graph.mul(term, power);
                }
            }
            sum = self.graph.add(sum, term);
        }
        sum
    }

    fn atom_id(&mut self, i: usize) -> Id {
        match self.atoms[i] {
            Atom::Symbol(symbol) => self.graph.symbol(symbol),
            Atom::Pi => self.graph.pi(),
            Atom::Circular(function, x) => self.graph.unary(function, x),
            Atom::Opaque(id) => id,
        }
    }

    /// Whether a value is an atom, and which.
    pub(super) fn atom_of(&self, id: Id) -> Option<usize> {
        self.place.get(&id).copied()
    }

    /// What is collected last, outermost in print: 0 parameters, 1 functions of the configuration,
    /// 2 rates, accelerations and forces.
    pub(super) fn layer(&self, i: usize) -> u8 {
        match self.atoms[i] {
            Atom::Symbol(Symbol::Parameter(_)) | Atom::Pi => 0,
            Atom::Symbol(Symbol::Coordinate(_)) | Atom::Circular(..) | Atom::Opaque(_) => 1,
            Atom::Symbol(_) => 2,
        }
    }
}

/// Plain coordinates in their order, then other angles.
fn angle_key(graph: &Graph, x: Id) -> String {
    match *graph.node(x) {
        Node::Symbol(Symbol::Coordinate(i)) => format!("0{i:08}"),
        _ => format!("1{:08}", x.index()),
    }
}

/// Order in print: masses, inertias, gravity, lengths, functions of the configuration, rates.
type Rank = (u8, String, u32);

fn rank(model: &Model, graph: &Graph, atom: Atom) -> Rank {
    match atom {
        Atom::Symbol(Symbol::Parameter(i)) => {
            let Some(parameter) = model.parameters.get(i as usize) else {
                return (4, String::new(), i);
            };
            let exponents = parameter.unit.dimension.exponents;
            let class = match exponents
                .map(|(n, d)| BigRational::new(n.into(), d.max(1).into()).to_integer())
            {
                e if e == [0.into(), 1.into(), 0.into()] => 0,
                e if e == [2.into(), 1.into(), 0.into()] => 1,
                e if e == [1.into(), 0.into(), (-2).into()] => 2,
                _ => 3,
            };
            (class, parameter.name.to_lowercase(), i)
        }
        Atom::Pi => (0, String::new(), 0),
        Atom::Symbol(Symbol::Coordinate(i)) => (5, String::new(), i),
        // By angle, the cosine before the sine.
        Atom::Circular(function, x) => (6, angle_key(graph, x), u32::from(function == Unary::Sin)),
        Atom::Opaque(_) => (7, String::new(), 0),
        Atom::Symbol(Symbol::Rate(i)) => (8, String::new(), i),
        Atom::Symbol(Symbol::Acceleration(i)) => (9, String::new(), i),
        Atom::Symbol(Symbol::Force(i) | Symbol::Auxiliary(i)) => (10, String::new(), i),
    }
}
