//! What is derived from a model, and the code-neutral form in which it reaches emitter, interpreter
//! and report.

use shapebot_symbolic::{Graph, Id, Operations};

/// A derived function of the state. Indices count frames, points and actuators of the model's lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// M(q), n × n.
    MassMatrix,
    /// C(q, q̇) of the Christoffel symbols, n × n.
    CoriolisMatrix,
    /// C q̇, n.
    CoriolisVector,
    /// G(q), n.
    Gravity,
    /// Kinetic energy.
    KineticEnergy,
    /// Potential energy.
    PotentialEnergy,
    /// ∂M/∂q: n layers of n × n.
    MassMatrixJacobian,
    /// ∂(C q̇)/∂q, n × n.
    CoriolisVectorJacobianQ,
    /// ∂(C q̇)/∂q̇, n × n.
    CoriolisVectorJacobianQd,
    /// ∂G/∂q, n × n.
    GravityJacobian,
    /// M q̈ + C q̇ + G, n.
    InverseDynamics,
    /// M⁻¹(f − C q̇ − G), n; `f` are the symbols [`shapebot_symbolic::Symbol::Force`].
    ForwardDynamics,
    /// Blocks `mass_matrix`, `coriolis_vector`, `gravity` in one schedule.
    Motion,
    /// −∂D/∂q̇ of the declared dissipation, n.
    DissipativeForce,
    /// Column of B for one actuator, n.
    InputColumn(usize),
    /// Centre of mass of all rigid bodies, 3.
    CenterOfMass,
    /// Axes of a frame as columns, 3 × 3.
    FrameRotation(usize),
    /// World position of a point, 3.
    PointPosition(usize),
    /// ∂(position of a point)/∂q, 3 × n.
    PointJacobian(usize),
    /// h(q), n_x.
    Output,
    /// ∂h/∂q_x, n_x × n_x, constant.
    OutputJacobianPosition,
    /// ∂h/∂q_s, n_x × n_s.
    OutputJacobianShape,
    /// Γ(q_s, q̇_s, q̈_s), n_x.
    Gamma,
    /// Γ′(q_s), n_x.
    GammaPrime,
    /// ∂Γ′/∂q_s, n_x × n_s.
    GammaPrimeJacobian,
    /// K⁰_qs, n_x × n_s, of parameters alone.
    ShapeGain,
    /// Blocks `gamma` (n_x), `d_qs`, `d_qsd`, `d_qsdd` (n_x × n_s each) in one schedule.
    Response,
}

/// One array among the results of a function.
#[derive(Clone, Debug)]
pub struct Block {
    /// Field name in a bundle (`mass_matrix`, `gamma`, …).
    pub name: &'static str,
    /// Extents: `[]` a scalar, `[n]` a vector, `[rows, columns]` a matrix, `[layers, rows, columns]`.
    pub extents: Vec<usize>,
    /// Entries, last index fastest.
    pub entries: Vec<Id>,
}

/// A derived function: the cheapest of the candidates that were built for it.
#[derive(Clone, Debug)]
pub struct Function {
    /// What it is.
    pub quantity: Quantity,
    /// Its graph: nothing but what the blocks need. Labels name values for the reader.
    pub graph: Graph,
    /// Results.
    pub blocks: Vec<Block>,
    /// Name of the candidate that won: `recursion over the tree`, `trigonometric normal form`, ….
    pub method: &'static str,
    /// Its operations per call.
    pub operations: Operations,
    /// All candidates with their operations.
    pub candidates: Vec<(&'static str, Operations)>,
}

impl Function {
    /// All results in one list, block after block.
    #[must_use]
    pub fn results(&self) -> Vec<Id> {
        self.blocks.iter().flat_map(|block| block.entries.iter().copied()).collect()
    }
}
