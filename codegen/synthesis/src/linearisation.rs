//! A robot's dynamics near the origin, for given parameter values.

use crate::linear_algebra::Matrix;
use shapebot_codegen::derive::{Derivation, Quantity};
use shapebot_symbolic::{Symbol, evaluate};

/// M q̈ + D q̇ + K q = f near the origin, with the map from shape to acceleration.
#[derive(Clone, Debug)]
pub(crate) struct Linearisation {
    /// M.
    pub(crate) mass: Matrix,
    /// D, of the declared dissipation.
    pub(crate) damping: Matrix,
    /// K = ∂G/∂q.
    pub(crate) stiffness: Matrix,
    /// K⁰_qs, n_x × n_s.
    pub(crate) shape_gain: Matrix,
    /// N = ∂Γ/∂q̈_s, n_x × n_s.
    pub(crate) response: Matrix,
    /// (∂h/∂q_x)⁻¹ ∂h/∂q_s, n_x × n_s.
    pub(crate) output_shape: Matrix,
}

impl Linearisation {
    /// `None` where a function is missing, not finite or singular.
    pub(crate) fn new(derivation: &Derivation, parameters: &[f64]) -> Option<Self> {
        let n = derivation.model.coordinates.len();
        let n_x = derivation.model.position_count();
        let n_s = n - n_x;
        let at = |quantity, rate| values(derivation, quantity, parameters, rate);
        let matrix = |quantity, rows, columns| {
            at(quantity, None).and_then(|entries| Matrix::from_rows(rows, columns, &entries))
        };
        let mut damping = Matrix::zeros(n, n);
        for j in 0..n {
            let Some(force) = at(Quantity::DissipativeForce, Some(j)) else { continue };
            for (i, force) in force.iter().enumerate() {
                damping[(i, j)] = -force;
            }
        }
        let mass = matrix(Quantity::MassMatrix, n, n)?;
        let stiffness = matrix(Quantity::GravityJacobian, n, n)?;
        // The unactuated rows, solved for q̈_x (Eqs. 9 and 16).
        let rows = derivation.equations.unactuated();
        let (positions, shape): (Vec<usize>, Vec<usize>) = ((0..n_x).collect(), (n_x..n).collect());
        let coupling = mass.pick(&rows, &positions);
        let solved = |m: &Matrix| coupling.solve(&m.pick(&rows, &shape).scaled(-1.0));
        let (shape_gain, response) = (solved(&stiffness)?, solved(&mass)?);
        let position = matrix(Quantity::OutputJacobianPosition, n_x, n_x)?;
        let output = matrix(Quantity::OutputJacobianShape, n_x, n_s)?;
        let output_shape = position.solve(&output)?;
        Some(Self { mass, damping, stiffness, shape_gain, response, output_shape })
    }

    /// n.
    pub(crate) fn len(&self) -> usize {
        self.mass.rows
    }

    /// n_x.
    pub(crate) fn position_count(&self) -> usize {
        self.shape_gain.rows
    }

    /// The same with only some coordinates free to move: n_x positions first, then shape.
    pub(crate) fn restricted(&self, positions: &[usize], shape: &[usize]) -> Self {
        let n_x = self.position_count();
        let all: Vec<usize> =
            positions.iter().copied().chain(shape.iter().map(|j| n_x + j)).collect();
        let square = |m: &Matrix| m.pick(&all, &all);
        let map = |m: &Matrix| m.pick(positions, shape);
        Self {
            mass: square(&self.mass),
            damping: square(&self.damping),
            stiffness: square(&self.stiffness),
            shape_gain: map(&self.shape_gain),
            response: map(&self.response),
            output_shape: map(&self.output_shape),
        }
    }

    /// In other shape coordinates s', s = T s'.
    pub(crate) fn in_shape_coordinates(&self, t: &Matrix) -> Self {
        let n_x = self.position_count();
        let whole = Matrix::from_fn(self.len(), self.len(), |i, j| match (i < n_x, j < n_x) {
            (true, true) => f64::from(u8::from(i == j)),
            (false, false) => t[(i - n_x, j - n_x)],
            _ => 0.0,
        });
        let square = |m: &Matrix| whole.transpose().times(m).times(&whole);
        Self {
            mass: square(&self.mass),
            damping: square(&self.damping),
            stiffness: square(&self.stiffness),
            shape_gain: self.shape_gain.times(t),
            response: self.response.times(t),
            output_shape: self.output_shape.times(t),
        }
    }
}

/// A function at the origin, with one coordinate at unit rate if wanted.
fn values(
    derivation: &Derivation,
    quantity: Quantity,
    parameters: &[f64],
    rate: Option<usize>,
) -> Option<Vec<f64>> {
    let function = derivation.functions.get(&quantity)?;
    let value = |symbol: Symbol| match symbol {
        Symbol::Parameter(i) => parameters.get(i as usize).copied().unwrap_or(f64::NAN),
        Symbol::Rate(i) if Some(i as usize) == rate => 1.0,
        _ => 0.0,
    };
    Some(evaluate(&function.graph, &function.results(), &value))
}
