//! A model's mechanics in one graph: the tree of its rigid bodies and the terms written out.

use super::Parameters;
use super::composite;
use super::energy;
use super::lower::{Lowering, number};
use super::recursion::{self, BodyForm, Motion};
use super::tree::Tree;
use super::vector::{self, Vec3};
use shapebot_model_dsl::model::{EnergyTerm, Gravity, Model};
use shapebot_symbolic::{Graph, Id, Symbol, Tangent, gradient};

/// Rigid bodies and written energy terms, lowered.
#[derive(Clone, Debug)]
pub(crate) struct Mechanics<'m> {
    /// Expressions and their graph.
    pub(crate) lowering: Lowering<'m>,
    /// Rigid bodies.
    pub(crate) tree: Tree,
    /// Acceleration of gravity, world components.
    pub(crate) down: Vec3,
    /// Kinetic energy of the written terms.
    pub(crate) written_kinetic: Id,
    /// Potential energy of the written terms.
    pub(crate) written_potential: Id,
    /// q̇ symbols.
    pub(crate) rates: Vec<Id>,
    /// q̈ symbols.
    pub(crate) accelerations: Vec<Id>,
}

impl<'m> Mechanics<'m> {
    /// Lowers a model.
    pub(crate) fn new(model: &'m Model, mode: Parameters) -> Self {
        let mut lowering = Lowering::new(model, mode);
        let tree = Tree::new(&mut lowering);
        let down = down(&mut lowering, model.gravity.as_ref());
        let n = model.coordinates.len();
        let rates = (0..n).map(|i| lowering.graph.symbol(Symbol::Rate(number(i)))).collect();
        let accelerations =
            (0..n).map(|i| lowering.graph.symbol(Symbol::Acceleration(number(i)))).collect();
        let zero = lowering.graph.zero();
        let mut mechanics = Self {
            lowering,
            tree,
            down,
            written_kinetic: zero,
            written_potential: zero,
            rates,
            accelerations,
        };
        mechanics.write_terms();
        mechanics
    }

    fn write_terms(&mut self) {
        let model = self.lowering.model;
        self.written_kinetic = self.sum(&model.kinetic);
        self.written_potential = self.sum(&model.potential);
        for term in &model.lagrangian {
            let (kinetic, potential) = self.split_lagrangian(term);
            let graph = &mut self.lowering.graph;
            self.written_kinetic = graph.add(self.written_kinetic, kinetic);
            self.written_potential = graph.add(self.written_potential, potential);
        }
    }

    fn sum(&mut self, terms: &[EnergyTerm]) -> Id {
        let mut sum = self.lowering.graph.zero();
        for term in terms {
            let value = self.lowering.scalar(term.expr);
            sum = self.lowering.graph.add(sum, value);
        }
        sum
    }

    /// T and V of a bare Lagrangian: V = −L at rest, T = L + V.
    pub(crate) fn split_lagrangian(&mut self, term: &EnergyTerm) -> (Id, Id) {
        let value = self.lowering.scalar(term.expr);
        let graph = &mut self.lowering.graph;
        let at_rest = self.rates.iter().map(|&rate| (rate, graph.zero())).collect();
        let rest = shapebot_symbolic::substitute(graph, &[value], &at_rest)[0];
        let potential = graph.neg(rest);
        (graph.sub(value, rest), potential)
    }

    /// Number of coordinates.
    pub(crate) fn count(&self) -> usize {
        self.rates.len()
    }

    /// The graph.
    pub(crate) fn graph(&mut self) -> &mut Graph {
        &mut self.lowering.graph
    }

    /// Kinetic energy.
    pub(crate) fn kinetic(&mut self) -> Id {
        let rates = self.rates.clone();
        let bodies = energy::kinetic(&mut self.lowering, &self.tree, &rates);
        self.lowering.graph.add(bodies, self.written_kinetic)
    }

    /// Potential energy.
    pub(crate) fn potential(&mut self) -> Id {
        let bodies = energy::potential(&mut self.lowering, &self.tree, self.down);
        self.lowering.graph.add(bodies, self.written_potential)
    }

    /// M by composite bodies; `None` where the tree does not allow it.
    pub(crate) fn mass_by_composites(&mut self) -> Option<Vec<Vec<Id>>> {
        let n = self.count();
        let bodies = composite::mass_matrix(&mut self.lowering.graph, &self.tree, n)?;
        let written = self.hessian(self.written_kinetic);
        let graph = &mut self.lowering.graph;
        let entry = |graph: &mut Graph, i: usize, j: usize| graph.add(bodies[i][j], written[i][j]);
        Some((0..n).map(|i| (0..n).map(|j| entry(graph, i, j)).collect()).collect())
    }

    /// M = ∂²T/∂q̇².
    pub(crate) fn mass_from_energy(&mut self) -> Vec<Vec<Id>> {
        let kinetic = self.kinetic();
        self.hessian(kinetic)
    }

    /// ∂²(value)/∂q̇².
    pub(crate) fn hessian(&mut self, value: Id) -> Vec<Vec<Id>> {
        let n = self.count();
        let zero = self.lowering.graph.zero();
        let mut out = vec![vec![zero; n]; n];
        for i in 0..n {
            let row = self.lowering.partial(value, Symbol::Rate(number(i)));
            for j in i..n {
                let entry = self.lowering.partial(row, Symbol::Rate(number(j)));
                out[i][j] = entry;
                out[j][i] = entry;
            }
        }
        out
    }

    /// M q̈ + C q̇ + G of the rigid bodies by recursion and of the written terms by Euler–Lagrange,
    /// for given rates and accelerations, with or without gravity and the written potential.
    pub(crate) fn forces(
        &mut self,
        rates: &[Id],
        accelerations: &[Id],
        gravity: bool,
        form: BodyForm,
    ) -> Vec<Id> {
        let none = vector::zero(&self.lowering.graph);
        let motion = Motion {
            rates: rates.to_vec(),
            accelerations: accelerations.to_vec(),
            gravity: if gravity { self.down } else { none },
        };
        let bodies = recursion::inverse_dynamics(&mut self.lowering, &self.tree, &motion, form);
        let written = self.euler_lagrange(self.written_kinetic, rates, accelerations);
        let slopes = if gravity { self.gradient_q(self.written_potential) } else { Vec::new() };
        let graph = &mut self.lowering.graph;
        let mut out = bodies;
        for (i, force) in out.iter_mut().enumerate() {
            *force = graph.add(*force, written[i]);
            if let Some(&slope) = slopes.get(i) {
                *force = graph.add(*force, slope);
            }
        }
        out
    }

    /// C q̇ by recursion.
    pub(crate) fn bias_by_recursion(&mut self, form: BodyForm) -> Vec<Id> {
        let (rates, still) = (self.rates.clone(), self.still());
        self.forces(&rates, &still, false, form)
    }

    /// G by recursion at rest.
    pub(crate) fn gravity_by_recursion(&mut self) -> Vec<Id> {
        let still = self.still();
        self.forces(&still, &still, true, BodyForm::Tensor)
    }

    /// G = ∂V/∂q.
    pub(crate) fn gravity_from_energy(&mut self) -> Vec<Id> {
        let potential = self.potential();
        self.gradient_q(potential)
    }

    /// Zero for each coordinate.
    pub(crate) fn still(&self) -> Vec<Id> {
        vec![self.lowering.graph.zero(); self.count()]
    }

    fn gradient_q(&mut self, value: Id) -> Vec<Id> {
        let symbols: Vec<Symbol> =
            (0..self.count()).map(|i| Symbol::Coordinate(number(i))).collect();
        let one = self.lowering.graph.one();
        gradient(&mut self.lowering.graph, &[(value, one)], &symbols)
    }

    /// d/dt ∂T/∂q̇ − ∂T/∂q at given rates and accelerations.
    pub(crate) fn euler_lagrange(
        &mut self,
        kinetic: Id,
        rates: &[Id],
        accelerations: &[Id],
    ) -> Vec<Id> {
        let n = self.count();
        let graph = &mut self.lowering.graph;
        if graph.is_zero(kinetic) {
            return vec![graph.zero(); n];
        }
        let symbols: Vec<Symbol> = (0..n).map(|i| Symbol::Rate(number(i))).collect();
        let one = graph.one();
        let momenta = gradient(graph, &[(kinetic, one)], &symbols);
        let mut seeds = Vec::new();
        for i in 0..n {
            seeds.push((Symbol::Coordinate(number(i)), self.rates[i]));
            seeds.push((Symbol::Rate(number(i)), self.accelerations[i]));
        }
        let mut time = Tangent::new(seeds);
        let changes: Vec<Id> = momenta.iter().map(|&p| time.of(graph, p)).collect();
        let slopes = self.gradient_q(kinetic);
        let graph = &mut self.lowering.graph;
        let forces: Vec<Id> = changes.iter().zip(&slopes).map(|(&a, &b)| graph.sub(a, b)).collect();
        let given =
            self.rates.iter().zip(rates).chain(self.accelerations.iter().zip(accelerations));
        let replacement = given.filter(|(a, b)| a != b).map(|(&a, &b)| (a, b)).collect();
        shapebot_symbolic::substitute(graph, &forces, &replacement)
    }
}

fn down(lowering: &mut Lowering<'_>, gravity: Option<&Gravity>) -> Vec3 {
    let mut v = vector::zero(&lowering.graph);
    if let Some(gravity) = gravity {
        let g = lowering.scalar(gravity.acceleration);
        v[vector::index(gravity.axis)] = if gravity.sign < 0 { lowering.graph.neg(g) } else { g };
    }
    v
}
