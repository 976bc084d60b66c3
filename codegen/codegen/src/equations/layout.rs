//! Normal forms arranged for the eye: common factors out, collected by rates, then by functions of the
//! configuration, then by parameters.

use super::forms::{Atom, Forms};
use super::fraction::Fraction;
use super::polynomial::{Monomial, Polynomial};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use shapebot_symbolic::{Id, Node, Unary};
use std::collections::{BTreeMap, HashMap};

/// A formula.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Tree {
    /// A number that is not negative.
    Number(BigRational),
    /// An atom by its place.
    Atom(usize),
    /// A shared value `a_1`, `a_2`, ….
    Shared(usize),
    /// A power with an exponent of at least two.
    Power(Box<Tree>, u8),
    /// Term terms: at least two.
    Sum(Vec<Term>),
    /// Factors: at least two.
    Product(Vec<Tree>),
    /// Above and below the line.
    Quotient(Box<Tree>, Box<Tree>),
    /// A function of its arguments.
    Apply(Function, Vec<Term>),
}

/// A function as it is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Of(Unary),
    Atan2,
}

/// A formula with its sign.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Term {
    pub(super) negative: bool,
    pub(super) tree: Tree,
}

/// A positive formula.
pub(super) const fn plus(tree: Tree) -> Term {
    Term { negative: false, tree }
}

impl Forms {
    /// A rational function.
    pub(super) fn arrange(&self, form: &Fraction) -> Term {
        if form.denominator == self.ring.one() {
            return self.arrange_polynomial(&form.numerator);
        }
        // 7/(5 g) rather than (7/5)/g.
        let scale = BigRational::from_integer(form.numerator.content().denom().clone());
        let top = self.arrange_polynomial(&form.numerator.scaled(&scale));
        let bottom = self.arrange_polynomial(&form.denominator.scaled(&scale));
        Term {
            negative: top.negative != bottom.negative,
            tree: Tree::Quotient(Box::new(top.tree), Box::new(bottom.tree)),
        }
    }

    /// A polynomial.
    pub(super) fn arrange_polynomial(&self, p: &Polynomial) -> Term {
        if p.is_zero() {
            return plus(Tree::Number(BigRational::zero()));
        }
        let common = p.common_monomial();
        // A sum with more minus than plus signs is the negative of a sum.
        let minus = p.terms.values().filter(|c| c.is_negative()).count();
        let negative = 2 * minus > p.terms.len();
        let mut content = p.content();
        if negative {
            content = -content;
        }
        let mut rest = p.without(&common).scaled(&content.recip());
        let mut sums = Vec::new();
        for factor in &self.factors {
            while rest.terms.len() > factor.terms.len() {
                let Some(quotient) = rest.divided_by(factor) else { break };
                sums.push(self.sum(factor));
                rest = quotient;
            }
        }
        match rest.as_constant() {
            Some(constant) if constant.is_one() => {}
            _ => sums.push(self.squared_sine(&rest).unwrap_or_else(|| self.sum(&rest))),
        }
        Term { negative, tree: self.product(&content.abs(), &common, sums) }
    }

    /// 1 − cos² as sin².
    fn squared_sine(&self, p: &Polynomial) -> Option<Tree> {
        let [(low, one), (high, minus)] =
            <[_; 2]>::try_from(p.terms.iter().collect::<Vec<_>>()).ok()?;
        let cosine = high.iter().position(|&e| e == 2)?;
        let sine = self.ring.cosine_of.iter().position(|&c| c == Some(cosine))?;
        let pattern = degree(low) == 0 && degree(high) == 2 && one.is_one() && (-minus).is_one();
        pattern.then(|| Tree::Power(Box::new(Tree::Atom(sine)), 2))
    }

    /// A number, parameters, a sum, then what moves.
    fn product(&self, number: &BigRational, monomial: &Monomial, sums: Vec<Tree>) -> Tree {
        let mut factors = Vec::new();
        if !number.is_one() {
            factors.push(Tree::Number(number.clone()));
        }
        let power = |i: usize| match monomial[i] {
            1 => Tree::Atom(i),
            e => Tree::Power(Box::new(Tree::Atom(i)), e),
        };
        let used = |layer: fn(u8) -> bool| {
            (0..monomial.len()).filter(move |&i| monomial[i] > 0 && layer(self.layer(i)))
        };
        factors.extend(used(|layer| layer == 0).map(power));
        factors.extend(sums);
        factors.extend(used(|layer| layer > 0).map(power));
        match factors.len() {
            0 => Tree::Number(BigRational::one()),
            1 => factors.remove(0),
            _ => Tree::Product(factors),
        }
    }

    /// A polynomial of at least two terms without common factors.
    fn sum(&self, p: &Polynomial) -> Tree {
        for layer in [2, 1] {
            let groups = self.by_layer(p, layer);
            if groups.len() > 1 {
                return flat_sum(
                    groups.iter().map(|(outer, inner)| self.times(inner, outer)).collect(),
                );
            }
        }
        flat_sum(self.collected(p))
    }

    /// Coefficients of what stands in a layer, simplest first.
    fn by_layer(&self, p: &Polynomial, layer: u8) -> Vec<(Monomial, Polynomial)> {
        let mut groups: BTreeMap<(u32, std::cmp::Reverse<Monomial>), Polynomial> = BTreeMap::new();
        for (monomial, coefficient) in &p.terms {
            let part = |keep: bool| -> Monomial {
                let kept = |i: usize| (self.layer(i) == layer) == keep;
                (0..monomial.len()).map(|i| if kept(i) { monomial[i] } else { 0 }).collect()
            };
            let outer = part(true);
            let degree = outer.iter().map(|&e| u32::from(e)).sum();
            let group = groups.entry((degree, std::cmp::Reverse(outer))).or_default();
            group.terms.insert(part(false), coefficient.clone());
        }
        groups.into_iter().map(|((_, outer), inner)| (outer.0, inner)).collect()
    }

    /// A coefficient times a monomial.
    fn times(&self, inner: &Polynomial, outer: &Monomial) -> Vec<Term> {
        if outer.iter().all(|&e| e == 0) {
            // No brackets around what has no factor.
            let signed = self.arrange_polynomial(inner);
            return match signed.tree {
                Tree::Sum(terms) if !signed.negative => terms,
                _ => vec![signed],
            };
        }
        vec![self.arrange_polynomial(&inner.times_monomial(outer, &BigRational::one()))]
    }

    /// Terms in parameters, those that differ in one factor taken together.
    fn collected(&self, p: &Polynomial) -> Vec<Vec<Term>> {
        let mut left = p.clone();
        let mut groups: Vec<(u32, usize, Monomial, Term)> = Vec::new();
        while let Some((shared, members)) = best_group(&left) {
            let mut inner = Polynomial::default();
            for member in &members {
                if let Some(coefficient) = left.terms.remove(member) {
                    let rest = member.iter().zip(&shared).map(|(x, y)| x - y).collect();
                    inner.terms.insert(rest, coefficient);
                }
            }
            let signed = self.grouped(&inner, &shared);
            groups.push((degree(&members[0]), members.len(), members[0].clone(), signed));
        }
        for (monomial, coefficient) in &left.terms {
            let tree = self.product(&coefficient.abs(), monomial, Vec::new());
            let signed = Term { negative: coefficient.is_negative(), tree };
            groups.push((degree(monomial), 1, monomial.clone(), signed));
        }
        groups.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.cmp(&a.1)).then(b.2.cmp(&a.2)));
        groups.into_iter().map(|group| vec![group.3]).collect()
    }

    /// `(m_b + m_w) r_w^2`, `2 m_a r_w (d_z - l_a)`: what stands first in the order of atoms goes first.
    fn grouped(&self, inner: &Polynomial, shared: &Monomial) -> Term {
        let negative = inner.terms.values().all(Signed::is_negative);
        let mut content = inner.content();
        if negative {
            content = -content;
        }
        let sum = inner.scaled(&content.recip());
        let first = |m: &Monomial| m.iter().position(|&e| e > 0);
        let leading = sum.terms.keys().filter_map(first).min();
        let mut ordered: Vec<Term> = sum
            .terms
            .iter()
            .rev()
            .map(|(m, c)| Term {
                negative: c.is_negative(),
                tree: self.product(&c.abs(), m, Vec::new()),
            })
            .collect();
        positive_first(&mut ordered);
        let sum = Tree::Sum(ordered);
        let number = content.abs();
        let tree = if number.is_one() && leading < first(shared) {
            match self.product(&BigRational::one(), shared, Vec::new()) {
                Tree::Product(mut factors) => {
                    factors.insert(0, sum);
                    Tree::Product(factors)
                }
                single => Tree::Product(vec![sum, single]),
            }
        } else {
            self.product(&number, shared, vec![sum])
        };
        Term { negative, tree }
    }

    /// An atom as a formula of its own: a symbol, or a function of its arranged argument.
    pub(super) fn expand_atom(&mut self, i: usize) -> Option<Tree> {
        let (function, arguments) = match self.atoms[i] {
            Atom::Symbol(_) | Atom::Pi => return None,
            Atom::Circular(function, x) => (Function::Of(function), vec![x]),
            Atom::Opaque(id) => match *self.graph.node(id) {
                Node::Unary(function, x) => (Function::Of(function), vec![x]),
                Node::Atan2(y, x) => (Function::Atan2, vec![y, x]),
                _ => return None,
            },
        };
        let arguments = arguments.into_iter().map(|x| self.readable(x)).collect();
        Some(Tree::Apply(function, arguments))
    }

    /// A value by its normal form, or as the graph computes it.
    pub(super) fn readable(&mut self, id: Id) -> Term {
        match self.of(id) {
            Ok(form) => self.arrange(&form),
            Err(_) => self.as_computed(id, &HashMap::new()),
        }
    }

    /// A value as the graph computes it, shared values by name.
    pub(super) fn as_computed(&self, id: Id, shared: &HashMap<Id, usize>) -> Term {
        if let Some(&name) = shared.get(&id) {
            return plus(Tree::Shared(name));
        }
        self.computed_node(id, shared)
    }

    /// The same, the value itself spelled out.
    pub(super) fn computed_node(&self, id: Id, shared: &HashMap<Id, usize>) -> Term {
        if let Some(place) = self.atom_of(id) {
            return plus(Tree::Atom(place));
        }
        let of = |x: Id| self.as_computed(x, shared);
        match *self.graph.node(id) {
            Node::Constant(ref c) => {
                Term { negative: c.is_negative(), tree: Tree::Number(c.abs()) }
            }
            Node::Add(a, b) => plus(flat_sum(vec![spread(of(a), false), spread(of(b), false)])),
            Node::Sub(a, b) => plus(flat_sum(vec![spread(of(a), false), spread(of(b), true)])),
            Node::Mul(a, b) => multiplied(of(a), of(b)),
            Node::Div(a, b) => {
                let (top, bottom) = (of(a), of(b));
                let tree = Tree::Quotient(Box::new(top.tree), Box::new(bottom.tree));
                Term { negative: top.negative != bottom.negative, tree }
            }
            Node::Neg(a) => {
                let inner = of(a);
                Term { negative: !inner.negative, tree: inner.tree }
            }
            _ => plus(Tree::Number(BigRational::zero())),
        }
    }
}

fn degree(monomial: &Monomial) -> u32 {
    monomial.iter().map(|&e| u32::from(e)).sum()
}

fn multiplied(a: Term, b: Term) -> Term {
    let negative = a.negative != b.negative;
    if a.tree == b.tree && !matches!(a.tree, Tree::Product(_) | Tree::Power(..)) {
        return Term { negative, tree: Tree::Power(Box::new(a.tree), 2) };
    }
    let mut factors = Vec::new();
    for tree in [a.tree, b.tree] {
        match tree {
            Tree::Product(inner) => factors.extend(inner),
            single => factors.push(single),
        }
    }
    Term { negative, tree: Tree::Product(factors) }
}

/// Terms of a sum, or the one term; all negated if so wanted.
fn spread(signed: Term, negate: bool) -> Vec<Term> {
    let flip = signed.negative != negate;
    match signed.tree {
        Tree::Sum(terms) => {
            terms.into_iter().map(|t| Term { negative: t.negative != flip, tree: t.tree }).collect()
        }
        tree => vec![Term { negative: flip, tree }],
    }
}

fn flat_sum(groups: Vec<Vec<Term>>) -> Tree {
    let mut terms: Vec<Term> = groups.into_iter().flatten().collect();
    positive_first(&mut terms);
    if terms.len() == 1 && !terms[0].negative { terms.remove(0).tree } else { Tree::Sum(terms) }
}

/// `d - l` rather than `-l + d`.
fn positive_first(terms: &mut [Term]) {
    if let Some(first) = terms.iter().position(|t| !t.negative) {
        terms[..=first].rotate_right(1);
    }
}

/// The factor that most terms share but for one atom each, and those terms, greatest first.
fn best_group(p: &Polynomial) -> Option<(Monomial, Vec<Monomial>)> {
    let mut groups: BTreeMap<Monomial, Vec<Monomial>> = BTreeMap::new();
    for monomial in p.terms.keys().rev() {
        for i in (0..monomial.len()).filter(|&i| monomial[i] > 0) {
            let mut shared = monomial.clone();
            shared[i] -= 1;
            if shared.iter().any(|&e| e > 0) {
                groups.entry(shared).or_default().push(monomial.clone());
            }
        }
    }
    let kinds = |m: &Monomial| m.iter().filter(|&&e| e > 0).count();
    groups
        .into_iter()
        .filter(|(_, members)| members.len() > 1)
        .max_by(|(a, x), (b, y)| x.len().cmp(&y.len()).then(kinds(b).cmp(&kinds(a))).then(a.cmp(b)))
}
