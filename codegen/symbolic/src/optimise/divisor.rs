//! What can be extracted: pairs of terms and pairs of factors, found by key.

use super::system::{KeyHasher, System, Variable, hash_of, mix, multiplications};
use crate::Id;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};
use std::hash::BuildHasherDefault;

/// A part that occurs, perhaps several times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// x + r·y in b·x + r·b·y: the two terms without their common factors, up to a scale.
    Pair,
    /// x·y.
    Factors(Variable, Variable),
    /// c·x, up to sign.
    Scaled(Id, Variable),
}

/// A part and where it occurs.
#[derive(Clone, Debug)]
pub(super) struct Divisor {
    pub(super) shape: Shape,
    /// Numbers of terms; of one term twice for products.
    pub(super) occurrences: Vec<(u32, u32)>,
    /// The variable that it has become, and the coefficient of x in it.
    pub(super) extracted: Option<(Variable, Id)>,
    /// At most so many operations are saved.
    bound: i32,
    queued: i32,
}

/// How parts of equal promise are ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Order {
    /// Weight of a saving by common factors, in eighths of that by common sums.
    pub(super) product_weight: i32,
    /// Breaks ties.
    pub(super) seed: u64,
}

/// All parts, the most promising one first.
#[derive(Clone, Debug)]
pub(super) struct Divisors {
    pub(super) all: Vec<Divisor>,
    by_key: HashMap<u64, u32, BuildHasherDefault<KeyHasher>>,
    /// Weighted saving, tie-breaker, part, saving.
    heap: BinaryHeap<(i32, u64, Reverse<u32>, i32)>,
    order: Order,
    /// Whether everything is still being noted and nothing is queued yet.
    collecting: bool,
}

impl Divisors {
    pub(super) fn new(order: Order) -> Self {
        let (all, by_key, heap) = (Vec::new(), HashMap::default(), BinaryHeap::new());
        Self { all, by_key, heap, order, collecting: true }
    }

    /// Queues what has been noted so far, and from now on whatever is noted.
    pub(super) fn start(&mut self) {
        self.collecting = false;
        for index in 0..self.all.len() {
            let bound = self.all[index].bound;
            if bound > 0 {
                self.queue(index as u32, bound);
            }
        }
    }

    /// Notes the products in a term.
    pub(super) fn note_products(&mut self, system: &mut System, number: u32) {
        let term = system.term(number);
        let (coefficient, factors) = (term.coefficient, term.factors.clone());
        for (i, &x) in factors.iter().enumerate() {
            for &y in &factors[i + 1..] {
                let key = mix(hash_of(x).wrapping_add(hash_of(y)) ^ 0x51);
                self.note(key, Shape::Factors(x, y), (number, number), 1, 1);
            }
        }
        if system.is_unit(coefficient) {
            return;
        }
        let [residue, _] = system.residues(coefficient);
        let magnitude = residue.value().min(residue.neg().value());
        for (i, &x) in factors.iter().enumerate() {
            if i == 0 || factors[i - 1] != x {
                let key = mix(hash_of(x) ^ mix(magnitude ^ 0x53));
                self.note(key, Shape::Scaled(coefficient, x), (number, number), 1, 1);
            }
        }
    }

    /// Notes the part that two terms of one sum have.
    pub(super) fn note_pair(&mut self, system: &mut System, first: u32, second: u32) {
        let (count, common) = overlap(&system.term(first).factors, &system.term(second).factors);
        let rest = |number: u32| system.term(number).hash.wrapping_sub(common);
        let (a, b) = if rest(first) <= rest(second) { (first, second) } else { (second, first) };
        let (hash_a, hash_b) = (rest(a), rest(b));
        let (x, y) = (system.term(a), system.term(b));
        let (factors_a, factors_b) = (x.factors.len(), y.factors.len());
        let (coefficient_a, coefficient_b) = (x.coefficient, y.coefficient);
        let units = (system.is_unit(coefficient_a), system.is_unit(coefficient_b));
        let ratio = system.residues(coefficient_b)[0].mul(system.residues(coefficient_a)[1]);
        let key = mix(hash_a ^ mix(hash_b ^ mix(ratio.value())));
        let before = multiplications(factors_a, units.0) + multiplications(factors_b, units.1);
        let worth = 1 + before - count as i32;
        let definition =
            1 + multiplications(factors_a - count, true) + multiplications(factors_b - count, true);
        self.note(key, Shape::Pair, (a, b), worth, definition);
    }

    fn note(&mut self, key: u64, shape: Shape, place: (u32, u32), worth: i32, definition: i32) {
        let fresh = self.all.len() as u32;
        let index = *self.by_key.entry(key).or_insert(fresh);
        if index == fresh {
            let bound = -definition;
            self.all.push(Divisor {
                shape,
                occurrences: Vec::new(),
                extracted: None,
                bound,
                queued: 0,
            });
        }
        let divisor = &mut self.all[index as usize];
        divisor.occurrences.push(place);
        divisor.bound += worth;
        if divisor.bound > divisor.queued && !self.collecting {
            let bound = divisor.bound;
            self.queue(index, bound);
        }
    }

    /// Puts a part in the queue with a (possible) saving.
    pub(super) fn queue(&mut self, index: u32, saving: i32) {
        let divisor = &mut self.all[index as usize];
        divisor.queued = saving;
        let weight = if divisor.shape == Shape::Pair { 8 } else { self.order.product_weight };
        let tie = if self.order.seed == 0 {
            divisor.occurrences.len() as u64
        } else {
            mix(u64::from(index) ^ self.order.seed)
        };
        self.heap.push((saving * weight, tie, Reverse(index), saving));
    }

    /// The most promising part and the saving that it was queued with.
    pub(super) fn pop(&mut self) -> Option<(u32, i32)> {
        while let Some((_, _, Reverse(index), saving)) = self.heap.pop() {
            let divisor = &mut self.all[index as usize];
            if divisor.queued == saving {
                divisor.queued = 0;
                return Some((index, saving));
            }
        }
        None
    }

    /// Corrects the bound after an evaluation.
    pub(super) fn settle(&mut self, index: u32, bound: i32) {
        self.all[index as usize].bound = bound;
    }
}

/// Number and hash of the factors that two sorted products have in common.
fn overlap(a: &[Variable], b: &[Variable]) -> (usize, u64) {
    let (mut i, mut j, mut count, mut hash) = (0, 0, 0, 0_u64);
    while i < a.len() && j < b.len() {
        match a[i].cmp(&b[j]) {
            std::cmp::Ordering::Less => i += 1,
            std::cmp::Ordering::Greater => j += 1,
            std::cmp::Ordering::Equal => {
                hash = hash.wrapping_add(hash_of(a[i]));
                count += 1;
                i += 1;
                j += 1;
            }
        }
    }
    (count, hash)
}

/// Splits two sorted products into common factors and the two rests.
pub(super) fn split(a: &[Variable], b: &[Variable]) -> [Vec<Variable>; 3] {
    let [mut common, mut left] = [Vec::new(), Vec::new()];
    let mut right = b.to_vec();
    for &x in a {
        match right.iter().position(|&y| y == x) {
            Some(place) => common.push(right.remove(place)),
            None => left.push(x),
        }
    }
    [common, left, right]
}
