//! Operation counts.

use crate::{Graph, Id, Node, Symbol, Unary};

/// Operations that a straight-line evaluation of a graph executes. Changes of sign are free: they
/// are absorbed by the additions that use them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Additions and subtractions.
    pub additions: usize,
    /// Multiplications.
    pub multiplications: usize,
    /// Divisions.
    pub divisions: usize,
    /// Distinct angles whose sine or cosine is taken.
    pub angles: usize,
    /// Other functions.
    pub functions: usize,
}

impl Operations {
    /// Additions, multiplications and divisions together.
    #[must_use]
    pub const fn flops(&self) -> usize {
        self.additions + self.multiplications + self.divisions
    }
}

/// Operations per evaluation of `ids`. What depends on parameters alone is computed once, when the
/// parameters are set, and does not count.
#[must_use]
pub fn count(graph: &Graph, ids: &[Id]) -> Operations {
    let mut operations = Operations::default();
    let mut angles = std::collections::HashSet::new();
    let mut fixed = std::collections::HashSet::new();
    for id in crate::needed(graph, ids, |_| false) {
        if is_fixed(graph, id, &fixed) {
            fixed.insert(id);
            continue;
        }
        match *graph.node(id) {
            Node::Add(..) | Node::Sub(..) => operations.additions += 1,
            Node::Mul(..) => operations.multiplications += 1,
            Node::Div(..) => operations.divisions += 1,
            Node::Unary(Unary::Sin | Unary::Cos, angle) => {
                if angles.insert(angle) {
                    operations.angles += 1;
                }
            }
            Node::Unary(..) | Node::Atan2(..) => operations.functions += 1,
            Node::Constant(_) | Node::Pi | Node::Symbol(_) | Node::Neg(_) => {}
        }
    }
    operations
}

fn is_fixed(graph: &Graph, id: Id, fixed: &std::collections::HashSet<Id>) -> bool {
    match graph.node(id) {
        Node::Constant(_) | Node::Pi | Node::Symbol(Symbol::Parameter(_)) => true,
        Node::Symbol(_) => false,
        node => node.operands().into_iter().flatten().all(|x| fixed.contains(&x)),
    }
}
