//! Greedy extraction: the part whose extraction saves most operations becomes a variable, until no
//! extraction saves any.
//!
//! One mechanism covers common sub-sums, common sub-products and factoring: a·b + a·c holds the pair
//! {b, c} with the common factor a.

use super::divisor::{Divisors, Order, Shape, split};
use super::system::{Kind, System, Variable, multiplications};
use crate::Id;

/// Sums of more terms than this only pair neighbours.
const ALL_PAIRS: usize = 72;
/// So many of them.
const WINDOW: usize = 12;
/// Scales that are tried for one part.
const SCALES: usize = 4;

/// Extracts until nothing is saved.
pub(super) fn extract(system: System, order: Order) -> System {
    let mut extractor =
        Extractor { system, divisors: Divisors::new(order), stamps: Vec::new(), stamp: 0 };
    extractor.note_all();
    extractor.divisors.start();
    while let Some((index, queued)) = extractor.divisors.pop() {
        extractor.consider(index, queued);
    }
    extractor.system
}

/// How to extract a part.
struct Plan {
    saving: i32,
    /// Coefficient of the first term in the new variable.
    scale: Id,
    places: Vec<(u32, u32)>,
}

struct Extractor {
    system: System,
    divisors: Divisors,
    /// Marks terms that the plan at hand uses already.
    stamps: Vec<u32>,
    stamp: u32,
}

impl Extractor {
    fn note_all(&mut self) {
        for variable in 0..self.system.kinds.len() as Variable {
            let mut terms = self.system.terms_of(variable).to_vec();
            for &term in &terms {
                self.divisors.note_products(&mut self.system, term);
            }
            let reach = if terms.len() > ALL_PAIRS { WINDOW } else { ALL_PAIRS };
            if terms.len() > ALL_PAIRS {
                terms.sort_by(|&a, &b| {
                    self.system.term(a).factors.cmp(&self.system.term(b).factors)
                });
            }
            for (i, &a) in terms.iter().enumerate() {
                for &b in terms[i + 1..].iter().take(reach) {
                    self.divisors.note_pair(&mut self.system, a, b);
                }
            }
        }
    }

    /// Notes what a new term makes possible.
    fn note_term(&mut self, term: u32) {
        self.divisors.note_products(&mut self.system, term);
        let owner = self.system.term(term).owner;
        let others = self.system.terms_of(owner);
        let reach = if others.len() > ALL_PAIRS { WINDOW } else { ALL_PAIRS };
        let others: Vec<u32> =
            others.iter().rev().copied().filter(|&t| t != term).take(reach).collect();
        for other in others {
            self.divisors.note_pair(&mut self.system, other, term);
        }
    }

    fn consider(&mut self, index: u32, queued: i32) {
        self.drop_dead(index);
        let Some(plan) = self.plan(index) else { return };
        if plan.saving < queued {
            // Others may be better now.
            self.divisors.settle(index, plan.saving);
            if plan.saving > 0 {
                self.divisors.queue(index, plan.saving);
            }
            return;
        }
        match self.divisors.all[index as usize].shape {
            Shape::Pair => self.extract_pair(index, &plan),
            Shape::Factors(..) | Shape::Scaled(..) => self.extract_product(index, &plan),
        }
        self.divisors.settle(index, 0);
    }

    /// Forgets places that were rewritten, and the part's variable if another sum took it in.
    fn drop_dead(&mut self, index: u32) {
        let system = &self.system;
        let divisor = &mut self.divisors.all[index as usize];
        let alive = |&(a, b): &(u32, u32)| system.term(a).alive && system.term(b).alive;
        divisor.occurrences.retain(alive);
        if divisor.shape != Shape::Pair {
            divisor.occurrences.dedup();
        }
        divisor.extracted =
            divisor.extracted.filter(|&(variable, _)| !system.terms_of(variable).is_empty());
    }

    fn plan(&mut self, index: u32) -> Option<Plan> {
        let divisor = &self.divisors.all[index as usize];
        let definition = i32::from(divisor.extracted.is_none());
        match divisor.shape {
            Shape::Factors(..) | Shape::Scaled(..) => {
                let places = divisor.occurrences.clone();
                let saving = places.len() as i32 - definition;
                Some(Plan { saving, scale: self.system.one(), places })
            }
            Shape::Pair => self.plan_pair(index),
        }
    }

    fn plan_pair(&mut self, index: u32) -> Option<Plan> {
        let divisor = &self.divisors.all[index as usize];
        let places = divisor.occurrences.clone();
        if let Some((_, scale)) = divisor.extracted {
            return Some(self.plan_with_scale(&places, scale, 0));
        }
        let &(a, b) = places.first()?;
        let mut scales = vec![self.system.one()];
        for place in [a, b].into_iter().chain(places.iter().map(|place| place.0)) {
            let scale = self.scale_for(place, a, b);
            if let Some(scale) = scale
                && !scales.contains(&scale)
                && scales.len() < SCALES
            {
                scales.push(scale);
            }
        }
        let mut best: Option<Plan> = None;
        for scale in scales {
            let Some(definition) = self.definition_cost(a, b, scale) else { continue };
            let plan = self.plan_with_scale(&places, scale, definition);
            if best.as_ref().is_none_or(|best| plan.saving > best.saving) {
                best = Some(plan);
            }
        }
        best
    }

    /// The scale with which a place needs no coefficient, or (for `b`) its second term needs none.
    fn scale_for(&mut self, place: u32, a: u32, b: u32) -> Option<Id> {
        let coefficient = self.system.term(place).coefficient;
        if place == b && a != b {
            let first = self.system.term(a).coefficient;
            return self.system.numeric_ratio(first, coefficient);
        }
        Some(coefficient)
    }

    /// Coefficients of the two terms of a part of a given scale.
    fn definition(&mut self, a: u32, b: u32, scale: Id) -> Option<[Id; 2]> {
        let (first, second) = (self.system.term(a).coefficient, self.system.term(b).coefficient);
        let factor = self.system.numeric_ratio(scale, first)?;
        Some([scale, self.system.coefficients.mul(factor, second)])
    }

    fn definition_cost(&mut self, a: u32, b: u32, scale: Id) -> Option<i32> {
        let coefficients = self.definition(a, b, scale)?;
        let [_, x, y] = split(&self.system.term(a).factors, &self.system.term(b).factors);
        let units = coefficients.map(|c| self.system.is_unit(c));
        Some(1 + multiplications(x.len(), units[0]) + multiplications(y.len(), units[1]))
    }

    /// The saving at all places that fit the scale and do not overlap.
    fn plan_with_scale(&mut self, places: &[(u32, u32)], scale: Id, definition: i32) -> Plan {
        self.stamp += 1;
        self.stamps.resize(self.system.terms.len(), 0);
        let mut plan = Plan { saving: -definition, scale, places: Vec::new() };
        for &(a, b) in places {
            if self.stamps[a as usize] == self.stamp || self.stamps[b as usize] == self.stamp {
                continue;
            }
            let Some(saving) = self.saving_at(a, b, scale) else { continue };
            if saving > 0 {
                self.stamps[a as usize] = self.stamp;
                self.stamps[b as usize] = self.stamp;
                plan.saving += saving;
                plan.places.push((a, b));
            }
        }
        plan
    }

    fn saving_at(&mut self, a: u32, b: u32, scale: Id) -> Option<i32> {
        let first = self.system.term(a).coefficient;
        let outer = self.system.numeric_ratio(first, scale)?;
        let (x, y) = (self.system.term(a), self.system.term(b));
        let [common, ..] = split(&x.factors, &y.factors);
        let units = [x, y].map(|term| self.system.is_unit(term.coefficient));
        let before =
            multiplications(x.factors.len(), units[0]) + multiplications(y.factors.len(), units[1]);
        let after = multiplications(common.len() + 1, self.system.is_unit(outer));
        Some(1 + before - after)
    }

    fn extract_pair(&mut self, index: u32, plan: &Plan) {
        let Some(&(a, b)) = plan.places.first() else { return };
        let variable = match self.divisors.all[index as usize].extracted {
            Some((variable, _)) => variable,
            None => {
                let Some(coefficients) = self.definition(a, b, plan.scale) else { return };
                let [_, x, y] = split(&self.system.term(a).factors, &self.system.term(b).factors);
                let variable = self.system.variable(Kind::Sum(Vec::new()));
                self.system.push_term(variable, coefficients[0], x);
                self.system.push_term(variable, coefficients[1], y);
                self.divisors.all[index as usize].extracted = Some((variable, plan.scale));
                variable
            }
        };
        let fresh = self.system.term(a).owner != variable;
        if !fresh {
            return;
        }
        let mut owners = Vec::new();
        for &(a, b) in &plan.places {
            owners.push(self.replace_pair(a, b, variable, plan.scale));
        }
        self.absorb(variable);
        for term in self.system.terms_of(variable).to_vec() {
            self.divisors.note_products(&mut self.system, term);
        }
        self.note_own_pairs(variable);
        for owner in owners {
            self.dissolve(owner);
        }
    }

    fn replace_pair(&mut self, a: u32, b: u32, variable: Variable, scale: Id) -> Variable {
        let (x, y) = (self.system.term(a), self.system.term(b));
        let (owner, coefficient) = (x.owner, x.coefficient);
        let [mut factors, ..] = split(&x.factors, &y.factors);
        factors.push(variable);
        factors.sort_unstable();
        let outer = self.system.numeric_ratio(coefficient, scale).unwrap_or(coefficient);
        self.system.remove_term(a);
        self.system.remove_term(b);
        self.add_term(owner, outer, factors);
        owner
    }

    /// Adds a term to a sum that may have one of the same product already.
    fn add_term(&mut self, owner: Variable, coefficient: Id, factors: Vec<Variable>) {
        let system = &mut self.system;
        let same =
            system.terms_of(owner).iter().copied().find(|&t| system.term(t).factors == factors);
        let mut total = coefficient;
        if let Some(same) = same {
            total = system.coefficients.add(system.term(same).coefficient, coefficient);
            system.remove_term(same);
        }
        if !self.system.coefficients.is_zero(total) {
            let term = self.system.push_term(owner, total, factors);
            self.note_term(term);
        }
    }

    /// Takes in sums that only this one uses any more.
    fn absorb(&mut self, variable: Variable) {
        for number in self.system.terms_of(variable).to_vec() {
            let term = self.system.term(number);
            let &[inner] = term.factors.as_slice() else { continue };
            let alone =
                self.system.uses[inner as usize] == 1 && self.system.terms_of(inner).len() > 1;
            if !alone || !self.system.is_unit(term.coefficient) {
                continue;
            }
            let outer = term.coefficient;
            self.system.remove_term(number);
            for part in self.system.terms_of(inner).to_vec() {
                let term = self.system.term(part);
                let (coefficient, factors) = (term.coefficient, term.factors.clone());
                let coefficient = self.system.coefficients.mul(outer, coefficient);
                self.system.remove_term(part);
                self.system.push_term(variable, coefficient, factors);
            }
        }
    }

    /// Pairs within a new sum; of only two terms it is the sum itself.
    fn note_own_pairs(&mut self, variable: Variable) {
        let terms = self.system.terms_of(variable).to_vec();
        if terms.len() <= 2 {
            return;
        }
        for (i, &a) in terms.iter().enumerate() {
            for &b in terms[i + 1..].iter().take(ALL_PAIRS) {
                self.divisors.note_pair(&mut self.system, a, b);
            }
        }
    }

    /// Replaces a sum of which one variable is left by that variable, wherever it is a factor.
    fn dissolve(&mut self, sum: Variable) {
        let &[number] = self.system.terms_of(sum) else { return };
        let term = self.system.term(number);
        let &[inner] = term.factors.as_slice() else { return };
        let outer = term.coefficient;
        if !self.system.is_unit(outer) {
            return;
        }
        for user in self.system.users[sum as usize].clone() {
            let term = self.system.term(user);
            if !term.alive {
                continue;
            }
            let (owner, mut coefficient) = (term.owner, term.coefficient);
            let mut factors = term.factors.clone();
            for factor in factors.iter_mut().filter(|factor| **factor == sum) {
                *factor = inner;
                coefficient = self.system.coefficients.mul(coefficient, outer);
            }
            factors.sort_unstable();
            self.system.remove_term(user);
            self.add_term(owner, coefficient, factors);
        }
    }

    fn extract_product(&mut self, index: u32, plan: &Plan) {
        let shape = self.divisors.all[index as usize].shape;
        let (definition, coefficient) = match shape {
            Shape::Factors(x, y) => (vec![x, y], self.system.one()),
            Shape::Scaled(c, x) => (vec![x], c),
            Shape::Pair => return,
        };
        let variable = match self.divisors.all[index as usize].extracted {
            Some((variable, _)) => variable,
            None => {
                let variable = self.system.variable(Kind::Sum(Vec::new()));
                self.system.push_term(variable, coefficient, definition.clone());
                self.divisors.all[index as usize].extracted = Some((variable, self.system.one()));
                variable
            }
        };
        for &(place, _) in &plan.places {
            if self.system.term(place).alive {
                self.replace_product(place, &definition, coefficient, variable);
            }
        }
    }

    fn replace_product(
        &mut self,
        place: u32,
        definition: &[Variable],
        scale: Id,
        variable: Variable,
    ) {
        let term = self.system.term(place);
        let (owner, coefficient) = (term.owner, term.coefficient);
        let [_, mut factors, missing] = split(&term.factors, definition);
        if !missing.is_empty() || owner == variable {
            return;
        }
        factors.push(variable);
        factors.sort_unstable();
        let Some(outer) = self.system.numeric_ratio(coefficient, scale) else { return };
        self.system.remove_term(place);
        self.add_term(owner, outer, factors);
    }
}
