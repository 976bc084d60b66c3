//! Fewer operations for the same values.
//!
//! The values are taken apart to sums of products ([`flatten`]) or expanded to their normal form
//! ([`crate::normal_form`]), parts that occur several times and common factors are extracted greedily
//! ([`extract`]), and a graph of binary operations is built again ([`emit`]). Several starting forms
//! and orders compete; the one with the fewest operations is kept. Every candidate is compared with
//! the input value by value, and a candidate that differs anywhere is dropped.

mod divisor;
mod emit;
mod extract;
mod flatten;
mod system;

use crate::normal_form::{Polynomials, expand};
use crate::{Graph, Id, count, needed, transfer};
use divisor::Order;
use flatten::Policy;

/// How long to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effort {
    /// One or two starting forms: for everything.
    Quick,
    /// Many of them: for the functions that run in a control loop.
    Thorough,
}

/// Searches for a graph that computes the same values with fewer operations (see [`count`]). The
/// result never needs more of them than the input and is the same in every run.
#[must_use]
pub fn optimise(graph: &Graph, ids: &[Id], effort: Effort) -> (Graph, Vec<Id>) {
    let mut search = Search::new(graph, ids);
    search.run(effort);
    search.finish()
}

/// The values as the normal form's terms, without any search.
pub(crate) fn emit_polynomials(polynomials: &Polynomials) -> (Graph, Vec<Id>) {
    let system = emit::from_polynomials(polynomials);
    emit::emit(&system).unwrap_or_else(|| (Graph::new(), Vec::new()))
}

const PLAIN: Policy = Policy { distribute: 0, copy: 0, factors: 6 };
const OPEN: Policy = Policy { distribute: 4, copy: 3, factors: 6 };
const POLICIES: [Policy; 3] = [
    Policy { distribute: 20, copy: 0, factors: 6 },
    Policy { distribute: 0, copy: 3, factors: 2 },
    Policy { distribute: 2, copy: 0, factors: 2 },
];
const EVEN: Order = Order { product_weight: 8, seed: 0 };
const SUMS_FIRST: Order = Order { product_weight: 4, seed: 0 };
const ORDERS: [Order; 3] = [SUMS_FIRST, EVEN, Order { product_weight: 10, seed: 2 }];
/// Rounds that start from the best candidate.
const ROUNDS: usize = 4;

/// The best candidate so far.
struct Search<'a> {
    source: &'a Graph,
    wanted: &'a [Id],
    graph: Graph,
    ids: Vec<Id>,
    cost: (usize, usize),
}

impl<'a> Search<'a> {
    fn new(source: &'a Graph, wanted: &'a [Id]) -> Self {
        let mut graph = Graph::new();
        let ids = transfer(source, wanted, &mut graph);
        Self { source, wanted, cost: cost(source, wanted), graph, ids }
    }

    fn run(&mut self, effort: Effort) {
        self.try_graph(PLAIN, EVEN);
        if effort == Effort::Quick {
            self.again(PLAIN);
            return;
        }
        self.try_graph(PLAIN, SUMS_FIRST);
        let given = self.cost;
        self.try_normal_form();
        if self.cost == given {
            for policy in POLICIES {
                self.try_graph(policy, SUMS_FIRST);
            }
        }
        for _ in 0..ROUNDS {
            let before = self.cost;
            self.again(OPEN);
            self.again(PLAIN);
            if self.cost == before {
                break;
            }
        }
    }

    fn try_graph(&mut self, policy: Policy, order: Order) {
        let system = flatten::flatten(self.source, self.wanted, policy);
        self.offer(emit::emit(&extract::extract(system, order)));
    }

    /// Starts from the best candidate.
    fn again(&mut self, policy: Policy) {
        let system = flatten::flatten(&self.graph, &self.ids, policy);
        self.offer(emit::emit(&extract::extract(system, SUMS_FIRST)));
    }

    fn try_normal_form(&mut self) {
        let flops = count(&self.graph, &self.ids).flops();
        let Some(polynomials) = expand(self.source, self.wanted, 100 + 3 * flops) else { return };
        // A term costs about one operation in the end.
        if polynomials.terms() > flops + flops / 4 + 10 {
            return;
        }
        let system = emit::from_polynomials(&polynomials);
        for order in ORDERS {
            self.offer(emit::emit(&extract::extract(system.clone(), order)));
        }
    }

    /// Takes a candidate if it is cheaper and has the same values.
    fn offer(&mut self, candidate: Option<(Graph, Vec<Id>)>) {
        let Some((graph, ids)) = candidate else { return };
        let cost = cost(&graph, &ids);
        let same = ids.len() == self.wanted.len()
            && ids
                .iter()
                .zip(self.wanted)
                .all(|(&id, &wanted)| self.source.same_value(wanted, &graph, id));
        if same && cost < self.cost && graph.singular().is_none() {
            (self.graph, self.ids, self.cost) = (graph, ids, cost);
        }
    }

    fn finish(mut self) -> (Graph, Vec<Id>) {
        for id in needed(self.source, self.wanted, |_| false) {
            if let Some(name) = self.source.label_of(id)
                && let Some(image) = self.graph.locate(self.source, id)
            {
                self.graph.label(image, name);
            }
        }
        (self.graph, self.ids)
    }
}

/// Operations per evaluation, and functions among them: sines are to stay shared.
fn cost(graph: &Graph, ids: &[Id]) -> (usize, usize) {
    let operations = count(graph, ids);
    (operations.flops() + 20 * (operations.functions + operations.angles), operations.divisions)
}
