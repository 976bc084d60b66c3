//! Expression graphs with exact coefficients, calculus on them, and an exact zero oracle.
#![forbid(unsafe_code)]

mod calculus;
mod count;
mod evaluate;
pub mod field;
mod graph;
pub mod interval;
pub mod normal_form;
mod optimise;

pub use calculus::{Tangent, gradient, needed, substitute, symbols_of, transfer};
pub use count::{Operations, count};
pub use evaluate::{evaluate, nearest};
pub use graph::{Graph, Id, Node, Symbol, Unary};
pub use optimise::{Effort, optimise};
