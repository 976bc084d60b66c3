//! Functions of a Lagrangian system.

use super::lower::number;
use super::mechanics::Mechanics;
use super::quantity::{Block, Function, Quantity};
use super::recursion::BodyForm;
use super::select::{Candidate, Effort, choose, matrix, scalar, vector};
use super::solve;
use shapebot_symbolic::{Graph, Id, Symbol, Tangent, gradient};

const RECURSION: &str = "recursion over the tree";
const MOMENTS: &str = "recursion over the tree, second moments";
const COMPOSITES: &str = "composite bodies over the tree";
const ENERGY: &str = "derivatives of the energy";
const MASS_MATRIX: &str = "derivatives of the mass matrix";
const FORWARD: &str = "forward sweep";
const REVERSE: &str = "reverse sweep";

/// All functions of the Lagrangian system but kinematics.
pub(crate) fn functions(base: &Mechanics<'_>) -> Vec<Function> {
    let mass = mass_matrix(base);
    let bias = coriolis_vector(base, &mass);
    let gravity = gravity(base);
    let mut out = vec![
        coriolis_matrix(base, &mass),
        kinetic_energy(base),
        potential_energy(base),
        mass_jacobian(base, &mass),
        jacobian(base, Quantity::CoriolisVectorJacobianQ, &bias, Symbol::Coordinate),
        jacobian(base, Quantity::CoriolisVectorJacobianQd, &bias, Symbol::Rate),
        jacobian(base, Quantity::GravityJacobian, &gravity, Symbol::Coordinate),
        inverse_dynamics(base),
        motion(&mass, &bias, &gravity),
        forward_dynamics(base, &mass),
        dissipative_force(base),
    ];
    out.extend([mass, bias, gravity]);
    out
}

/// M in three ways.
pub(crate) fn mass_matrix(base: &Mechanics<'_>) -> Function {
    let mut candidates = Vec::new();
    let mut work = base.clone();
    if let Some(mass) = work.mass_by_composites() {
        candidates.push(Candidate::new(
            COMPOSITES,
            work.graph(),
            vec![matrix("mass_matrix", &mass)],
        ));
    }
    let mut work = base.clone();
    let mass = work.mass_from_energy();
    candidates.push(Candidate::new(ENERGY, work.graph(), vec![matrix("mass_matrix", &mass)]));
    choose(Quantity::MassMatrix, candidates, Effort::Thorough)
}

/// C q̇: by recursion, and as Ṁ q̇ − ½ ∂(q̇ᵀ M q̇)/∂q from the mass matrix found.
fn coriolis_vector(base: &Mechanics<'_>, mass: &Function) -> Function {
    let mut candidates = Vec::new();
    for (method, form) in [(RECURSION, BodyForm::Tensor), (MOMENTS, BodyForm::SecondMoments)] {
        let mut work = base.clone();
        let bias = work.bias_by_recursion(form);
        candidates.push(Candidate::new(
            method,
            work.graph(),
            vec![vector("coriolis_vector", bias)],
        ));
    }
    if let Some((graph, bias)) = bias_from_mass(base, mass) {
        candidates.push(Candidate::new(MASS_MATRIX, &graph, vec![vector("coriolis_vector", bias)]));
    }
    choose(Quantity::CoriolisVector, candidates, Effort::Thorough)
}

/// Above this many operations of M its derivatives are no candidate for C q̇.
const MASS_LIMIT: usize = 150;

fn bias_from_mass(base: &Mechanics<'_>, mass: &Function) -> Option<(Graph, Vec<Id>)> {
    if mass.operations.flops() > MASS_LIMIT {
        return None;
    }
    let mut graph = mass.graph.clone();
    let n = base.count();
    let rates = rates(&mut graph, n);
    let entries = mass.results();
    let momenta: Vec<Id> = (0..n)
        .map(|i| super::vector::dot(&mut graph, &entries[i * n..(i + 1) * n], &rates))
        .collect();
    let seeds = (0..n).map(|i| (Symbol::Coordinate(number(i)), rates[i]));
    let mut time = Tangent::new(seeds);
    let twice = super::vector::dot(&mut graph, &momenta, &rates);
    let half = graph.fraction(1, 2);
    let symbols: Vec<Symbol> = (0..n).map(|i| Symbol::Coordinate(number(i))).collect();
    let slopes = gradient(&mut graph, &[(twice, half)], &symbols);
    let bias = (0..n)
        .map(|i| {
            let change = time.of(&mut graph, momenta[i]);
            graph.sub(change, slopes[i])
        })
        .collect();
    Some((graph, bias))
}

fn rates(graph: &mut Graph, n: usize) -> Vec<Id> {
    (0..n).map(|i| graph.symbol(Symbol::Rate(number(i)))).collect()
}

/// G: statics over the tree, and the slope of the potential.
fn gravity(base: &Mechanics<'_>) -> Function {
    let mut work = base.clone();
    let by_tree = work.gravity_by_recursion();
    let first = Candidate::new(RECURSION, work.graph(), vec![vector("gravity", by_tree)]);
    let mut work = base.clone();
    let from_energy = work.gravity_from_energy();
    let second = Candidate::new(ENERGY, work.graph(), vec![vector("gravity", from_energy)]);
    choose(Quantity::Gravity, vec![first, second], Effort::Thorough)
}

fn kinetic_energy(base: &Mechanics<'_>) -> Function {
    let mut work = base.clone();
    let energy = work.kinetic();
    let candidate = Candidate::new(RECURSION, work.graph(), scalar("kinetic_energy", energy));
    choose(Quantity::KineticEnergy, vec![candidate], Effort::Quick)
}

fn potential_energy(base: &Mechanics<'_>) -> Function {
    let mut work = base.clone();
    let energy = work.potential();
    let candidate = Candidate::new(RECURSION, work.graph(), scalar("potential_energy", energy));
    choose(Quantity::PotentialEnergy, vec![candidate], Effort::Quick)
}

/// Derivatives of the entries of M by each coordinate: `[k][i][j]`.
fn mass_slopes(graph: &mut Graph, mass: &[Id], n: usize) -> Vec<Vec<Id>> {
    (0..n)
        .map(|k| {
            let mut tangent = Tangent::partial(graph, Symbol::Coordinate(number(k)));
            mass.iter().map(|&m| tangent.of(graph, m)).collect()
        })
        .collect()
}

fn mass_jacobian(base: &Mechanics<'_>, mass: &Function) -> Function {
    let n = base.count();
    let mut graph = mass.graph.clone();
    let entries = mass_slopes(&mut graph, &mass.results(), n).concat();
    let block = Block { name: "mass_matrix_jacobian", extents: vec![n, n, n], entries };
    let candidate = Candidate::new(FORWARD, &graph, vec![block]);
    choose(Quantity::MassMatrixJacobian, vec![candidate], Effort::Quick)
}

/// C_ij = Σ_k ½ (∂M_ij/∂q_k + ∂M_ik/∂q_j − ∂M_jk/∂q_i) q̇_k.
fn coriolis_matrix(base: &Mechanics<'_>, mass: &Function) -> Function {
    let n = base.count();
    let mut graph = mass.graph.clone();
    let slopes = mass_slopes(&mut graph, &mass.results(), n);
    let rates = rates(&mut graph, n);
    let half = graph.fraction(1, 2);
    let halves: Vec<Id> = rates.iter().map(|&r| graph.mul(half, r)).collect();
    let d = |k: usize, i: usize, j: usize| slopes[k][i * n + j];
    // Ṁ/2 is symmetric; the rest is the skew part ½ Σ_k (∂M_ik/∂q_j − ∂M_jk/∂q_i) q̇_k.
    let mut rows = vec![vec![graph.zero(); n]; n];
    for i in 0..n {
        for j in i..n {
            let (mut even, mut odd) = (graph.zero(), graph.zero());
            for k in 0..n {
                let part = graph.mul(d(k, i, j), halves[k]);
                even = graph.add(even, part);
                let difference = graph.sub(d(j, i, k), d(i, j, k));
                let part = graph.mul(difference, halves[k]);
                odd = graph.add(odd, part);
            }
            rows[i][j] = graph.add(even, odd);
            rows[j][i] = graph.sub(even, odd);
        }
    }
    let direct = christoffel(&mut graph, &slopes, &rates, n);
    let first =
        Candidate::new("symmetric and skew parts", &graph, vec![matrix("coriolis_matrix", &rows)]);
    let second =
        Candidate::new("Christoffel symbols", &graph, vec![matrix("coriolis_matrix", &direct)]);
    choose(Quantity::CoriolisMatrix, vec![first, second], Effort::Quick)
}

fn christoffel(graph: &mut Graph, slopes: &[Vec<Id>], rates: &[Id], n: usize) -> Vec<Vec<Id>> {
    let d = |k: usize, i: usize, j: usize| slopes[k][i * n + j];
    let half = graph.fraction(1, 2);
    let entry = |graph: &mut Graph, i: usize, j: usize| {
        let mut sum = graph.zero();
        for (k, &rate) in rates.iter().enumerate() {
            let both = graph.add(d(k, i, j), d(j, i, k));
            let symbol = graph.sub(both, d(i, j, k));
            let symbol = graph.mul(half, symbol);
            let part = graph.mul(symbol, rate);
            sum = graph.add(sum, part);
        }
        sum
    };
    (0..n).map(|i| (0..n).map(|j| entry(graph, i, j)).collect()).collect()
}

/// Jacobian of a vector function by one kind of symbol: forward and reverse.
fn jacobian(
    base: &Mechanics<'_>,
    quantity: Quantity,
    of: &Function,
    kind: fn(u32) -> Symbol,
) -> Function {
    let symbols: Vec<Symbol> = (0..base.count()).map(|i| kind(number(i))).collect();
    let candidates = jacobian_candidates(&of.graph, &of.results(), &symbols, "jacobian");
    choose(quantity, candidates, Effort::Quick)
}

/// Jacobian of values by symbols: forward, column by column, and reverse, row by row.
pub(crate) fn jacobian_candidates(
    graph: &Graph,
    values: &[Id],
    symbols: &[Symbol],
    name: &'static str,
) -> Vec<Candidate> {
    let mut forward = graph.clone();
    let columns: Vec<Vec<Id>> = symbols
        .iter()
        .map(|&symbol| {
            let mut tangent = Tangent::partial(&forward, symbol);
            values.iter().map(|&v| tangent.of(&mut forward, v)).collect()
        })
        .collect();
    let rows: Vec<Vec<Id>> =
        (0..values.len()).map(|i| columns.iter().map(|c| c[i]).collect()).collect();
    let first = Candidate::new(FORWARD, &forward, vec![matrix(name, &rows)]);
    let mut reverse = graph.clone();
    let one = reverse.one();
    let rows: Vec<Vec<Id>> =
        values.iter().map(|&v| gradient(&mut reverse, &[(v, one)], symbols)).collect();
    let second = Candidate::new(REVERSE, &reverse, vec![matrix(name, &rows)]);
    vec![first, second]
}

fn inverse_dynamics(base: &Mechanics<'_>) -> Function {
    let mut candidates = Vec::new();
    for (method, form) in [(RECURSION, BodyForm::Tensor), (MOMENTS, BodyForm::SecondMoments)] {
        let mut work = base.clone();
        let (rates, accelerations) = (work.rates.clone(), work.accelerations.clone());
        let forces = work.forces(&rates, &accelerations, true, form);
        candidates.push(Candidate::new(method, work.graph(), vec![vector("force", forces)]));
    }
    choose(Quantity::InverseDynamics, candidates, Effort::Quick)
}

/// M, C q̇ and G, each as found, in one graph.
fn motion(mass: &Function, bias: &Function, gravity: &Function) -> Function {
    let mut graph = Graph::new();
    let mut blocks = Vec::new();
    for function in [mass, bias, gravity] {
        blocks.extend(moved(function, &mut graph));
    }
    let candidate = Candidate::new("the three in one schedule", &graph, blocks);
    choose(Quantity::Motion, vec![candidate], Effort::Quick)
}

/// The blocks of a function as values of another graph.
pub(crate) fn moved(function: &Function, graph: &mut Graph) -> Vec<Block> {
    let move_block = |block: &Block| {
        let entries = shapebot_symbolic::transfer(&function.graph, &block.entries, graph);
        Block { entries, ..block.clone() }
    };
    function.blocks.iter().map(move_block).collect()
}

/// M⁻¹ (f − C q̇ − G): bias and gravity in one recursion, then LDLᵀ.
fn forward_dynamics(base: &Mechanics<'_>, mass: &Function) -> Function {
    let n = base.count();
    let mut candidates = Vec::new();
    for (method, form) in [(RECURSION, BodyForm::Tensor), (MOMENTS, BodyForm::SecondMoments)] {
        let mut work = base.clone();
        let (rates, still) = (work.rates.clone(), work.still());
        let forces = work.forces(&rates, &still, true, form);
        let graph = work.graph();
        let mut own = Graph::new();
        let forces = shapebot_symbolic::transfer(graph, &forces, &mut own);
        let entries = shapebot_symbolic::transfer(&mass.graph, &mass.results(), &mut own);
        let rhs: Vec<Id> = (0..n)
            .map(|i| {
                let given = own.symbol(Symbol::Force(number(i)));
                own.sub(given, forces[i])
            })
            .collect();
        let rows: Vec<Vec<Id>> = entries.chunks(n).map(<[Id]>::to_vec).collect();
        let solution = solve::symmetric(&mut own, &rows, &rhs);
        candidates.push(Candidate::new(method, &own, vec![vector("acceleration", solution)]));
    }
    choose(Quantity::ForwardDynamics, candidates, Effort::Quick)
}

/// −∂D/∂q̇ of the Rayleigh functions.
fn dissipative_force(base: &Mechanics<'_>) -> Function {
    let mut work = base.clone();
    let n = work.count();
    let mut total = work.graph().zero();
    for term in &base.lowering.model.dissipation {
        let value = work.lowering.scalar(term.expr);
        total = work.graph().add(total, value);
    }
    let symbols: Vec<Symbol> = (0..n).map(|i| Symbol::Rate(number(i))).collect();
    let minus = work.graph().integer(-1);
    let forces = gradient(work.graph(), &[(total, minus)], &symbols);
    let candidate = Candidate::new(ENERGY, work.graph(), vec![vector("force", forces)]);
    choose(Quantity::DissipativeForce, vec![candidate], Effort::Quick)
}
