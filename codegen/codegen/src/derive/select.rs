//! Candidates for a function, and the choice of the cheapest.

use super::quantity::{Block, Function, Quantity};
pub(crate) use shapebot_symbolic::Effort;
use shapebot_symbolic::{Graph, Id, Operations, count, optimise, transfer};

/// One way to compute a function.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    /// Name of the way.
    pub(crate) method: &'static str,
    /// Graph of the values.
    pub(crate) graph: Graph,
    /// Results.
    pub(crate) blocks: Vec<Block>,
}

impl Candidate {
    /// A candidate whose results are values of `graph`.
    pub(crate) fn new(method: &'static str, graph: &Graph, blocks: Vec<Block>) -> Self {
        let ids: Vec<Id> = blocks.iter().flat_map(|b| b.entries.iter().copied()).collect();
        let mut own = Graph::new();
        let images = transfer(graph, &ids, &mut own);
        Self { method, graph: own, blocks: with_entries(blocks, &images) }
    }

    fn ids(&self) -> Vec<Id> {
        self.blocks.iter().flat_map(|b| b.entries.iter().copied()).collect()
    }

    fn optimised(&self, effort: Effort) -> Self {
        let (graph, images) = optimise(&self.graph, &self.ids(), effort);
        let mut own = Graph::new();
        let images = transfer(&graph, &images, &mut own);
        Self { method: self.method, graph: own, blocks: with_entries(self.blocks.clone(), &images) }
    }
}

fn with_entries(mut blocks: Vec<Block>, ids: &[Id]) -> Vec<Block> {
    let mut ids = ids.iter().copied();
    for block in &mut blocks {
        for entry in &mut block.entries {
            if let Some(id) = ids.next() {
                *entry = id;
            }
        }
    }
    blocks
}

/// The cheapest candidate after optimisation; the first of equals.
pub(crate) fn choose(quantity: Quantity, candidates: Vec<Candidate>, effort: Effort) -> Function {
    let mut best: Option<(Candidate, Operations)> = None;
    let mut listed = Vec::new();
    let limit = hopeless(&candidates, effort);
    for candidate in candidates {
        let given = count(&candidate.graph, &candidate.ids());
        if given.flops() > limit {
            listed.push((candidate.method, given));
            continue;
        }
        let candidate = candidate.optimised(effort);
        let operations = count(&candidate.graph, &candidate.ids());
        listed.push((candidate.method, operations));
        if best.as_ref().is_none_or(|(_, least)| operations.flops() < least.flops()) {
            best = Some((candidate, operations));
        }
    }
    let (graph, blocks, method, operations) = match best {
        Some((candidate, operations)) => {
            (candidate.graph, candidate.blocks, candidate.method, operations)
        }
        None => (Graph::new(), Vec::new(), "", Operations::default()),
    };
    Function { quantity, graph, blocks, method, operations, candidates: listed }
}

/// Candidates that are given with more operations than this are not optimised: with quick effort a
/// form rarely loses more than a quarter of its operations.
fn hopeless(candidates: &[Candidate], effort: Effort) -> usize {
    let counts = candidates.iter().map(|c| count(&c.graph, &c.ids()).flops());
    match effort {
        Effort::Quick => counts.min().map_or(usize::MAX, |least| least + least / 4 + 8),
        Effort::Thorough => usize::MAX,
    }
}

/// A scalar result.
pub(crate) fn scalar(name: &'static str, value: Id) -> Vec<Block> {
    vec![Block { name, extents: Vec::new(), entries: vec![value] }]
}

/// A vector result.
pub(crate) fn vector(name: &'static str, entries: Vec<Id>) -> Block {
    Block { name, extents: vec![entries.len()], entries }
}

/// A matrix result.
pub(crate) fn matrix(name: &'static str, rows: &[Vec<Id>]) -> Block {
    let columns = rows.first().map_or(0, Vec::len);
    Block { name, extents: vec![rows.len(), columns], entries: rows.concat() }
}
