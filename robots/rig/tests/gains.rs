//! Gains at the bounds of what an operator may set, through frames: the robot stays up and on its plan.

mod common;

use rayon::prelude::*;
use shapebot_control::Gains;
use shapebot_drive::operator::Commanded as _;
use shapebot_dynamics::Robot;
use shapebot_dynamics::control::ControlDesign;
use shapebot_generated::{ballbot_planar, ballbot3d, ballbot3d_arms};
use shapebot_planner::value::PlanView;
use shapebot_rig::{Script, network, run};
use shapebot_runtime::{Runtime, Settings, TUNABLE};
use shapebot_sim::{Plant, Push, Scenario};

/// A line of a metre with all gains at factors, and a push meanwhile; RMSE against the plan, m.
fn pushed<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    design: &ControlDesign,
    drive: &str,
    goal: &str,
    factors: [f32; TUNABLE.len()],
) -> f64
where
    R: Robot<f64, N, NX, NS>,
{
    let motion = common::motion(robot, &common::line(robot.description().name, goal, "4"));
    let description = common::drive(drive, robot.description());
    let tables = description.tables();
    let table = tables.table();
    let plan = PlanView::<f64, NX, NS, N>::open_any(&motion.files.binary).expect("a plan");
    let at = robot.description().points.len() - 1;
    let force = [15.0, 0.0, 0.0].into();
    let push = Push { point: at, force, start: 6.5, duration: 0.2 };
    let scenario = Scenario { pushes: vec![push], ..Scenario::default() };
    let plant = Plant::new(robot, robot, &scenario, 0.0005).expect("a plant");
    let mut world = network(&description, robot, &plant, 1).expect("a world");
    let mut gains = Gains::from_design(robot, design).expect("gains");
    gains.period = f64::from(table.timing.period_us) * 1e-6;
    let mut runtime = Runtime::new(robot, &table, &gains, &Settings::default()).expect("a runtime");
    runtime.load(plan).expect("a plan");
    for (index, factor) in (0..).zip(factors) {
        assert!(runtime.set_gain(index, factor));
    }
    let script = Script { after: 4_000_000, ..Script::default() };
    let outcome = run(&mut runtime, (robot, &plan), &mut world, &script, &mut |_| ());
    let outcome = outcome.unwrap_or_else(|error| panic!("{drive}, {factors:?}: {error}"));
    assert!(outcome.end_error < 0.01, "{drive}, {factors:?}: {} m at the end", outcome.end_error);
    outcome.plan_rmse
}

/// Every gain at either bound.
fn corner(number: usize) -> [f32; TUNABLE.len()] {
    std::array::from_fn(|i| if number >> i & 1 == 0 { TUNABLE[i].low } else { TUNABLE[i].high })
}

fn at_all_corners<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    design: &ControlDesign,
    drive: &str,
    goal: &str,
) where
    R: Robot<f64, N, NX, NS> + Sync,
{
    let designed = pushed(robot, design, drive, goal, [1.0; TUNABLE.len()]);
    let corners: Vec<usize> = (0..1 << TUNABLE.len()).collect();
    let errors: Vec<f64> = corners
        .par_iter()
        .map(|&number| {
            let error = pushed(robot, design, drive, goal, corner(number));
            common::say(&format!("{drive}, {:?}: {error:.5} m", corner(number)));
            error
        })
        .collect();
    let most = errors.iter().copied().fold(0.0, f64::max);
    let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
    common::say(&format!("{drive}: {least:.5} to {most:.5} m, designed {designed:.5} m"));
    assert!(most < 1.5 * designed, "{drive}: {most} m, designed {designed} m");
    // They do something.
    assert!(most > 1.05 * designed && least < 0.95 * designed);
}

#[test]
fn planar_ballbot_at_all_corners() {
    let robot = ballbot_planar::BallbotPlanar::from_model();
    at_all_corners(&robot, &ballbot_planar::CONTROL, "ballbot_planar", "1");
}

#[test]
fn ballbot_at_all_corners() {
    let robot = ballbot3d::Ballbot3d::from_model();
    at_all_corners(&robot, &ballbot3d::CONTROL, "ballbot3d", "1, 0");
}

#[test]
fn ballbot_with_arms_at_all_corners() {
    let robot = ballbot3d_arms::Ballbot3dArms::from_model();
    at_all_corners(&robot, &ballbot3d_arms::CONTROL, "ballbot3d_arms", "1, 0");
}
