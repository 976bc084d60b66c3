//! Values as sums of products of each other: the form that the optimiser works on.

use crate::field::Residue;
use crate::{Graph, Id, Node};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Number of a variable.
pub(super) type Variable = u32;

/// What a variable is.
#[derive(Clone, Debug)]
pub(super) enum Kind {
    /// An input, sine or cosine: a value of the graph of coefficients.
    Given(Id),
    /// A function (or quotient) of other variables; the node's own operands mean nothing here.
    Function(Node, Vec<Variable>),
    /// A sum of terms, given by their numbers.
    Sum(Vec<u32>),
}

/// Coefficient times a product of variables.
#[derive(Clone, Debug)]
pub(super) struct Term {
    /// The variable whose sum this term belongs to.
    pub(super) owner: Variable,
    /// A value of the graph of coefficients.
    pub(super) coefficient: Id,
    /// Sorted.
    pub(super) factors: Vec<Variable>,
    /// Sum of the factors' hashes.
    pub(super) hash: u64,
    /// Whether it has not been replaced yet.
    pub(super) alive: bool,
}

/// Multiplications of a term with so many factors.
pub(super) const fn multiplications(factors: usize, unit: bool) -> i32 {
    if factors == 0 { 0 } else { factors as i32 - unit as i32 }
}

/// A system of sums of products.
#[derive(Clone, Debug)]
pub(super) struct System {
    /// Holds the coefficients, values of parameters alone, and what is given.
    pub(super) coefficients: Graph,
    pub(super) kinds: Vec<Kind>,
    pub(super) terms: Vec<Term>,
    /// Live terms, functions and roots that need a variable.
    pub(super) uses: Vec<u32>,
    /// Terms that had the variable as a factor when they were made.
    pub(super) users: Vec<Vec<u32>>,
    pub(super) roots: Vec<Variable>,
    minus_one: Id,
    /// Residue and its inverse, of coefficients by index.
    residues: Vec<Option<[Residue; 2]>>,
    ratios: HashMap<u64, Option<Id>, BuildHasherDefault<KeyHasher>>,
}

impl System {
    pub(super) fn new(mut coefficients: Graph) -> Self {
        let minus_one = coefficients.integer(-1);
        Self {
            coefficients,
            kinds: Vec::new(),
            terms: Vec::new(),
            uses: Vec::new(),
            users: Vec::new(),
            roots: Vec::new(),
            minus_one,
            residues: Vec::new(),
            ratios: HashMap::default(),
        }
    }

    /// A new variable.
    pub(super) fn variable(&mut self, kind: Kind) -> Variable {
        let variable = self.kinds.len() as Variable;
        if let Kind::Function(_, operands) = &kind {
            for &operand in operands {
                self.uses[operand as usize] += 1;
            }
        }
        self.kinds.push(kind);
        self.uses.push(0);
        self.users.push(Vec::new());
        variable
    }

    /// A new variable that is a sum; terms of one product are added up.
    pub(super) fn sum(&mut self, mut terms: Vec<(Id, Vec<Variable>)>) -> Variable {
        let variable = self.variable(Kind::Sum(Vec::new()));
        terms.sort_by(|a, b| a.1.cmp(&b.1));
        let mut terms = terms.into_iter().peekable();
        while let Some((mut coefficient, factors)) = terms.next() {
            while let Some(same) = terms.next_if(|next| next.1 == factors) {
                coefficient = self.coefficients.add(coefficient, same.0);
            }
            if !self.coefficients.is_zero(coefficient) {
                self.push_term(variable, coefficient, factors);
            }
        }
        variable
    }

    /// Adds a term to a sum.
    pub(super) fn push_term(
        &mut self,
        owner: Variable,
        coefficient: Id,
        factors: Vec<Variable>,
    ) -> u32 {
        let number = self.terms.len() as u32;
        for &factor in &factors {
            self.uses[factor as usize] += 1;
            if self.users[factor as usize].last() != Some(&number) {
                self.users[factor as usize].push(number);
            }
        }
        let hash = factors.iter().fold(0, |sum: u64, &x| sum.wrapping_add(hash_of(x)));
        self.terms.push(Term { owner, coefficient, factors, hash, alive: true });
        if let Kind::Sum(terms) = &mut self.kinds[owner as usize] {
            terms.push(number);
        }
        number
    }

    /// Takes a term out of its sum.
    pub(super) fn remove_term(&mut self, number: u32) {
        let term = &mut self.terms[number as usize];
        term.alive = false;
        for &factor in &term.factors {
            self.uses[factor as usize] -= 1;
        }
        if let Kind::Sum(terms) = &mut self.kinds[term.owner as usize] {
            terms.retain(|&t| t != number);
        }
    }

    /// Numbers of the terms of a sum.
    pub(super) fn terms_of(&self, variable: Variable) -> &[u32] {
        match &self.kinds[variable as usize] {
            Kind::Sum(terms) => terms,
            _ => &[],
        }
    }

    pub(super) fn term(&self, number: u32) -> &Term {
        &self.terms[number as usize]
    }

    pub(super) fn one(&self) -> Id {
        self.coefficients.one()
    }

    /// Whether a coefficient is 1 or −1, which costs nothing.
    pub(super) fn is_unit(&self, coefficient: Id) -> bool {
        coefficient == self.coefficients.one() || coefficient == self.minus_one
    }

    /// Residue and inverse residue of a coefficient.
    pub(super) fn residues(&mut self, coefficient: Id) -> [Residue; 2] {
        let index = coefficient.index();
        if index >= self.residues.len() {
            self.residues.resize(index + 1, None);
        }
        *self.residues[index].get_or_insert_with(|| {
            let residue = self.coefficients.residues(coefficient)[0];
            [residue, residue.inverse().unwrap_or(Residue::ZERO)]
        })
    }

    /// The quotient of coefficients if it is a number: dividing by parameters could divide by zero.
    pub(super) fn numeric_ratio(&mut self, a: Id, b: Id) -> Option<Id> {
        if b == self.one() {
            return Some(a);
        }
        if b == self.minus_one {
            return Some(self.coefficients.neg(a));
        }
        if a == b {
            return Some(self.one());
        }
        let key = mix((a.index() as u64) << 32 | b.index() as u64);
        if let Some(&known) = self.ratios.get(&key) {
            return known;
        }
        let ratio = self.coefficients.div(a, b);
        let divisor_is_number = self.coefficients.as_constant(b).is_some();
        let safe = divisor_is_number || self.coefficients.as_constant(ratio).is_some();
        let ratio = safe.then_some(ratio);
        self.ratios.insert(key, ratio);
        ratio
    }
}

/// A fixed pseudo-random number for each variable.
pub(super) fn hash_of(variable: Variable) -> u64 {
    mix(u64::from(variable) + 1)
}

/// The finaliser of splitmix64.
pub(super) const fn mix(input: u64) -> u64 {
    let z = input.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Keys are mixed already.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct KeyHasher(u64);

impl Hasher for KeyHasher {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, _: &[u8]) {}
    fn write_u64(&mut self, value: u64) {
        self.0 = value;
    }
}
