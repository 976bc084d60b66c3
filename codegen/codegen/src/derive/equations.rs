//! The equations of motion of a model in one graph, before they are specialised into functions: what
//! the structure proof and the printed equations work on.

use shapebot_model_dsl::Span;
use shapebot_symbolic::{Graph, Id};

/// M(q) q̈ + C(q, q̇) q̇ + G(q) = B(q) τ with parameters as symbols. Coordinate i is
/// `Symbol::Coordinate(i)`, its rate `Symbol::Rate(i)`; parameters `Symbol::Parameter(i)`.
#[derive(Clone, Debug)]
pub struct Equations {
    /// All values below live here.
    pub graph: Graph,
    /// M(q), n × n.
    pub mass: Vec<Vec<Id>>,
    /// C(q, q̇) q̇, n.
    pub bias: Vec<Id>,
    /// G(q), n.
    pub gravity: Vec<Id>,
    /// Kinetic energy.
    pub kinetic: Id,
    /// Potential energy.
    pub potential: Id,
    /// Input matrix B(q), n rows, one column per actuator.
    pub input: Vec<Vec<Id>>,
    /// Task-space output h(q).
    pub output: Vec<Id>,
    /// Position coordinates come first: this many.
    pub position_count: usize,
    /// Where the energies come from, for messages.
    pub sources: Vec<EnergySource>,
}

/// One rigid body or written term of the Lagrangian.
#[derive(Clone, Debug)]
pub struct EnergySource {
    /// `rigid body trunk`, `kinetic term`, ….
    pub name: String,
    /// Where it is written.
    pub span: Span,
    /// Its kinetic energy.
    pub kinetic: Id,
    /// Its potential energy.
    pub potential: Id,
}

impl Equations {
    /// Number of coordinates.
    #[must_use]
    pub fn len(&self) -> usize {
        self.mass.len()
    }

    /// Never: a model has coordinates.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.mass.is_empty()
    }

    /// Coordinates on whose equations no actuator acts, in order.
    #[must_use]
    pub fn unactuated(&self) -> Vec<usize> {
        let free = |row: &Vec<Id>| row.iter().all(|&b| self.graph.is_zero(b));
        (0..self.len()).filter(|&i| free(&self.input[i])).collect()
    }
}
