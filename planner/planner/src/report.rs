//! How well a gain plan does.

use crate::linear_algebra::{largest, norm};
use crate::optimise::{Minimum, Termination};
use crate::plan::Row;
use core::fmt;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// How well a plan does, over its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report<T: Ordered, const NS: usize> {
    /// The objective's value at K.
    pub cost: T,
    /// The objective's value at K⁰.
    pub initial_cost: T,
    /// Eq. 33 at K: Σ ‖q̈_x^p − q̈_x^d‖².
    pub acceleration_cost: T,
    /// Root of the mean squared ‖h(q_x^p, q_s^p) − x^d‖, metres.
    pub output_rmse: T,
    /// The largest ‖h(q_x^p, q_s^p) − x^d‖, metres.
    pub output_max_error: T,
    /// ‖h(q_x^p, q_s^p) − x^d‖ at the end, metres.
    pub output_end_error: T,
    /// Root of the mean squared ‖q_x^p − q_x^d‖, in the unit of the position coordinates.
    pub position_rmse: T,
    /// The largest |q_s^p| of each shape coordinate.
    pub peak_shape: SVector<T, NS>,
    /// Steps that the optimiser tried.
    pub iterations: usize,
    /// Evaluations of Γ, with or without its Jacobians.
    pub evaluations: usize,
    /// Why the optimiser ended.
    pub termination: Termination,
    /// ‖Γ′(q_s) − K⁰_qs q_s‖/‖K⁰_qs q_s‖ at the sample of the largest acceleration: how far the plan
    /// leaves the region in which shape and acceleration are proportional.
    pub nonlinearity: T,
}

/// What is doubtful about a plan that is no error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning<T> {
    /// The shape leaves the linear region that a constant gain relies on (Sec. IV-B).
    BeyondLinearRegion {
        /// [`Report::nonlinearity`].
        nonlinearity: T,
    },
}

impl<T: Ordered> fmt::Display for Warning<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BeyondLinearRegion { nonlinearity } => write!(
                f,
                "the planned shape leaves the linear region: its acceleration is {:.1} % off K⁰_qs q_s",
                nonlinearity.to_f64() * 100.0
            ),
        }
    }
}

/// Nonlinearity up to which a plan passes without a warning: a ballbot's at a lean of 10°.
const LINEAR_REGION: f64 = 0.01;

impl<T: Ordered, const NS: usize> Default for Report<T, NS> {
    fn default() -> Self {
        let zero = T::zero();
        Self {
            cost: zero,
            initial_cost: zero,
            acceleration_cost: zero,
            output_rmse: zero,
            output_max_error: zero,
            output_end_error: zero,
            position_rmse: zero,
            peak_shape: SVector::zeros(),
            iterations: 0,
            evaluations: 0,
            termination: Termination::IterationLimit,
            nonlinearity: zero,
        }
    }
}

impl<T: Ordered, const NS: usize> Report<T, NS> {
    /// What the optimiser knows; the rest is added row by row.
    pub(crate) fn new<const P: usize, const NX: usize>(
        minimum: &Minimum<T, P, NX>,
        evaluations: usize,
    ) -> Self {
        Self {
            cost: minimum.cost,
            initial_cost: minimum.start_cost,
            iterations: minimum.iterations,
            evaluations,
            termination: minimum.termination,
            ..Self::default()
        }
    }

    /// What is doubtful about the plan.
    pub fn warning(&self) -> Option<Warning<T>> {
        let nonlinearity = self.nonlinearity;
        (nonlinearity > T::from_f64(LINEAR_REGION))
            .then_some(Warning::BeyondLinearRegion { nonlinearity })
    }

    /// Adds a row; until [`averaged`](Self::averaged) the two RMSE are sums of squares.
    pub(crate) fn add<const NX: usize>(&mut self, row: &Row<T, NX, NS>) {
        let desired = &row.plan.desired.position;
        let (output, position) = (row.output_error(), row.position - desired[0]);
        let acceleration = row.acceleration - desired[2];
        self.output_rmse += output.dot(&output);
        self.position_rmse += position.dot(&position);
        self.acceleration_cost += acceleration.dot(&acceleration);
        self.output_end_error = norm(&output);
        self.output_max_error = largest([self.output_max_error, norm(&output)]);
        self.peak_shape = self.peak_shape.zip_map(&row.plan.shape, |a, b| largest([a, b]));
        self.evaluations = self.evaluations.saturating_add(1);
    }

    pub(crate) fn averaged(self, rows: usize) -> Self {
        let count = T::from_f64(rows as f64);
        Self {
            output_rmse: (self.output_rmse / count).sqrt(),
            position_rmse: (self.position_rmse / count).sqrt(),
            ..self
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        [self.output_rmse, self.position_rmse, self.acceleration_cost].iter().all(|x| x.is_finite())
    }
}
