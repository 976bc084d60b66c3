//! A minimal loop: forward dynamics with the declared dissipation by Runge-Kutta steps, forces held over a period.
#![allow(dead_code, reason = "not every test needs all of it")]

use nalgebra::SVector;
use shapebot_control::{Controller, Gains, State, Target};
use shapebot_dynamics::Robot;
use shapebot_dynamics::control::ControlDesign;
use shapebot_planner::motion::Line;
use shapebot_planner::{Refinement, Task, Weighting, Workspace, refine};

/// Control period, s.
pub(crate) const PERIOD: f64 = 0.002;

/// What differs from the nominal case.
#[derive(Clone, Copy, Debug)]
pub(crate) struct World<const N: usize> {
    /// Viscous and Coulomb friction on the position variables.
    pub(crate) drive: [f64; 2],
    /// Offset of the measured coordinates.
    pub(crate) bias: SVector<f64, N>,
    /// Periods between measurement and force.
    pub(crate) delay: usize,
}

impl<const N: usize> Default for World<N> {
    fn default() -> Self {
        Self { drive: [0.0; 2], bias: SVector::zeros(), delay: 0 }
    }
}

/// How a run went.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Run<const NX: usize> {
    /// Root of the mean squared output error against the plan.
    pub(crate) rmse: f64,
    /// Output error at the end.
    pub(crate) end: f64,
    /// Largest output error over the last fifth.
    pub(crate) tail: f64,
    /// Largest output error.
    pub(crate) largest: f64,
    /// Largest compensation, any shape coordinate.
    pub(crate) compensation: f64,
    /// Largest force of any actuator.
    pub(crate) force: f64,
    /// Largest difference of any shape coordinate from the plan.
    pub(crate) lean: f64,
    /// Steps in which something met a limit.
    pub(crate) limited: usize,
}

pub(crate) type Plan<const N: usize, const NX: usize, const NS: usize> =
    Vec<Target<f64, N, NX, NS>>;

/// Standing at the origin.
pub(crate) fn standing<const N: usize, const NX: usize, const NS: usize>(
    duration: f64,
) -> Plan<N, NX, NS> {
    vec![Target::stand(SVector::zeros()); (duration / PERIOD) as usize]
}

/// A refined plan along the first axis, and standing at its end.
pub(crate) fn travel<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    distance: f64,
    duration: f64,
    after: f64,
) -> Plan<N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    let mut goal = SVector::zeros();
    goal[0] = distance;
    let line = Line::new(SVector::zeros(), goal, duration, 9).expect("a line");
    let sets = robot.description().shape_sets;
    let leaning = sets.iter().position(|set| !set.actuated).unwrap_or(sets.len() - 1);
    let ratios: Vec<f64> = (0..sets.len()).map(|i| if i == leaning { 1.0 } else { 0.0 }).collect();
    let samples = (duration / PERIOD / 5.0) as usize + 1;
    let task = Task::new(&line, samples).weighting(Weighting::Contributions(&ratios));
    let mut workspace = Workspace::<f64, NX, 64>::new();
    let plan = refine(robot, &task, &Refinement::default(), &mut workspace).expect("a plan");
    let target = |row: &shapebot_planner::Row<f64, NX, NS>| {
        Target {
            position: [row.position, row.velocity, row.acceleration],
            shape: [row.plan.shape, row.plan.shape_velocity, row.plan.shape_acceleration],
            force: SVector::zeros(),
        }
        .with_feedforward(robot)
    };
    let mut targets: Plan<N, NX, NS> =
        plan.rows(robot, 5).expect("rows").map(|row| target(&row)).collect();
    let last = *targets.last().expect("targets");
    let end = Target::stand(last.position[0]);
    targets.extend((0..(after / PERIOD) as usize).map(|_| end));
    targets
}

/// One Runge-Kutta step with the force held.
pub(crate) fn advance<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    state: &State<f64, N>,
    force: &SVector<f64, N>,
    drive: [f64; 2],
    step: f64,
) -> State<f64, N>
where
    R: Robot<f64, N, NX, NS>,
{
    let slope = |q: &SVector<f64, N>, qd: &SVector<f64, N>| {
        let friction = SVector::<f64, N>::from_fn(|i, _| {
            let smooth = (qd[i] / 0.02).tanh();
            if i < NX { -drive[0] * qd[i] - drive[1] * smooth } else { 0.0 }
        });
        let drag = robot.dissipative_force(q, qd);
        robot.forward_dynamics(q, qd, &(force + friction + drag))
    };
    let (q, v) = (state.q, state.qd);
    let a1 = slope(&q, &v);
    let v2 = v + a1 * (step / 2.0);
    let a2 = slope(&(q + v * (step / 2.0)), &v2);
    let v3 = v + a2 * (step / 2.0);
    let a3 = slope(&(q + v2 * (step / 2.0)), &v3);
    let v4 = v + a3 * step;
    let a4 = slope(&(q + v3 * step), &v4);
    State {
        q: q + (v + v2 * 2.0 + v3 * 2.0 + v4) * (step / 6.0),
        qd: v + (a1 + a2 * 2.0 + a3 * 2.0 + a4) * (step / 6.0),
    }
}

/// Runs a plan on `plant` with a controller that knows `robot`.
pub(crate) fn run<R, P, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    plant: &P,
    gains: &Gains<f64, NX, NS>,
    plan: &[Target<f64, N, NX, NS>],
    start: State<f64, N>,
    world: &World<N>,
) -> Run<NX>
where
    R: Robot<f64, N, NX, NS>,
    P: Robot<f64, N, NX, NS>,
{
    let mut controller = Controller::new(robot, gains).expect("a controller");
    let mut state = start;
    let mut pending = std::collections::VecDeque::from(vec![SVector::zeros(); world.delay]);
    let mut out = Run::default();
    for (step, target) in plan.iter().enumerate() {
        let (qx, qs) = P::split(&state.q);
        let wanted = plant.output(&target.position[0], &target.shape[0]);
        let error = plant.output(&qx, &qs) - wanted;
        let error = error.dot(&error).sqrt();
        out.rmse += error * error / plan.len() as f64;
        out.end = error;
        out.largest = out.largest.max(error);
        if 5 * step >= 4 * plan.len() {
            out.tail = out.tail.max(error);
        }
        out.lean = out.lean.max((qs - target.shape[0]).abs().max());
        let measured = State { q: state.q + world.bias, qd: state.qd };
        let command = controller.step(&measured, target);
        assert!(!command.fault, "fault");
        out.compensation = out.compensation.max(command.compensation.abs().max());
        out.limited += usize::from(command.saturated);
        out.force = out.force.max(command.actuator.abs().max());
        pending.push_back(command.force);
        let force = pending.pop_front().expect("a force");
        for _ in 0..2 {
            state = advance(plant, &state, &force, world.drive, PERIOD / 2.0);
        }
    }
    out.rmse = out.rmse.sqrt();
    out
}

/// Something that must hold for every bundled robot.
pub(crate) trait Check {
    /// `with` makes the same robot with one parameter set.
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        with: &dyn Fn(&str, f64) -> R,
    ) where
        R: Robot<f64, N, NX, NS>;
}

/// Checks every bundled robot.
pub(crate) fn every<C: Check>() {
    macro_rules! visit {
        ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
            $({
                use shapebot_generated::$module::{$robot, CONTROL, Params};
                let with = |name: &str, value: f64| {
                    let mut params = Params::<f64>::model();
                    assert!(params.set(name, value), "{name}");
                    $robot::try_new(params).expect("parameters in range")
                };
                C::check::<_, $n, $nx, $ns>($name, &$robot::<f64>::from_model(), &CONTROL, &with);
            })*
        };
    }
    shapebot_generated::for_each_robot!(visit);
}

/// Whether the position variables balance the rest.
pub(crate) fn balances<R, const N: usize, const NX: usize, const NS: usize>(robot: &R) -> bool
where
    R: Robot<f64, N, NX, NS>,
{
    robot.description().position_coordinates().iter().all(|c| c.actuated)
}

/// Two metres, or half of the way to the end of the first coordinate's range.
pub(crate) fn reach<R, const N: usize, const NX: usize, const NS: usize>(robot: &R) -> f64
where
    R: Robot<f64, N, NX, NS>,
{
    let upper = robot.description().coordinates[0].upper;
    (0.5 * upper * robot.output_jacobian_position()[(0, 0)]).min(2.0)
}

/// At rest at the origin.
pub(crate) fn rest<const N: usize>() -> State<f64, N> {
    State { q: SVector::zeros(), qd: SVector::zeros() }
}
