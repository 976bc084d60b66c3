//! The paper's experiments as references for a closed loop.

use shapebot_control::{Controller, Gains};
use shapebot_dynamics::Robot;
use shapebot_dynamics::nalgebra::{SMatrix, SVector, Vector2};
use shapebot_generated::ballbot3d_arms::Ballbot3dArms;
use shapebot_planner::motion::{Bezier, DesiredMotion, Legs, Line, Rest};
use shapebot_planner::{
    Constrained, Refinement, SetMotion, ShapeConstraint, Start, Task, TwoPhases, Weighting,
    Workspace, plan, refine,
};
use shapebot_sim::{RateFilter, Run, Scale, Scenario, Table, Timing, World, simulate};

/// Samples of the plans per second, and how often the control period divides one.
const RATE: f64 = 100.0;
/// Control periods of 2 ms per sample.
const FINER: usize = 5;

/// Bandwidth of the filter that makes rates of counts, over the robot's time.
pub const RATE_BANDWIDTH: f64 = 13.0;

/// How a motion is planned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Algorithm 1: a constant gain.
    Gain,
    /// The refined planner.
    Refined,
}

/// A motion to follow.
#[derive(Clone, Debug)]
pub struct Experiment<const N: usize, const NX: usize, const NS: usize> {
    /// Words for it.
    pub name: &'static str,
    /// The plan, in steps of the control period.
    pub table: Table<N, NX, NS>,
    /// K⁰_qx of the plan's weights; none where they change on the way.
    pub plan_gain: Option<SMatrix<f64, NS, NX>>,
}

/// Plans a motion.
///
/// # Panics
///
/// If there is no plan.
pub fn planned<R, M, C, const N: usize, const NX: usize, const NS: usize>(
    name: &'static str,
    robot: &R,
    task: &Task<'_, M, f64, NS, C>,
    method: Method,
    start: Option<Start<f64, NX, NS>>,
) -> Experiment<N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
    M: DesiredMotion<f64, NX> + ?Sized,
    C: ShapeConstraint<f64, NX, NS>,
{
    let refused = |error| panic!("{name}: {error}");
    match method {
        Method::Gain => {
            let plan = plan(robot, task).unwrap_or_else(refused);
            let samples = (plan.samples() - 1) * FINER + 1;
            let rows = plan.resampled_rows(robot, samples).expect("rows");
            let table = Table::from_rows(robot, rows).expect("a table");
            Experiment { name, table, plan_gain: Some(*plan.initial_gain()) }
        }
        Method::Refined => {
            let mut workspace = Box::new(Workspace::<f64, NX, 256>::new());
            let refinement = Refinement { start, ..Refinement::default() };
            let plan = refine(robot, task, &refinement, &mut workspace);
            let plan = plan.unwrap_or_else(|error| panic!("{name}: {error}"));
            let rows = plan.rows(robot, FINER).expect("rows");
            let table = Table::from_rows(robot, rows).expect("a table");
            Experiment { name, table, plan_gain: Some(*plan.gain()) }
        }
    }
}

/// A line along the first axis, by the unactuated shape, or by the smallest shape that does it.
///
/// # Panics
///
/// If there is no plan.
pub fn straight<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    distance: f64,
    seconds: f64,
    method: Method,
) -> Experiment<N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    let sets = robot.description().shape_sets;
    let shares: Vec<f64> = sets.iter().map(|set| f64::from(u8::from(!set.actuated))).collect();
    let alone = shares.iter().sum::<f64>() == 1.0;
    let mut goal = SVector::zeros();
    goal[0] = distance;
    let line = Line::new(SVector::zeros(), goal, seconds, 9).expect("a line");
    let task = Task::new(&line, samples(seconds)).weighting(match alone {
        true => Weighting::Contributions(&shares),
        false => Weighting::MinimumNorm,
    });
    planned("straight line", robot, &task, method, None)
}

fn samples(seconds: f64) -> usize {
    (seconds * RATE).round() as usize + 1
}

type Arms = Experiment<8, 2, 6>;

fn line(from: [f64; 2], to: [f64; 2], seconds: f64) -> Line<f64, 2> {
    Line::new(from.into(), to.into(), seconds, 9).expect("a line")
}

/// The experiments of Sec. V with the ballbot that has arms.
///
/// # Panics
///
/// If one of them cannot be planned.
#[must_use]
pub fn experiments(robot: &Ballbot3dArms<f64>, method: Method) -> Vec<Arms> {
    let along = |name, goal, seconds, shares: [f64; 3]| {
        let line = line([0.0; 2], goal, seconds);
        let task = Task::new(&line, samples(seconds));
        planned(name, robot, &task.weighting(Weighting::Contributions(&shares)), method, None)
    };
    let body = [0.0, 0.0, 1.0];
    vec![
        along("line, 1.414 m in 4 s", [1.414, 0.0], 4.0, body),
        along("line, 2 m in 5 s", [2.0, 0.0], 5.0, body),
        bezier(robot, method),
        along("arms forward, 2 m in 15.2 s", [2.0, 0.0], 15.2, [0.5, 0.5, 0.0]),
        lateral(robot, method),
        along("body and arms, 2 m in 10.8 s", [2.0, 0.0], 10.8, [0.25, 0.25, 0.5]),
        waving(robot, method),
        horizontal(robot, method),
    ]
}

fn bezier(robot: &Ballbot3dArms<f64>, method: Method) -> Arms {
    let corner = [([0.0, 0.0], 20), ([0.0, 1.0], 4), ([-1.0, 1.0], 20)];
    let points: Vec<Vector2<f64>> =
        corner.iter().flat_map(|&(at, times)| vec![at.into(); times]).collect();
    let curve = Bezier::new(&points, 10.0).expect("a curve");
    let task = Task::new(&curve, samples(10.0));
    let task = task.weighting(Weighting::Contributions(&[0.0, 0.0, 1.0]));
    planned("Bézier curve in 10 s", robot, &task, method, None)
}

/// The right arm accelerates, the left arm brakes.
fn lateral(robot: &Ballbot3dArms<f64>, method: Method) -> Arms {
    let name = "arms sideways, 1 m in 12.3 s";
    let phases = TwoPhases::new(Vector2::zeros(), Vector2::new(0.0, -1.0), 12.3).expect("phases");
    let [first, second] = &phases.halves;
    let right = Task::new(first, 616).weighting(Weighting::Contributions(&[0.0, 1.0, 0.0]));
    let left = Task::new(second, 616).weighting(Weighting::Contributions(&[1.0, 0.0, 0.0]));
    let begin = planned(name, robot, &right, method, None);
    let target = begin.table.moments().last().expect("a moment").target;
    let start = Start {
        position: target.position[0],
        velocity: target.position[1],
        shape: target.shape[0],
        shape_velocity: target.shape[1],
        shape_acceleration: Some(target.shape[2]),
    };
    let end = planned(name, robot, &left, method, Some(start));
    let table = begin.table.then(&end.table).expect("one step");
    Experiment { name, table, plan_gain: None }
}

fn swing(there: [f64; 2], times: usize) -> Vec<Line<f64, 2>> {
    let there = there.map(f64::to_radians);
    [line([0.0; 2], there, 6.0), line(there, [0.0; 2], 6.0)].repeat(times)
}

fn waving(robot: &Ballbot3dArms<f64>, method: Method) -> Arms {
    let (left, right) = (swing([60.0, 0.0], 2), swing([0.0, -70.0], 2));
    let (left, right) = (Legs::new(&left).expect("legs"), Legs::new(&right).expect("legs"));
    let sets = [SetMotion { set: 0, motion: &left }, SetMotion { set: 1, motion: &right }];
    let rest = Rest::new(Vector2::zeros(), 24.0).expect("a rest");
    let task = Task::new(&rest, samples(24.0))
        .weighting(Weighting::Contributions(&[0.0, 0.0, 1.0]))
        .constraint(Constrained::new(robot, &sets).expect("a constraint"));
    planned("arms waving, the ball stays, 24 s", robot, &task, method, None)
}

fn horizontal(robot: &Ballbot3dArms<f64>, method: Method) -> Arms {
    let raised = [0.0, -90.0_f64.to_radians()];
    let raise =
        [line([0.0; 2], raised, 4.0), line(raised, raised, 6.0), line(raised, [0.0; 2], 4.0)];
    let arms = Legs::new(&raise).expect("legs");
    let sets = [SetMotion { set: 0, motion: &arms }, SetMotion { set: 1, motion: &arms }];
    let rest = |x: f64| Rest::new(Vector2::new(x, 0.0), 4.5).expect("a rest");
    let (before, after, between) = (rest(0.0), rest(2.0), line([0.0; 2], [2.0, 0.0], 5.0));
    let legs: [&dyn DesiredMotion<f64, 2>; 3] = [&before, &between, &after];
    let motion = Legs::new(&legs).expect("legs");
    let task = Task::new(&motion, samples(14.0))
        .weighting(Weighting::Contributions(&[0.0, 0.0, 1.0]))
        .constraint(Constrained::new(robot, &sets).expect("a constraint"));
    planned("arms horizontal, 2 m in 5 s", robot, &task, method, None)
}

/// One controller, one plant, one run.
///
/// # Panics
///
/// If the robot cannot be simulated so.
pub fn follow<R, P, const N: usize, const NX: usize, const NS: usize>(
    (model, plant): (&R, &P),
    reference: &Table<N, NX, NS>,
    gains: &Gains<f64, NX, NS>,
    scenario: &Scenario<NX, NS>,
    after: f64,
) -> Run<N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
    P: Robot<f64, N, NX, NS>,
{
    let timing = Timing { period: gains.period, after, ..Timing::default() };
    let world = World { system: plant, map: plant, scenario, timing };
    let mut controller = Controller::new(model, gains).expect("a controller");
    if scenario.sensors.position_step > 0.0 {
        let bandwidth = RATE_BANDWIDTH / Scale::of(model).expect("a scale").time;
        let mut filtered = RateFilter::new(model, controller, gains.period, bandwidth);
        return simulate(&world, reference, &mut filtered).expect("a run");
    }
    simulate(&world, reference, &mut controller).expect("a run")
}
