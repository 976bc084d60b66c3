//! One phase of a plan: a motion with its shares, by either method.

use crate::desired::{constraint_lines, set_motions};
use crate::error::{Outcome, Refusal};
use crate::held::Held;
use crate::limits::{Survey, check_shape, shape_limits};
use crate::motion::{Detail, GainDetail, Phase, RefinedDetail};
use crate::refusal::{Unplanned, failure};
use crate::shares::{contributions, default_contributions};
use crate::{Samples, Shaped};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::Description;
use shapebot_planner::motion::{DesiredMotion, Legs};
use shapebot_planner::{
    Constrained, Objective, Plan, Refinement, Start, Weighting, Workspace, choose_shares,
    refine_surveyed,
};
use shapebot_tasks::{Method, Said, Shares, Spare, Task};
use std::time::{Duration, Instant};

/// Control points of a refined plan: four per second for a minute, fewer per second beyond.
const POINTS: usize = 256;

/// Why a refined plan has no floor.
const NO_FLOOR: &str = "not known: τ² of the response ẍ = u − τ²ü has no two real axes";

type Motion<'m, const NX: usize> = dyn DesiredMotion<f64, NX> + 'm;

/// A task at the planner's sizes.
type Problem<'p, const NX: usize, const NS: usize> =
    shapebot_planner::Task<'p, Motion<'p, NX>, f64, NS, Held<'p, NX, NS>>;

/// What a phase is asked to do.
pub(crate) struct Request<'a, const NX: usize, const NS: usize> {
    pub(crate) motion: &'a Motion<'a, NX>,
    pub(crate) samples: usize,
    pub(crate) shares: &'a Said<Shares>,
    pub(crate) standing: [f64; 2],
    /// Where the phase before ended.
    pub(crate) start: Option<Start<f64, NX, NS>>,
    /// Looks at the forces.
    pub(crate) survey: &'a Survey<'a, NX, NS>,
}

/// A phase that is planned.
pub(crate) struct Planned<const NX: usize, const NS: usize> {
    /// With times since the phase's start.
    pub(crate) samples: Samples<NX, NS>,
    pub(crate) phase: Phase,
    pub(crate) floor: Result<f64, &'static str>,
    /// Of each actuator.
    pub(crate) peak_force: Vec<f64>,
    /// What the floor is over: the motion and standing, seconds.
    pub(crate) window: f64,
    pub(crate) elapsed: Duration,
    /// Of the desired motion, seconds.
    pub(crate) duration: f64,
}

/// Plans a phase by the task's method.
pub(crate) fn plan_phase<'a, const NX: usize, const NS: usize>(
    robot: &'a Shaped<'a, NX, NS>,
    task: &Task,
    request: &Request<'a, NX, NS>,
) -> Result<Planned<NX, NS>, Unplanned> {
    let description = robot.shape_description();
    let lines = task.constraints.iter().map(|constraint| constraint_lines(constraint, description));
    let lines = lines.collect::<Outcome<Vec<_>>>()?;
    let legs = task.constraints.iter().zip(&lines).map(|(constraint, lines)| {
        Legs::new(lines).map_err(|error| failure(error).at(&constraint.set.place))
    });
    let legs = legs.collect::<Outcome<Vec<_>>>()?;
    let sets = set_motions(task, description, &legs)?;
    let constrained = match sets.as_slice() {
        [] => None,
        sets => Some(Constrained::new(robot, sets)?),
    };
    let held: Vec<usize> = sets.iter().map(|motion| motion.set).collect();
    let shares = given_shares(&request.shares.value, description, &held)?;
    let problem = shapebot_planner::Task::new(request.motion, request.samples)
        .objective(objective(task))
        .constraint(Held(constrained));
    match task.method {
        Method::Gain => gain_plan(robot, task, &problem, shares, request),
        Method::Refined => refined_plan(robot, task, &problem, shares, request),
    }
}

const fn objective(task: &Task) -> Objective {
    match task.objective.value {
        shapebot_tasks::Objective::Position => Objective::Output,
        shapebot_tasks::Objective::Acceleration => Objective::Acceleration,
        shapebot_tasks::Objective::Coordinates => Objective::Position,
    }
}

/// Contributions, if the task or the robot's make gives them.
fn given_shares(shares: &Shares, robot: &Description, held: &[usize]) -> Outcome<Option<Vec<f64>>> {
    match shares {
        Shares::Given(given) => contributions(given, robot).map(Some),
        Shares::Default => Ok(default_contributions(robot.shape_sets, held)),
        Shares::Automatic(_) => Ok(None),
    }
}

fn weighting<const NS: usize>(shares: Option<&[f64]>) -> Weighting<'_, f64, NS> {
    shares.map_or(Weighting::MinimumNorm, Weighting::Contributions)
}

fn gain_plan<const NX: usize, const NS: usize>(
    robot: &Shaped<'_, NX, NS>,
    task: &Task,
    problem: &Problem<'_, NX, NS>,
    shares: Option<Vec<f64>>,
    request: &Request<'_, NX, NS>,
) -> Result<Planned<NX, NS>, Unplanned> {
    if matches!(request.shares.value, Shares::Automatic(_)) {
        let failure = Refusal::task("automatic shares are those of a refined plan");
        return Err(failure.at(&request.shares.place).into());
    }
    let problem = problem.weighting(weighting(shares.as_deref()));
    let begin = Instant::now();
    let plan = shapebot_planner::plan(robot, &problem)?;
    let elapsed = begin.elapsed();
    let report = *plan.report();
    let mut samples: Samples<NX, NS> = plan.rows(robot).collect();
    if let Some(start) = &request.start {
        carry(robot, &mut samples, start);
    }
    if let Some(limits) = shape_limits(&task.limits, robot.shape_description())? {
        check_shape(&samples, &limits, robot.shape_description())?;
    }
    let peak_force = (request.survey)(&mut samples.iter().copied())?;
    let detail = Detail::Gain(GainDetail {
        initial_gain: rows_of(plan.initial_gain()),
        along: along(&plan),
        cost: report.cost,
        initial_cost: report.initial_cost,
        iterations: report.iterations,
        evaluations: report.evaluations,
        termination: report.termination,
        warning: report.warning().map(|warning| warning.to_string()),
    });
    let gain = rows_of(plan.gain());
    let phase = Phase { gain, detail, weights: shares.clone() };
    let duration = request.motion.duration();
    let floor = Err("the floor is one of refined plans");
    Ok(Planned { samples, phase, floor, peak_force, window: duration, elapsed, duration })
}

/// Begins a gain plan's motion where the phase before ended: Γ does not depend on where the robot is and
/// how fast.
fn carry<const NX: usize, const NS: usize>(
    robot: &Shaped<'_, NX, NS>,
    samples: &mut Samples<NX, NS>,
    start: &Start<f64, NX, NS>,
) {
    let Some(first) = samples.first().copied() else {
        return;
    };
    let (ahead, faster) = (start.position - first.position, start.velocity - first.velocity);
    for row in samples {
        row.position += ahead + faster * (row.plan.time - first.plan.time);
        row.velocity += faster;
        row.output = robot.output(&row.position, &row.plan.shape);
    }
}

fn refined_plan<const NX: usize, const NS: usize>(
    robot: &Shaped<'_, NX, NS>,
    task: &Task,
    problem: &Problem<'_, NX, NS>,
    shares: Option<Vec<f64>>,
    request: &Request<'_, NX, NS>,
) -> Result<Planned<NX, NS>, Unplanned> {
    let [standing_before, standing_after] = request.standing;
    let refinement = Refinement {
        standing_before,
        standing_after,
        start: request.start,
        limits: shape_limits(&task.limits, robot.shape_description())?,
        ..Refinement::default()
    };
    let mut workspace = Box::new(Workspace::<f64, NX, POINTS>::new());
    let begin = Instant::now();
    let shares = match &request.shares.value {
        Shares::Automatic(spare) => {
            let mut shares = vec![0.0; robot.shape_description().shape_sets.len()];
            let spare = match spare {
                Spare::Unactuated => shapebot_planner::Spare::Unactuated,
                Spare::Actuated => shapebot_planner::Spare::Actuated,
            };
            choose_shares(robot, problem, &refinement, spare, &mut shares, &mut workspace)?;
            Some(shares)
        }
        _ => shares,
    };
    let problem = problem.weighting(weighting(shares.as_deref()));
    let (plan, peak_force) =
        refine_surveyed(robot, &problem, &refinement, &mut workspace, request.survey)?;
    let elapsed = begin.elapsed();
    let report = plan.report();
    let detail = Detail::Refined(RefinedDetail {
        time_constant: rows_of(plan.time_constant()),
        spans: report.spans,
        sweeps: report.sweeps,
        evaluations: report.evaluations,
        converged: report.converged,
    });
    Ok(Planned {
        samples: plan.rows(robot, 1)?.collect(),
        phase: Phase { gain: rows_of(plan.gain()), detail, weights: shares.clone() },
        floor: plan.floor().ok_or(NO_FLOOR),
        peak_force,
        window: plan.end_time() - plan.start_time(),
        elapsed,
        duration: request.motion.duration(),
    })
}

/// K times the unit direction of the motion, if it is straight: all that such a task determines.
fn along<const NX: usize, const NS: usize>(
    plan: &Plan<'_, Motion<'_, NX>, f64, NX, NS, Held<'_, NX, NS>>,
) -> Option<Vec<f64>> {
    let duration = plan.motion().duration();
    let accelerations =
        (1..20).map(|i| plan.at(duration * f64::from(i) / 20.0).desired.position[2]);
    let accelerations: Vec<SVector<f64, NX>> = accelerations.collect();
    let longest = accelerations.iter().copied().max_by(|a, b| a.dot(a).total_cmp(&b.dot(b)))?;
    let length = longest.dot(&longest).sqrt();
    if length == 0.0 {
        return None;
    }
    let direction = longest / length;
    let straight = |a: &SVector<f64, NX>| {
        let across = a - direction * direction.dot(a);
        across.dot(&across).sqrt() <= 1e-9 * length
    };
    accelerations.iter().all(straight).then(|| (plan.gain() * direction).iter().copied().collect())
}

fn rows_of<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}
