//! Time per plan of Table II's task, two metres in five seconds: by a constant gain, refined from
//! rest, and refined anew from a robot that moves.

use divan::Bencher;
use shapebot_dynamics::ShapeAccelerated;
use shapebot_dynamics::nalgebra::SVector;
use shapebot_planner::motion::{Line, Transfer};
use shapebot_planner::{Refinement, Start, Task, Weighting, Workspace, plan, refine};

fn main() {
    divan::main();
}

/// Samples of the plans: the paper's, and the collocation's of `tests/peers/planning`.
const SAMPLES: [usize; 2] = [501, 101];

/// The systems of the table, and the remaining ones that can go two metres.
fn cases() -> Vec<(&'static str, usize)> {
    let robots = ["cartpole_planar", "ballbot_planar", "ballbot3d", "ballbot3d_arms"];
    robots.into_iter().flat_map(|robot| SAMPLES.map(|samples| (robot, samples))).collect()
}

/// How a task is planned.
#[derive(Clone, Copy)]
enum Method {
    Gain,
    FromRest,
    Replan,
}

macro_rules! robots {
    ($({ $name:literal, $module:ident, $robot:ident, $($rest:tt)* })*) => {
        fn time_robot(bencher: Bencher<'_, '_>, (name, samples): (&str, usize), method: Method) {
            match name {
                $($name => {
                    let robot = shapebot_generated::$module::$robot::<f64>::from_model();
                    time(bencher, &robot, samples, method);
                })*
                other => panic!("no robot `{other}`"),
            }
        }
    };
}

shapebot_generated::for_each_robot!(robots);

#[divan::bench(args = cases(), sample_size = 1)]
fn gain(bencher: Bencher<'_, '_>, case: &(&str, usize)) {
    time_robot(bencher, *case, Method::Gain);
}

#[divan::bench(args = cases(), sample_size = 16)]
fn refined_from_rest(bencher: Bencher<'_, '_>, case: &(&str, usize)) {
    time_robot(bencher, *case, Method::FromRest);
}

/// From 1 m/s and a lean of 5°.
#[divan::bench(args = cases(), sample_size = 16)]
fn refined_replan(bencher: Bencher<'_, '_>, case: &(&str, usize)) {
    time_robot(bencher, *case, Method::Replan);
}

/// Along the first axis, leaning with the unactuated shape set alone.
fn time<const NX: usize, const NS: usize>(
    bencher: Bencher<'_, '_>,
    robot: &impl ShapeAccelerated<f64, NX, NS>,
    samples: usize,
    method: Method,
) {
    let mut goal = SVector::<f64, NX>::zeros();
    goal[0] = 2.0;
    let line = Line::new(SVector::zeros(), goal, 5.0, 9).expect("a line");
    let sets = robot.shape_description().shape_sets.iter();
    let ratios: Vec<f64> = sets.map(|set| f64::from(u8::from(!set.actuated))).collect();
    let weighting = Weighting::Contributions(&ratios);
    let task = Task::new(&line, samples).weighting(weighting);
    let mut workspace = Workspace::<f64, NX, 64>::new();
    match method {
        Method::Gain => {
            bencher.bench_local(|| plan(robot, &task).expect("a plan").report().output_rmse);
        }
        Method::FromRest => {
            let refinement = Refinement::default();
            bencher.bench_local(|| {
                refine(robot, &task, &refinement, &mut workspace).expect("a plan").report().sweeps
            });
        }
        Method::Replan => {
            let start = moving(robot, &weighting.gain(robot).expect("a gain"));
            let mut rest = [SVector::zeros(); 5];
            rest[0] = goal;
            let onward = Transfer::new(&start.output(robot), &rest, 5.0).expect("a motion");
            let task = Task::new(&onward, samples).weighting(weighting);
            let refinement = Refinement::default().start(start);
            bencher.bench_local(|| {
                refine(robot, &task, &refinement, &mut workspace).expect("a plan").report().sweeps
            });
        }
    }
}

/// 1 m/s, and a lean of 5° that grows.
fn moving<const NX: usize, const NS: usize>(
    robot: &impl ShapeAccelerated<f64, NX, NS>,
    gain: &shapebot_dynamics::nalgebra::SMatrix<f64, NS, NX>,
) -> Start<f64, NX, NS> {
    let column = gain.column(0);
    let lean = column * (5.0_f64.to_radians() / column.dot(&column).sqrt());
    let mut velocity = SVector::zeros();
    velocity[0] = 1.0 / robot.output_jacobian_position()[(0, 0)];
    Start {
        position: SVector::zeros(),
        velocity,
        shape: lean,
        shape_velocity: lean * 0.2,
        shape_acceleration: Some(SVector::zeros()),
    }
}
