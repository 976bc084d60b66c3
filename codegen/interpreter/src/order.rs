//! The order in which a tape computes: like operations after each other.

use shapebot_symbolic::{Graph, Id, Node, Unary};
use std::collections::VecDeque;

/// Puts values in an order in which operands come first and values of one kind follow each other as
/// long as there are any: a tape decides once per run of instructions, not once per instruction, what
/// to do. Values that `is_fixed` holds for are left out.
pub(crate) fn batched(graph: &Graph, order: &[Id], is_fixed: impl Fn(Id) -> bool) -> Vec<Id> {
    let size = order.last().map_or(0, |id| id.index() + 1);
    let live = || order.iter().copied().filter(|&id| !is_fixed(id));
    let operands =
        |id: Id| graph.node(id).operands().into_iter().flatten().filter(|&x| !is_fixed(x));
    let mut users: Vec<Vec<Id>> = vec![Vec::new(); size];
    let mut missing = vec![0_usize; size];
    for id in live() {
        for operand in operands(id) {
            users[operand.index()].push(id);
            missing[id.index()] += 1;
        }
    }
    let mut ready: [VecDeque<Id>; KINDS] = Default::default();
    for id in live().filter(|id| missing[id.index()] == 0) {
        ready[kind(graph.node(id))].push_back(id);
    }
    let mut batched = Vec::with_capacity(order.len());
    while let Some(kind_now) = (0..KINDS).max_by_key(|&k| (ready[k].len(), KINDS - k)) {
        if ready[kind_now].is_empty() {
            break;
        }
        while let Some(id) = ready[kind_now].pop_front() {
            batched.push(id);
            for &user in &users[id.index()] {
                missing[user.index()] -= 1;
                if missing[user.index()] == 0 {
                    ready[kind(graph.node(user))].push_back(user);
                }
            }
        }
    }
    batched
}

const KINDS: usize = 8;

const fn kind(node: &Node) -> usize {
    match node {
        Node::Constant(_) | Node::Pi | Node::Symbol(_) => 0,
        Node::Unary(Unary::Sin | Unary::Cos, _) => 1,
        Node::Mul(..) => 2,
        Node::Add(..) => 3,
        Node::Sub(..) => 4,
        Node::Div(..) => 5,
        Node::Neg(_) => 6,
        Node::Unary(..) | Node::Atan2(..) => 7,
    }
}
