//! The equations as the proof works on them: a copy of the graph with derivatives at hand.

use crate::derive::{EnergySource, Equations};
use shapebot_model_dsl::model::Model;
use shapebot_symbolic::interval::{Interval, Tape};
use shapebot_symbolic::{Graph, Id, Symbol, Tangent, substitute, symbols_of};
use std::collections::{BTreeMap, HashMap};

/// Equations of a model, a graph to work in, and the roles of the rows.
pub(super) struct Problem<'a> {
    pub(super) model: &'a Model,
    pub(super) equations: &'a Equations,
    pub(super) graph: Graph,
    /// Rows that no actuator enters.
    pub(super) unactuated: Vec<usize>,
    by_coordinate: Vec<Tangent>,
    by_rate: Vec<Tangent>,
    /// The sweep d/dt at q̈ = 0, for the bias of one energy source.
    along: Option<Tangent>,
}

impl<'a> Problem<'a> {
    pub(super) fn new(model: &'a Model, equations: &'a Equations) -> Self {
        let graph = equations.graph.clone();
        let all = |kind: fn(u32) -> Symbol| -> Vec<Tangent> {
            (0..equations.len()).map(|i| Tangent::partial(&graph, kind(index(i)))).collect()
        };
        let (by_coordinate, by_rate) = (all(Symbol::Coordinate), all(Symbol::Rate));
        let unactuated = equations.unactuated();
        Self { model, equations, graph, unactuated, by_coordinate, by_rate, along: None }
    }

    /// n.
    pub(super) fn len(&self) -> usize {
        self.equations.len()
    }

    /// n_x.
    pub(super) fn n_x(&self) -> usize {
        self.equations.position_count
    }

    /// Name of a coordinate as the file addresses it.
    pub(super) fn name(&self, i: usize) -> String {
        self.model.coordinates.get(i).map_or_else(|| format!("q_{i}"), |c| c.path.clone())
    }

    /// Names, separated by commas.
    pub(super) fn names(&self, list: impl IntoIterator<Item = usize>) -> String {
        list.into_iter().map(|i| self.name(i)).collect::<Vec<_>>().join(", ")
    }

    /// ∂/∂q_i.
    pub(super) fn by_q(&mut self, i: usize, id: Id) -> Id {
        self.by_coordinate[i].of(&mut self.graph, id)
    }

    /// ∂/∂q̇_i.
    pub(super) fn by_qd(&mut self, i: usize, id: Id) -> Id {
        self.by_rate[i].of(&mut self.graph, id)
    }

    /// Whether a value depends on a symbol, decided exactly.
    pub(super) fn depends(&mut self, id: Id, symbol: Symbol) -> bool {
        if !symbols_of(&self.graph, &[id]).contains(&symbol) {
            return false;
        }
        let slope = match symbol {
            Symbol::Coordinate(i) => self.by_q(i as usize, id),
            Symbol::Rate(i) => self.by_qd(i as usize, id),
            other => Tangent::partial(&self.graph, other).of(&mut self.graph, id),
        };
        !self.graph.is_zero(slope)
    }

    /// Values at q = 0, q̇ = 0, parameters kept as symbols.
    pub(super) fn at_origin(&mut self, ids: &[Id]) -> Vec<Id> {
        let zero = self.graph.zero();
        let mut replacement = HashMap::new();
        for i in 0..self.len() {
            for symbol in [Symbol::Coordinate(index(i)), Symbol::Rate(index(i))] {
                replacement.insert(self.graph.symbol(symbol), zero);
            }
        }
        substitute(&mut self.graph, ids, &replacement)
    }

    /// The matrix, entry by entry at the origin.
    pub(super) fn matrix_at_origin(&mut self, matrix: &[Vec<Id>]) -> Vec<Vec<Id>> {
        matrix.iter().map(|row| self.at_origin(row)).collect()
    }

    /// Rows and columns of the mass matrix.
    pub(super) fn mass(&self, rows: &[usize], columns: &[usize]) -> Vec<Vec<Id>> {
        let entry = |i: &usize| columns.iter().map(|&j| self.equations.mass[*i][j]).collect();
        rows.iter().map(entry).collect()
    }

    /// The model's own value of a symbol; coordinates and rates are zero.
    pub(super) fn value_of(&self, symbol: Symbol) -> f64 {
        match symbol {
            Symbol::Parameter(i) => {
                self.model.parameters.get(i as usize).map_or(0.0, |p| p.value_f64)
            }
            _ => 0.0,
        }
    }

    /// Values in doubles at the model's parameter values; free coordinates are zero.
    pub(super) fn numbers(&self, ids: &[Id]) -> Vec<f64> {
        let tape = Tape::new(&self.graph, ids);
        let inputs: Vec<f64> = tape.inputs().iter().map(|&s| self.value_of(s)).collect();
        tape.at(&inputs)
    }

    /// A matrix in doubles.
    pub(super) fn numeric(&self, matrix: &[Vec<Id>]) -> Vec<Vec<f64>> {
        let flat: Vec<Id> = matrix.iter().flatten().copied().collect();
        let values = self.numbers(&flat);
        let width = matrix.first().map_or(1, Vec::len).max(1);
        values.chunks(width).map(<[f64]>::to_vec).collect()
    }

    /// Whether a value of parameters alone is shown by intervals not to vanish at the model's values.
    pub(super) fn surely_nonzero(&self, id: Id) -> bool {
        let tape = Tape::new(&self.graph, &[id]);
        let around = |&s: &Symbol| match s {
            Symbol::Parameter(_) => Interval::around(self.value_of(s)),
            _ => Interval::ZERO,
        };
        let inputs: Vec<Interval> = tape.inputs().iter().map(around).collect();
        tape.over(&inputs)[0].excludes_zero()
    }

    /// A point by names, coordinates first; parameters only if they vary.
    pub(super) fn named_point(
        &self,
        point: &BTreeMap<Symbol, f64>,
        fixed: bool,
    ) -> Vec<(String, f64)> {
        let coordinates = point.iter().filter_map(|(symbol, &value)| match *symbol {
            Symbol::Coordinate(i) => Some((self.name(i as usize), value)),
            _ => None,
        });
        let parameters = point.iter().filter_map(|(symbol, &value)| match *symbol {
            Symbol::Parameter(i) if !fixed => {
                let p = self.model.parameters.get(i as usize)?;
                p.range.map(|_| (p.path.clone(), value))
            }
            _ => None,
        });
        coordinates.chain(parameters).collect()
    }

    /// M_ij of one energy source.
    pub(super) fn mass_of(&mut self, source: &EnergySource, i: usize, j: usize) -> Id {
        let momentum = self.by_qd(i, source.kinetic);
        self.by_qd(j, momentum)
    }

    /// G_i of one energy source.
    pub(super) fn gravity_of(&mut self, source: &EnergySource, i: usize) -> Id {
        self.by_q(i, source.potential)
    }

    /// (C q̇)_i of one energy source: d/dt ∂T/∂q̇_i at q̈ = 0, less ∂T/∂q_i.
    pub(super) fn bias_of(&mut self, source: &EnergySource, i: usize) -> Id {
        let momentum = self.by_qd(i, source.kinetic);
        let force = self.by_q(i, source.kinetic);
        if self.along.is_none() {
            let graph = &mut self.graph;
            let seeds: Vec<(Symbol, Id)> = (0..self.equations.len())
                .map(|k| (Symbol::Coordinate(index(k)), graph.symbol(Symbol::Rate(index(k)))))
                .collect();
            self.along = Some(Tangent::new(seeds));
        }
        let change = match &mut self.along {
            Some(tangent) => tangent.of(&mut self.graph, momentum),
            None => self.graph.zero(),
        };
        self.graph.sub(change, force)
    }

    /// Energy sources for which a test holds, by position in the list.
    pub(super) fn sources_where(
        &mut self,
        mut test: impl FnMut(&mut Self, &EnergySource) -> bool,
    ) -> Vec<usize> {
        let equations = self.equations;
        (0..equations.sources.len()).filter(|&s| test(self, &equations.sources[s])).collect()
    }
}

/// Index of a symbol.
#[allow(clippy::cast_possible_truncation)]
pub(super) const fn index(i: usize) -> u32 {
    i as u32
}

/// Determinant by minors over subsets of columns.
pub(crate) fn determinant(graph: &mut Graph, matrix: &[Vec<Id>]) -> Id {
    let n = matrix.len();
    // minors[columns] is the determinant of the last |columns| rows in these columns.
    let mut minors = BTreeMap::from([(0_u32, graph.one())]);
    for row in matrix.iter().rev() {
        let mut next = BTreeMap::new();
        for (&columns, &minor) in &minors {
            for (j, &entry) in row.iter().enumerate().take(n) {
                let bit = 1_u32 << j;
                if columns & bit != 0 || graph.is_zero(entry) || graph.is_zero(minor) {
                    continue;
                }
                let mut term = graph.mul(entry, minor);
                if (columns & (bit - 1)).count_ones() % 2 == 1 {
                    term = graph.neg(term);
                }
                let sum = next.get(&(columns | bit)).copied().unwrap_or(graph.zero());
                next.insert(columns | bit, graph.add(sum, term));
            }
        }
        minors = next;
    }
    let all = (1_u32 << n) - 1;
    minors.get(&all).copied().unwrap_or(graph.zero())
}

/// A Aᵀ.
pub(super) fn gram(graph: &mut Graph, matrix: &[Vec<Id>]) -> Vec<Vec<Id>> {
    let dot = |graph: &mut Graph, a: &[Id], b: &[Id]| {
        a.iter().zip(b).fold(graph.zero(), |sum, (&x, &y)| {
            let product = graph.mul(x, y);
            graph.add(sum, product)
        })
    };
    matrix.iter().map(|a| matrix.iter().map(|b| dot(graph, a, b)).collect()).collect()
}
