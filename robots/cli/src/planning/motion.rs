//! A planned motion, in lists.

use shapebot_dynamics::Description;
use shapebot_planner::Termination;
use std::time::Duration;

/// A planned motion, what it was planned with and how well it does.
#[derive(Clone, Debug)]
pub(crate) struct PlannedMotion {
    /// The robot.
    pub(crate) description: Description,
    /// Contribution of each shape set, if the plan was made with contributions.
    pub(crate) weights: Option<Vec<f64>>,
    /// K, n_s rows of n_x.
    pub(crate) gain: Vec<Vec<f64>>,
    /// K⁰.
    pub(crate) initial_gain: Vec<Vec<f64>>,
    /// K times the direction of a straight motion.
    pub(crate) along: Option<Vec<f64>>,
    /// Root of the mean squared error of the output.
    pub(crate) output_rmse: f64,
    /// Largest error of the output.
    pub(crate) output_max_error: f64,
    /// Error of the output at the end.
    pub(crate) output_end_error: f64,
    /// Largest magnitude of each shape coordinate.
    pub(crate) peak_shape: Vec<f64>,
    /// Objective at K.
    pub(crate) cost: f64,
    /// Objective at K⁰.
    pub(crate) initial_cost: f64,
    /// Steps of the optimiser.
    pub(crate) iterations: usize,
    /// Evaluations of Γ.
    pub(crate) evaluations: usize,
    /// Why the optimiser ended.
    pub(crate) termination: Termination,
    /// Time that the planner took.
    pub(crate) elapsed: Duration,
    /// Samples.
    pub(crate) rows: Vec<Row>,
}

/// One sample of a planned motion.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// Seconds.
    pub(crate) time: f64,
    /// x^d, desired output.
    pub(crate) desired: Vec<f64>,
    /// Output that the plan reaches.
    pub(crate) output: Vec<f64>,
    /// q_x, q̇_x, q̈_x.
    pub(crate) position: [Vec<f64>; 3],
    /// q_s, q̇_s, q̈_s.
    pub(crate) shape: [Vec<f64>; 3],
}

impl Row {
    pub(crate) fn of<const NX: usize, const NS: usize>(
        row: &shapebot_planner::Row<f64, NX, NS>,
    ) -> Self {
        let plan = &row.plan;
        let list = |values: &[f64]| values.to_vec();
        Self {
            time: plan.time,
            desired: list(plan.desired.output[0].as_slice()),
            output: list(row.output.as_slice()),
            position: [&row.position, &row.velocity, &row.acceleration].map(|v| list(v.as_slice())),
            shape: [&plan.shape, &plan.shape_velocity, &plan.shape_acceleration]
                .map(|v| list(v.as_slice())),
        }
    }
}

/// Words for why the optimiser ended.
pub(crate) const fn termination(termination: Termination) -> &'static str {
    match termination {
        Termination::SmallCost => "converged: small cost",
        Termination::SmallGradient => "converged: small gradient",
        Termination::SmallStep => "converged: small step",
        Termination::SmallReduction => "converged: small reduction",
        Termination::IterationLimit => "not converged: iteration limit",
        Termination::NoProgress => "not converged: no progress",
        Termination::NonFinite => "not converged: cost not finite",
    }
}
