//! A planned motion, in lists.

use shapebot_dynamics::Description;
use shapebot_planner::Termination;
use shapebot_tasks::Method;
use std::time::Duration;

/// A planned motion, what it was planned with and how well it does.
#[derive(Clone, Debug)]
pub struct PlannedMotion {
    /// The robot.
    pub description: Description,
    /// How it was planned.
    pub method: Method,
    /// Its phases, one after the other: nearly always one.
    pub phases: Vec<Phase>,
    /// Root of the mean squared error of the output, over the whole window.
    pub output_rmse: f64,
    /// The same within the motion's own time, without standing.
    pub motion_rmse: f64,
    /// Below which no plan's error over the same window can be, or why that is not known.
    pub floor: Result<f64, &'static str>,
    /// Largest error of the output.
    pub output_max_error: f64,
    /// Error of the output at the end.
    pub output_end_error: f64,
    /// Largest magnitude of each shape coordinate.
    pub peak_shape: Vec<f64>,
    /// Largest magnitude of each actuator's force.
    pub peak_force: Vec<f64>,
    /// Time that the planner took.
    pub elapsed: Duration,
    /// Samples.
    pub rows: Vec<Row>,
    /// The plan as files.
    pub files: PlanFiles,
}

/// A phase of a plan.
#[derive(Clone, Debug)]
pub struct Phase {
    /// Contribution of each shape set, if the plan was made with contributions.
    pub weights: Option<Vec<f64>>,
    /// K, n_s rows of n_x; K⁰ of a refined plan.
    pub gain: Vec<Vec<f64>>,
    /// What its method knows.
    pub detail: Detail,
}

/// What a method knows about its plan.
#[derive(Clone, Debug)]
pub enum Detail {
    /// The constant gain.
    Gain(GainDetail),
    /// The refined planner.
    Refined(RefinedDetail),
}

/// What Algorithm 1 knows about its plan.
#[derive(Clone, Debug)]
pub struct GainDetail {
    /// K⁰.
    pub initial_gain: Vec<Vec<f64>>,
    /// K times the direction of a straight motion.
    pub along: Option<Vec<f64>>,
    /// Objective at K.
    pub cost: f64,
    /// Objective at K⁰.
    pub initial_cost: f64,
    /// Steps of the optimiser.
    pub iterations: usize,
    /// Evaluations of Γ.
    pub evaluations: usize,
    /// Why the optimiser ended.
    pub termination: Termination,
    /// What is doubtful.
    pub warning: Option<String>,
}

/// What the refined planner knows about its plan.
#[derive(Clone, Debug)]
pub struct RefinedDetail {
    /// τ², n_x rows, s².
    pub time_constant: Vec<Vec<f64>>,
    /// Spans of the spline.
    pub spans: usize,
    /// Sweeps of Γ.
    pub sweeps: usize,
    /// Evaluations of Γ.
    pub evaluations: usize,
    /// Whether the sweeps converged.
    pub converged: bool,
}

/// A plan in the forms of [`shapebot_planner::value`], with the generalised forces that it takes.
#[derive(Clone, Debug, Default)]
pub struct PlanFiles {
    /// CSV.
    pub csv: String,
    /// JSON.
    pub json: String,
    /// Binary.
    pub binary: Vec<u8>,
}

/// One sample of a planned motion.
#[derive(Clone, Debug)]
pub struct Row {
    /// Seconds.
    pub time: f64,
    /// x^d, desired output.
    pub desired: Vec<f64>,
    /// Its velocity.
    pub desired_velocity: Vec<f64>,
    /// Output that the plan reaches.
    pub output: Vec<f64>,
    /// q_x, q̇_x, q̈_x.
    pub position: [Vec<f64>; 3],
    /// q_s, q̇_s, q̈_s.
    pub shape: [Vec<f64>; 3],
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
            desired_velocity: list(plan.desired.output[1].as_slice()),
            output: list(row.output.as_slice()),
            position: [&row.position, &row.velocity, &row.acceleration].map(|v| list(v.as_slice())),
            shape: [&plan.shape, &plan.shape_velocity, &plan.shape_acceleration]
                .map(|v| list(v.as_slice())),
        }
    }
}

impl PlannedMotion {
    /// Words for how the search ended.
    pub fn termination(&self) -> &'static str {
        let ends = self.phases.iter().map(|phase| phase.detail.termination());
        let mut worst = "converged";
        for end in ends {
            if !worst.starts_with("not") {
                worst = end;
            }
        }
        worst
    }
}

impl Detail {
    /// Words for how the search ended.
    pub const fn termination(&self) -> &'static str {
        match self {
            Self::Gain(gain) => termination(gain.termination),
            Self::Refined(RefinedDetail { converged: true, .. }) => "converged",
            Self::Refined(_) => "not converged: sweep limit",
        }
    }
}

/// Words for why the optimiser ended.
const fn termination(termination: Termination) -> &'static str {
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
