//! The computations.

use crate::{Digest, FullStep, Inputs, Outcome, Step, full_step, run};
use shapebot_dynamics::nalgebra::SVector;
use shapebot_dynamics::{LagrangianSystem, Motion, Real};
use shapebot_generated::ballbot3d_arms::{Ballbot3dArms, DESCRIPTION};
use shapebot_planner::value::{PlanState, PlanView, RobotId, encode, encoded_len};
use shapebot_planner::{Desired, PlanPoint, Row};

/// Runs all steps, `count` evaluations each, and passes on what comes out.
pub fn all(count: u32, clock: &mut impl FnMut() -> u32, pass: &mut impl FnMut(Outcome)) {
    pass(run(SineCosine::new(), count, &mut *clock));
    pass(run(ArmsMotion::new(), count, &mut *clock));
    let file = plan_file::<6, PLAN_BYTES>(1.0);
    if let Ok(plan) = PlanView::open_any(&file) {
        pass(run(PlanEvaluation::new(plan), count, &mut *clock));
    }
    // A step that does not begin is missing in the report.
    let file = plan_file::<8, ROBOT_PLAN_BYTES>(0.0);
    let (robot, table) = (full_step::Robot::default(), &shapebot_answers::ballbot3d_arms::DRIVE);
    if let Ok(plan) = PlanView::open_any(&file)
        && let Some(step) = FullStep::new(&robot, table, plan)
    {
        pass(run(step, count, &mut *clock));
    }
}

/// Sine and cosine of an angle of up to two turns.
#[derive(Clone, Copy, Debug)]
pub struct SineCosine {
    angle: f32,
    result: (f32, f32),
}

impl SineCosine {
    /// Before the first evaluation.
    #[must_use]
    pub const fn new() -> Self {
        Self { angle: 0.0, result: (0.0, 0.0) }
    }
}

impl Default for SineCosine {
    fn default() -> Self {
        Self::new()
    }
}

impl Step for SineCosine {
    const NAME: &'static str = "sin_cos";

    fn draw(&mut self, inputs: &mut Inputs) {
        self.angle = inputs.between(-12.0, 12.0);
    }

    fn evaluate(&mut self) {
        self.result = Real::sin_cos(self.angle);
    }

    fn digest(&self, digest: &mut Digest) {
        digest.numbers(&[self.result.0, self.result.1]);
    }
}

/// M, C q̇ and G of the ballbot with arms.
#[derive(Clone, Debug)]
pub struct ArmsMotion {
    robot: Ballbot3dArms<f32>,
    q: SVector<f32, 8>,
    qd: SVector<f32, 8>,
    motion: Motion<f32, 8>,
}

impl ArmsMotion {
    /// Before the first evaluation.
    #[must_use]
    pub fn new() -> Self {
        let zero = SVector::zeros();
        let robot = Ballbot3dArms::default();
        Self { motion: robot.motion(&zero, &zero), robot, q: zero, qd: zero }
    }
}

impl Default for ArmsMotion {
    fn default() -> Self {
        Self::new()
    }
}

impl Step for ArmsMotion {
    const NAME: &'static str = "motion";

    fn draw(&mut self, inputs: &mut Inputs) {
        self.q = inputs.within(1.5).into();
        self.qd = inputs.within(3.0).into();
    }

    fn evaluate(&mut self) {
        self.motion = self.robot.motion(&self.q, &self.qd);
    }

    fn digest(&self, digest: &mut Digest) {
        digest.numbers(&self.motion.mass_matrix);
        digest.numbers(&self.motion.coriolis_vector);
        digest.numbers(&self.motion.gravity);
    }
}

/// Coordinates and forces of [`PlanEvaluation`]: those of the ballbot with arms.
type View<'a> = PlanView<'a, f32, 2, 6, 6>;

/// Nodes of the plan.
const NODES: usize = 9;

/// Bytes of the plan.
const PLAN_BYTES: usize = encoded_len::<f32, 2, 6, 6>(NODES);

/// The same with a force for each coordinate, as runtimes have it.
const ROBOT_PLAN_BYTES: usize = encoded_len::<f32, 2, 6, 8>(NODES);

/// A plan of four seconds with arbitrary contents; its first node is `start` times what it would be.
fn plan_file<const F: usize, const BYTES: usize>(start: f32) -> [u8; BYTES] {
    let mut inputs = Inputs::new();
    let mut file = [0; BYTES];
    let rows = (0..NODES).map(|node| {
        let scale = if node == 0 { start } else { 1.0 };
        row(node as f32 * 0.5, scale, &mut inputs)
    });
    let mut forces = Inputs::new();
    let force = |_: &Row<f32, 2, 6>| SVector::<f32, F>::from(forces.within(10.0));
    // Cannot fail: the buffer is as long as it is said to be and all numbers are finite. A plan that
    // is not written would not open, and its line would be missing.
    let robot = RobotId::of(&DESCRIPTION);
    let _ = encode::<f32, f32, 2, 6, F>(&robot, rows, 1, force, &mut file);
    file
}

fn row(time: f32, scale: f32, inputs: &mut Inputs) -> Row<f32, 2, 6> {
    let mut positions = || SVector::from(inputs.within::<2>(1.0)) * scale;
    let position = [positions(), positions(), positions()];
    let mut shapes = || SVector::from(inputs.within::<6>(0.5)) * scale;
    let desired = Desired { output: [position[0]; 5], position: [position[0]; 5] };
    let plan = PlanPoint {
        time,
        desired,
        net_acceleration: position,
        shape: shapes(),
        shape_velocity: shapes(),
        shape_acceleration: shapes(),
    };
    let [output, velocity, acceleration] = position;
    Row { plan, position: output, velocity, acceleration, output }
}

/// A plan's file evaluated in place.
#[derive(Clone, Copy, Debug)]
pub struct PlanEvaluation<'a> {
    plan: View<'a>,
    time: f32,
    state: PlanState<f32, 2, 6, 6>,
}

impl<'a> PlanEvaluation<'a> {
    /// Before the first evaluation.
    #[must_use]
    pub fn new(plan: View<'a>) -> Self {
        Self { plan, time: 0.0, state: plan.at(0.0) }
    }
}

impl Step for PlanEvaluation<'_> {
    const NAME: &'static str = "plan_at";

    fn draw(&mut self, inputs: &mut Inputs) {
        // Also before the plan and after it.
        self.time = inputs.between(-0.5, 4.5);
    }

    fn evaluate(&mut self) {
        self.state = self.plan.at(self.time);
    }

    fn digest(&self, digest: &mut Digest) {
        self.state.position.iter().for_each(|vector| digest.numbers(vector));
        self.state.shape.iter().for_each(|vector| digest.numbers(vector));
        digest.numbers(&self.state.force);
    }
}
