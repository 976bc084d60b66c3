//! Plans of task files: from a task and a robot to a [`PlannedMotion`] with its rows and files. Sizes
//! are run-time values on this side.
//!
//! ```
//! use shapebot_generated::ballbot_planar::{BallbotPlanar, DESCRIPTION};
//! use shapebot_planner::value::RobotId;
//!
//! let text = shapebot_tasks::text("table2_ballbot_planar").expect("a bundled task");
//! let task = shapebot_tasks::parse("table2.toml", text)?;
//! let robot = BallbotPlanar::<f64>::from_model();
//! let motion = shapebot_planning::plan(&robot, &task, &RobotId::with(&DESCRIPTION, |_| None))?;
//! assert!(motion.output_rmse < 0.01); // metres
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

mod desired;
mod error;
mod files;
mod held;
mod joined;
mod limits;
mod motion;
pub mod number;
mod phase;
mod refusal;
mod shares;

pub use error::{Refusal, suggestion};
pub use motion::{Detail, GainDetail, Phase, PlanFiles, PlannedMotion, RefinedDetail, Row};

use error::Outcome;
use joined::Joined;
use limits::with_duration;
use nalgebra::SVector;
use phase::{Planned, Request, plan_phase};
use refusal::Unplanned;
use shapebot_dynamics::{Robot, ShapeAccelerated};
use shapebot_planner::motion::Stretched;
use shapebot_planner::value::RobotId;
use shapebot_planner::{Start, TwoPhases, actuator_force, generalised_force};
use shapebot_tasks::{MOST_SAMPLES, Method, Motion, Objective, Said, Shares, Task};

/// A robot of given sizes. One instance per pair of sizes serves all robots that have them.
type Shaped<'r, const NX: usize, const NS: usize> = dyn ShapeAccelerated<f64, NX, NS> + 'r;

/// The planner's rows.
type Samples<const NX: usize, const NS: usize> = Vec<shapebot_planner::Row<f64, NX, NS>>;

/// Forces that a row takes: of the actuators, and generalised ones.
type Forces<'f, const N: usize, const NX: usize, const NS: usize> =
    dyn Fn(&shapebot_planner::Row<f64, NX, NS>) -> [SVector<f64, N>; 2] + 'f;

/// Plans a task with a robot; `id` is what the plan's files say about it.
///
/// # Errors
///
/// What is wrong with the task, or why its plan does not work out.
pub fn plan<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    task: &Task,
    id: &RobotId<'_>,
) -> Result<PlannedMotion, Refusal>
where
    R: Robot<f64, N, NX, NS>,
{
    let forces = |row: &_| [actuator_force(robot, row), generalised_force(robot, row)];
    plan_shaped::<N, NX, NS>(robot, &forces, task, id)
}

fn plan_shaped<const N: usize, const NX: usize, const NS: usize>(
    robot: &Shaped<'_, NX, NS>,
    forces: &Forces<'_, N, NX, NS>,
    task: &Task,
    id: &RobotId<'_>,
) -> Outcome<PlannedMotion> {
    check(task)?;
    let description = robot.shape_description();
    let force_limits = limits::force_limits(&task.force_limits, description)?;
    let survey = limits::survey(description, &force_limits, forces);
    let planned = match &task.motion.value {
        Motion::TwoPhases { goal, duration, shares } => {
            let goal = desired::point(goal, description)?;
            let request = Phases { goal, duration: *duration, shares, survey: &survey };
            request.plan(robot, task)?
        }
        _ => desired::with_motion(task, description, |motion| {
            let request = Request {
                motion,
                samples: task.samples.value,
                shares: &task.shares,
                standing: task.standing.value,
                start: None,
                survey: &survey,
            };
            plan_single(robot, task, &request)
                .map(|phase| vec![phase])
                .map_err(|unplanned| unplanned.failure(task, &task.shares.place))
        })?,
    };
    let planned = Joined::of(planned);
    let files = files::files(description, id, &planned.samples, &|row| forces(row)[1])?;
    Ok(planned.motion(robot, task, files))
}

/// Refuses what a method would silently leave out.
fn check(task: &Task) -> Outcome {
    let samples = task.samples.value;
    if samples > MOST_SAMPLES {
        let message = format!("{samples} samples are too many: at most {MOST_SAMPLES}");
        return Err(Refusal::task(message).at(&task.samples.place));
    }
    match task.method {
        Method::Gain if task.standing.value != [0.0; 2] => {
            let message = "standing before and after is for refined plans: a gain plan leans \
                           exactly while its motion accelerates";
            Err(Refusal::task(message).at(&task.standing.place))
        }
        Method::Refined if task.objective.value != Objective::Position => {
            let message = "an objective is for gain plans: a refined plan always makes the squared \
                           error of the output small";
            Err(Refusal::task(message).at(&task.objective.place))
        }
        _ => Ok(()),
    }
}

/// A plan of one phase; if it leaves its limits, with a duration that would do.
fn plan_single<'a, const NX: usize, const NS: usize>(
    robot: &'a Shaped<'a, NX, NS>,
    task: &Task,
    request: &Request<'a, NX, NS>,
) -> Result<Planned<NX, NS>, Unplanned> {
    let planned = plan_phase(robot, task, request);
    // The refined planner looks for the duration itself.
    if task.method == Method::Refined {
        return planned;
    }
    planned.map_err(|refusal| {
        with_duration(refusal, request.motion.duration(), |factor| {
            let motion = Stretched::new(request.motion, factor)?;
            plan_phase(robot, task, &Request { motion: &motion, ..*request }).map(|_| ())
        })
    })
}

/// A motion in two phases.
#[derive(Clone, Copy)]
struct Phases<'a, const NX: usize, const NS: usize> {
    goal: SVector<f64, NX>,
    /// Seconds.
    duration: f64,
    /// Of each half.
    shares: &'a [Said<Shares>; 2],
    survey: &'a limits::Survey<'a, NX, NS>,
}

impl<const NX: usize, const NS: usize> Phases<'_, NX, NS> {
    /// Both halves; if they leave their limits, with a duration of the whole that would do.
    fn plan(&self, robot: &Shaped<'_, NX, NS>, task: &Task) -> Outcome<Vec<Planned<NX, NS>>> {
        self.attempt(robot, task).map_err(|(half, refusal)| {
            let longer = |factor: f64| {
                let longer = Self { duration: self.duration * factor, ..*self };
                longer.attempt(robot, task).map(|_| ()).map_err(|(_, refusal)| refusal)
            };
            let refusal = with_duration(refusal, self.duration, longer);
            refusal.failure(task, &self.shares[half].place)
        })
    }

    /// Plans both halves, the second from where the first ends. A refusal says which half it is about.
    fn attempt(
        &self,
        robot: &Shaped<'_, NX, NS>,
        task: &Task,
    ) -> Result<Vec<Planned<NX, NS>>, (usize, Unplanned)> {
        let phases = TwoPhases::new(SVector::zeros(), self.goal, self.duration)
            .map_err(|error| (0, Unplanned::Planner(error)))?;
        let [before, after] = task.standing.value;
        let standing = [[before, 0.0], [0.0, after]];
        let mut planned: Vec<Planned<NX, NS>> = Vec::new();
        for (half, motion) in phases.halves.iter().enumerate() {
            let request = Request {
                motion,
                samples: task.samples.value / 2 + 1,
                shares: &self.shares[half],
                standing: standing[half],
                start: planned.last().and_then(end_of),
                survey: self.survey,
            };
            let phase = plan_phase(robot, task, &request).map_err(|refusal| (half, refusal))?;
            planned.push(phase);
        }
        Ok(planned)
    }
}

/// The state in which a phase ends.
fn end_of<const NX: usize, const NS: usize>(phase: &Planned<NX, NS>) -> Option<Start<f64, NX, NS>> {
    let last = phase.samples.last()?;
    Some(Start {
        position: last.position,
        velocity: last.velocity,
        shape: last.plan.shape,
        shape_velocity: last.plan.shape_velocity,
        shape_acceleration: Some(last.plan.shape_acceleration),
    })
}
