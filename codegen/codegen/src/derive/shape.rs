//! Functions of a shape-accelerated system: Γ, Γ′, K⁰ and their Jacobians.
//!
//! The unactuated equations read M_u,x q̈_x + r(q_s, q̇_s, q̈_s) = 0 with r the generalised forces of
//! those rows at q̈_x = 0. Γ solves them for q̈_x (Eq. 9); with the shape at rest they give Γ′ (Eq. 15).

use super::lagrangian::jacobian_candidates;
use super::lower::number;
use super::mechanics::Mechanics;
use super::quantity::{Function, Quantity};
use super::recursion::BodyForm;
use super::select::{Candidate, Effort, choose, matrix, vector};
use super::solve;
use shapebot_symbolic::{Graph, Id, Symbol, evaluate, gradient, substitute, transfer};
use std::collections::HashMap;

/// The unactuated rows in one graph, free of q_x, q̇_x and q̈_x.
struct Rows {
    graph: Graph,
    /// M_u,x, n_x × n_x.
    coupling: Vec<Vec<Id>>,
    /// r(q_s, q̇_s, q̈_s).
    rest: Vec<Id>,
    /// Values of M_u,x at the origin, for the order of elimination.
    pivots: Vec<Vec<f64>>,
}

/// How the rows are found.
#[derive(Clone, Copy)]
enum Load {
    /// Shape in motion.
    Moving(BodyForm),
    /// Shape at rest, by statics over the tree.
    Still,
    /// Shape at rest, by the slope of the potential.
    StillFromEnergy,
}

const MOVING: [(&str, Load); 2] = [
    ("recursion over the tree", Load::Moving(BodyForm::Tensor)),
    ("recursion over the tree, second moments", Load::Moving(BodyForm::SecondMoments)),
];
const STILL: [(&str, Load); 2] =
    [("statics over the tree", Load::Still), ("derivatives of the energy", Load::StillFromEnergy)];

/// All functions of the shape-accelerated system. `unactuated` are the rows without an actuator.
pub(crate) fn functions(base: &Mechanics<'_>, unactuated: &[usize]) -> Vec<Function> {
    let system = System { base, unactuated, nx: unactuated.len() };
    vec![
        system.gamma(),
        system.response(),
        system.gamma_prime(),
        system.gamma_prime_jacobian(),
        system.shape_gain(),
    ]
}

struct System<'a, 'm> {
    base: &'a Mechanics<'m>,
    unactuated: &'a [usize],
    nx: usize,
}

impl System<'_, '_> {
    fn rows(&self, load: Load) -> Rows {
        let mut work = self.base.clone();
        let zero = work.graph().zero();
        let mask = |symbols: &[Id]| -> Vec<Id> {
            symbols.iter().enumerate().map(|(i, &s)| if i < self.nx { zero } else { s }).collect()
        };
        let forces = match load {
            Load::Moving(form) => {
                let (rates, accelerations) = (mask(&work.rates), mask(&work.accelerations));
                work.forces(&rates, &accelerations, true, form)
            }
            Load::Still => work.gravity_by_recursion(),
            Load::StillFromEnergy => work.gravity_from_energy(),
        };
        let rest: Vec<Id> = self.unactuated.iter().map(|&i| forces[i]).collect();
        let mut graph = Graph::new();
        let rest = transfer(work.graph(), &rest, &mut graph);
        // Not the optimised M: its shared terms serve all of its entries, and only some are needed.
        let mass = match work.mass_by_composites() {
            Some(mass) => mass,
            None => work.mass_from_energy(),
        };
        let wanted: Vec<Id> =
            self.unactuated.iter().flat_map(|&i| mass[i][..self.nx].to_vec()).collect();
        let coupling = transfer(work.graph(), &wanted, &mut graph);
        self.without_position(graph, &coupling, &rest)
    }

    /// Sets q_x to zero: the rows do not depend on it.
    fn without_position(&self, mut graph: Graph, coupling: &[Id], rest: &[Id]) -> Rows {
        let zero = graph.zero();
        let replacement: HashMap<Id, Id> =
            (0..self.nx).map(|i| (graph.symbol(Symbol::Coordinate(number(i))), zero)).collect();
        let coupling = substitute(&mut graph, coupling, &replacement);
        let rest = substitute(&mut graph, rest, &replacement);
        let values =
            self.base.lowering.model.parameters.iter().map(|p| p.value_f64).collect::<Vec<_>>();
        let at_origin = |symbol: Symbol| match symbol {
            Symbol::Parameter(i) => values.get(i as usize).copied().unwrap_or(f64::NAN),
            _ => 0.0,
        };
        let numbers = evaluate(&graph, &coupling, &at_origin);
        Rows {
            graph,
            coupling: coupling.chunks(self.nx).map(<[Id]>::to_vec).collect(),
            rest,
            pivots: numbers.chunks(self.nx).map(<[f64]>::to_vec).collect(),
        }
    }

    /// −M_u,x⁻¹ r.
    fn solution(rows: &mut Rows) -> Vec<Id> {
        let rhs: Vec<Id> = rows.rest.iter().map(|&r| rows.graph.neg(r)).collect();
        solve::general(&mut rows.graph, &rows.coupling, &[rhs], &rows.pivots).concat()
    }

    fn map(
        &self,
        quantity: Quantity,
        name: &'static str,
        loads: &[(&'static str, Load)],
    ) -> Function {
        let candidate = |&(method, load): &(&'static str, Load)| {
            let mut rows = self.rows(load);
            let solution = Self::solution(&mut rows);
            Candidate::new(method, &rows.graph, vec![vector(name, solution)])
        };
        choose(quantity, loads.iter().map(candidate).collect(), Effort::Thorough)
    }

    fn gamma(&self) -> Function {
        self.map(Quantity::Gamma, "gamma", &MOVING)
    }

    fn gamma_prime(&self) -> Function {
        self.map(Quantity::GammaPrime, "gamma_prime", &STILL)
    }

    /// Γ and its Jacobians by the implicit rule ∂Γ = −M_u,x⁻¹ (∂r + ∂M_u,x Γ).
    fn response(&self) -> Function {
        let n = self.base.count();
        let kinds = [Symbol::Coordinate, Symbol::Rate, Symbol::Acceleration];
        let symbols: Vec<Symbol> =
            kinds.iter().flat_map(|kind| (self.nx..n).map(move |i| kind(number(i)))).collect();
        let names = ["d_qs", "d_qsd", "d_qsdd"];
        let mut candidates = Vec::new();
        for (method, load) in MOVING {
            let mut rows = self.rows(load);
            let gamma = Self::solution(&mut rows);
            let slopes = implicit(&mut rows, &gamma, &symbols);
            let mut blocks = vec![vector("gamma", gamma)];
            for (k, name) in names.into_iter().enumerate() {
                let part = |row: &Vec<Id>| row[k * (n - self.nx)..(k + 1) * (n - self.nx)].to_vec();
                blocks.push(matrix(name, &slopes.iter().map(part).collect::<Vec<_>>()));
            }
            candidates.push(Candidate::new(method, &rows.graph, blocks));
        }
        choose(Quantity::Response, candidates, Effort::Quick)
    }

    fn gamma_prime_jacobian(&self) -> Function {
        let symbols = self.shape_symbols();
        let mut candidates = Vec::new();
        for (method, load) in STILL {
            let mut rows = self.rows(load);
            let gamma = Self::solution(&mut rows);
            let slopes = implicit(&mut rows, &gamma, &symbols);
            candidates.push(Candidate::new(method, &rows.graph, vec![matrix("jacobian", &slopes)]));
        }
        choose(Quantity::GammaPrimeJacobian, candidates, Effort::Quick)
    }

    fn shape_symbols(&self) -> Vec<Symbol> {
        (self.nx..self.base.count()).map(|i| Symbol::Coordinate(number(i))).collect()
    }

    /// K⁰ = −M_u,x(0)⁻¹ ∂G_u/∂q_s(0), Eq. 16, the origin being an equilibrium.
    fn shape_gain(&self) -> Function {
        let mut rows = self.rows(Load::StillFromEnergy);
        let symbols = self.shape_symbols();
        let slopes = jacobian_candidates(&rows.graph, &rows.rest, &symbols, "gain").swap_remove(0);
        let mut graph = slopes.graph;
        let coupling = transfer(&rows.graph, &rows.coupling.concat(), &mut graph);
        let zero = graph.zero();
        let origin: HashMap<Id, Id> = symbols.iter().map(|&s| (graph.symbol(s), zero)).collect();
        let coupling = substitute(&mut graph, &coupling, &origin);
        let slopes = substitute(&mut graph, &slopes.blocks[0].entries, &origin);
        let ns = symbols.len();
        let columns: Vec<Vec<Id>> = (0..ns)
            .map(|j| (0..self.nx).map(|i| graph.neg(slopes[i * ns + j])).collect())
            .collect();
        rows.coupling = coupling.chunks(self.nx).map(<[Id]>::to_vec).collect();
        let gain = solve::general(&mut graph, &rows.coupling, &columns, &rows.pivots);
        let by_rows: Vec<Vec<Id>> =
            (0..self.nx).map(|i| gain.iter().map(|column| column[i]).collect()).collect();
        let candidate =
            Candidate::new("linearisation", &graph, vec![matrix("shape_gain", &by_rows)]);
        choose(Quantity::ShapeGain, vec![candidate], Effort::Thorough)
    }
}

/// Jacobian of Γ by the implicit rule, rows of Γ by symbols. The adjoint weights λᵢ = −(M_u,x⁻¹)ᵢ go
/// into one reverse sweep per row of r + M_u,x γ with γ held at Γ.
fn implicit(rows: &mut Rows, gamma: &[Id], symbols: &[Symbol]) -> Vec<Vec<Id>> {
    let nx = gamma.len();
    let graph = &mut rows.graph;
    let held: Vec<Id> = (0..nx).map(|i| graph.symbol(Symbol::Auxiliary(number(i)))).collect();
    let residuals: Vec<Id> = (0..nx)
        .map(|i| {
            let coupled = super::vector::dot(graph, &rows.coupling[i], &held);
            graph.add(rows.rest[i], coupled)
        })
        .collect();
    let replacement: HashMap<Id, Id> = held.into_iter().zip(gamma.iter().copied()).collect();
    let one = graph.one();
    let mut slopes = Vec::new();
    for &residual in &residuals {
        let row = gradient(graph, &[(residual, one)], symbols);
        slopes.push(substitute(graph, &row, &replacement));
    }
    let columns: Vec<Vec<Id>> =
        (0..symbols.len()).map(|j| slopes.iter().map(|row| graph.neg(row[j])).collect()).collect();
    let solved = solve::general(graph, &rows.coupling, &columns, &rows.pivots);
    (0..nx).map(|i| solved.iter().map(|column| column[i]).collect()).collect()
}
