//! Refined plans of every bundled robot: errors beside their floor, forces, times, files.

use shapebot_dynamics::Robot;
use shapebot_dynamics::nalgebra::SVector;
use shapebot_planner::motion::{Line, Transfer};
use shapebot_planner::value::{PlanView, RobotId, encode, encoded_len};
use shapebot_planner::{
    RefinedPlan, Refinement, Start, Task, Unconstrained, Weighting, Workspace, actuator_force,
    refine, survey_forces,
};
use std::io::Write;
use std::time::{Duration, Instant};

type Refined<'a, const NX: usize, const NS: usize> =
    RefinedPlan<'a, Line<f64, NX>, Unconstrained, f64, NX, NS>;

/// Two metres in five seconds, Table II's task, or half of the way to the edge of a plate.
fn table_2<R, const N: usize, const NX: usize, const NS: usize>(robot: &R) -> Line<f64, NX>
where
    R: Robot<f64, N, NX, NS>,
{
    let upper = robot.description().coordinates[0].upper;
    let mut goal = SVector::zeros();
    goal[0] = (robot.output_jacobian_position()[(0, 0)] * upper * 0.5).min(2.0);
    Line::new(SVector::zeros(), goal, 5.0, 9).expect("a line")
}

/// Everything from the unactuated shape set, or from the last one.
fn contributions<R, const N: usize, const NX: usize, const NS: usize>(robot: &R) -> Vec<f64>
where
    R: Robot<f64, N, NX, NS>,
{
    let sets = robot.description().shape_sets;
    let leaning = sets.iter().position(|set| !set.actuated).unwrap_or(sets.len() - 1);
    (0..sets.len()).map(|set| if set == leaning { 1.0 } else { 0.0 }).collect()
}

/// RMSE inside the motion and over the window, Γ on a ten times finer grid.
fn fine_errors<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    plan: &Refined<'_, NX, NS>,
) -> [f64; 2]
where
    R: Robot<f64, N, NX, NS>,
{
    let (mut sums, mut counts) = ([0.0_f64; 2], [0.0_f64; 2]);
    for row in plan.rows(robot, 10).expect("rows") {
        let square = row.output_error().dot(&row.output_error());
        let inside = (0.0..=5.0).contains(&row.plan.time);
        for (k, counted) in [inside, true].into_iter().enumerate() {
            if counted {
                sums[k] += square;
                counts[k] += 1.0;
            }
        }
    }
    [0, 1].map(|k| (sums[k] / counts[k]).sqrt())
}

fn fastest(runs: usize, mut run: impl FnMut()) -> Duration {
    (0..runs)
        .map(|_| {
            let begin = Instant::now();
            run();
            begin.elapsed()
        })
        .min()
        .expect("a run")
}

fn show<R, const N: usize, const NX: usize, const NS: usize>(name: &str, robot: &R)
where
    R: Robot<f64, N, NX, NS>,
{
    let (line, ratios) = (table_2(robot), contributions(robot));
    let task = Task::new(&line, 501).weighting(Weighting::Contributions(&ratios));
    let gained = shapebot_planner::plan(robot, &task).expect("a gain plan");
    let mut workspace = Workspace::<f64, NX, 64>::new();
    for standing in [0.0, 1.0] {
        let refinement = Refinement::default().standing(standing);
        let time = fastest(100, || {
            refine(robot, &task, &refinement, &mut workspace).expect("a plan");
        });
        let plan = refine(robot, &task, &refinement, &mut workspace).expect("a plan");
        let report = plan.report();
        let [inside, window] = fine_errors(robot, &plan);
        let forces = survey_forces(robot, plan.rows(robot, 1).expect("rows")).expect("forces");
        let _ = writeln!(
            std::io::stderr(),
            "{name}, {standing} s standing: gain {:.5} m, refined {inside:.3e} m in the motion, \
             {window:.3e} m in the window, floor {:?}; end {:.1e} m, {:.1e} m/s; \
             peak shape {:.2} deg; peak force {:.3}; {} sweeps, {time:?}",
            gained.report().output_rmse,
            plan.floor(),
            report.output_end_error,
            report.output_end_velocity_error,
            report.peak_shape.max().to_degrees(),
            forces.peak.max(),
            report.sweeps,
        );
        assert!(report.converged, "{name}: {report:?}");
        assert!(report.output_end_error < 1e-4 && report.output_end_velocity_error < 1e-4);
        assert!(plan.floor().is_none_or(|floor| window > 0.98 * floor), "{name}");
        assert!(forces.residual < 1e-6 * forces.peak.max().max(1.0), "{name}: {forces:?}");
        for time in [plan.start_time(), plan.end_time()] {
            let rest = plan.at(time);
            let rates = [rest.shape, rest.shape_velocity, rest.shape_acceleration];
            assert!(rates.iter().all(|rate| rate.abs().max() < 1e-9), "{name} at {time}");
        }
        if name.starts_with("ballbot") {
            assert!(report.peak_shape.max().to_degrees() <= 4.5, "{name}");
            assert!(forces.peak.max() <= 5.5, "{name}: {forces:?}");
            assert!(inside <= if standing > 0.0 { 5e-4 } else { 0.0095 }, "{name}: {inside}");
        }
    }
}

macro_rules! show_all {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        $(show::<_, $n, $nx, $ns>($name, &shapebot_generated::$module::$robot::<f64>::from_model());)*
    };
}

#[test]
fn every_bundled_robot_is_planned_for() {
    shapebot_generated::for_each_robot!(show_all);
}

/// A replan from 1 m/s and a lean of 5°.
fn replan<R, const N: usize, const NX: usize, const NS: usize>(name: &str, robot: &R)
where
    R: Robot<f64, N, NX, NS>,
{
    let (line, ratios) = (table_2(robot), contributions(robot));
    let goal = shapebot_planner::motion::DesiredMotion::position(&line, 5.0);
    if goal[0] < 2.0 {
        return;
    }
    let task = Task::<_, _, NS>::new(&line, 501).weighting(Weighting::Contributions(&ratios));
    let (gain, jacobian) =
        (task.weighting.gain(robot).expect("a gain"), robot.output_jacobian_position());
    let column = gain.column(0);
    let lean = column * (5.0_f64.to_radians() / column.dot(&column).sqrt());
    let start = Start {
        position: SVector::zeros(),
        velocity: SVector::from_fn(|i, _| if i == 0 { 1.0 / jacobian[(0, 0)] } else { 0.0 }),
        shape: lean,
        shape_velocity: lean * 0.2,
        shape_acceleration: Some(SVector::zeros()),
    };
    let mut workspace = Workspace::<f64, NX, 64>::new();
    let from_rest = fastest(100, || {
        refine(robot, &task, &Refinement::default(), &mut workspace).expect("a plan");
    });
    let refinement = Refinement::default().start(start);
    let mut rest = [SVector::zeros(); 5];
    rest[0] = goal;
    let onward = Transfer::new(&start.output(robot), &rest, 5.0).expect("a motion");
    let task = Task::new(&onward, 501).weighting(Weighting::Contributions(&ratios));
    let moving = fastest(100, || {
        refine(robot, &task, &refinement, &mut workspace).expect("a plan");
    });
    let plan = refine(robot, &task, &refinement, &mut workspace).expect("a plan");
    let report = plan.report();
    let _ = writeln!(
        std::io::stderr(),
        "{name}: from rest {from_rest:?}, from 1 m/s and 5 deg {moving:?}, {} sweeps, RMSE {:.4}",
        report.sweeps,
        report.output_rmse
    );
    assert!(report.converged, "{report:?}");
    let first = plan.at(plan.start_time());
    assert!((first.shape - start.shape).abs().max() < 1e-9, "{name}");
    assert!((first.shape_velocity - start.shape_velocity).abs().max() < 1e-9, "{name}");
    let row = plan.rows(robot, 1).expect("rows").next().expect("a row");
    assert_eq!((row.position, row.velocity), (start.position, start.velocity));
    assert!(report.output_end_error < 1e-4 && report.output_end_velocity_error < 1e-4);
}

macro_rules! replan_all {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        $(replan::<_, $n, $nx, $ns>($name, &shapebot_generated::$module::$robot::<f64>::from_model());)*
    };
}

#[test]
fn every_robot_replans_while_moving() {
    shapebot_generated::for_each_robot!(replan_all);
}

fn store<R, const N: usize, const NX: usize, const NS: usize>(name: &str, robot: &R)
where
    R: Robot<f64, N, NX, NS>,
{
    let (line, ratios) = (table_2(robot), contributions(robot));
    let task = Task::new(&line, 501).weighting(Weighting::Contributions(&ratios));
    let mut workspace = Workspace::<f64, NX, 64>::new();
    let plan = refine(robot, &task, &Refinement::default(), &mut workspace).expect("a plan");
    let rows = || plan.rows(robot, 1).expect("rows");
    let force = |row: &_| actuator_force::<_, _, N, NX, NS>(robot, row);
    let mut bytes = vec![0; encoded_len::<f64, NX, NS, N>(101)];
    let id = RobotId::of(robot.shape_description());
    let used = encode::<f64, _, NX, NS, N>(&id, rows(), 5, force, &mut bytes).expect("bytes");
    assert_eq!(used, bytes.len());
    let view = PlanView::<f64, NX, NS, N>::open(&bytes, &id).expect("a plan");
    let deviation = view.deviation(rows(), force);
    let _ = writeln!(std::io::stderr(), "{name}: {used} bytes, {deviation:?}");
    assert!(deviation.shape < 1e-7 && deviation.position < 1e-6, "{name}: {deviation:?}");
    assert!(deviation.force < 1e-2, "{name}: {deviation:?}");
}

macro_rules! store_all {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        $(store::<_, $n, $nx, $ns>($name, &shapebot_generated::$module::$robot::<f64>::from_model());)*
    };
}

#[test]
fn every_plan_is_a_value() {
    shapebot_generated::for_each_robot!(store_all);
}

/// Time in proportion to the samples from 10² to 10⁵, in memory that does not grow.
#[test]
fn a_plan_evaluates_gamma_once_per_sample_and_a_fixed_number_of_times_before() {
    let robot = shapebot_generated::ballbot3d::Ballbot3d::<f64>::from_model();
    let line = table_2::<_, 4, 2, 2>(&robot);
    let mut workspace = Workspace::<f64, 2, 64>::new();
    let before = [1001, 5625, 10_001, 100_001].map(|samples| {
        let task = Task::new(&line, samples);
        let plan = refine(&robot, &task, &Refinement::default(), &mut workspace).expect("a plan");
        assert_eq!(plan.report().sweeps, 3, "{samples}");
        let evaluations = plan.report().evaluations;
        let _ = writeln!(std::io::stderr(), "{samples} samples: {evaluations} evaluations");
        evaluations - samples
    });
    assert!(before.iter().all(|&fixed| fixed == before[0]), "{before:?}");
    assert!(before[0] < 501, "{before:?}");
}

/// Numbers between −1 and 1 from a linear congruential generator.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Random tasks and starts, sensible or not: a plan or a reason, never a panic.
fn survive<R, const N: usize, const NX: usize, const NS: usize>(name: &str, robot: &R)
where
    R: Robot<f64, N, NX, NS>,
{
    let (mut numbers, mut planned) = (Numbers(7), 0);
    let reach = table_2(robot);
    let reach = shapebot_planner::motion::DesiredMotion::position(&reach, 5.0)[0];
    let mut workspace = Workspace::<f64, NX, 64>::new();
    for round in 0..200 {
        let scale = if round % 4 == 0 { 1e3 } else { reach };
        let goal = SVector::from_fn(|_, _| scale * numbers.next());
        let duration = 4.0 + 3.9 * numbers.next();
        let samples = 60 + (50.0 * numbers.next()) as usize;
        let line = Line::new(SVector::zeros(), goal, duration, 9).expect("a line");
        let mut refinement = Refinement::default().standing((2.0 * numbers.next()).max(0.0));
        if round % 3 == 0 {
            refinement = refinement.start(Start {
                position: SVector::from_fn(|_, _| reach * numbers.next()),
                velocity: SVector::from_fn(|_, _| reach * numbers.next()),
                shape: SVector::from_fn(|_, _| 0.2 * numbers.next()),
                shape_velocity: SVector::from_fn(|_, _| 0.2 * numbers.next()),
                shape_acceleration: None,
            });
        }
        match refine(robot, &Task::new(&line, samples), &refinement, &mut workspace) {
            Ok(plan) => {
                planned += 1;
                assert!(plan.report().output_rmse.is_finite(), "{name} {round}");
                let end = plan.at(plan.end_time());
                assert!(end.shape.abs().max() < 1e-6, "{name} {round}");
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    let _ = writeln!(std::io::stderr(), "{name}: {planned} of 200 random tasks planned");
    assert!(planned > 20, "{name}: {planned}");
}

macro_rules! survive_all {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        $(survive::<_, $n, $nx, $ns>($name, &shapebot_generated::$module::$robot::<f64>::from_model());)*
    };
}

#[test]
fn random_tasks_give_a_plan_or_a_reason() {
    shapebot_generated::for_each_robot!(survive_all);
}
