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

/// A line of a metre with one gain at a factor, and a push meanwhile; RMSE against the plan, m.
fn pushed<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    design: &ControlDesign,
    drive: &str,
    goal: &str,
    set: Option<(u8, f32)>,
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
    let push = Push { point: at, force, start: 8.0, duration: 0.2 };
    let scenario = Scenario { pushes: vec![push], ..Scenario::default() };
    let plant = Plant::new(robot, robot, &scenario, 0.0005).expect("a plant");
    let mut world = network(&description, robot, &plant, 1).expect("a world");
    let mut gains = Gains::from_design(robot, design).expect("gains");
    gains.period = f64::from(table.timing.period_us) * 1e-6;
    let mut runtime = Runtime::new(robot, &table, &gains, &Settings::default()).expect("a runtime");
    runtime.load(plan).expect("a plan");
    if let Some((index, factor)) = set {
        assert!(runtime.set_gain(index, factor));
    }
    let script = Script::default();
    let outcome = run(&mut runtime, (robot, &plan), &mut world, &script, &mut |_| ());
    let outcome = outcome.unwrap_or_else(|error| panic!("{drive}, {set:?}: {error}"));
    assert!(outcome.end_error < 0.01, "{drive}, {set:?}: {} m at the end", outcome.end_error);
    outcome.plan_rmse
}

fn at_all_bounds<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    design: &ControlDesign,
    drive: &str,
    goal: &str,
) where
    R: Robot<f64, N, NX, NS> + Sync,
{
    let designed = pushed(robot, design, drive, goal, None);
    let bounds =
        (0..).zip(&TUNABLE).flat_map(|(index, gain)| [(index, gain.low), (index, gain.high)]);
    let bounds: Vec<(u8, f32)> = bounds.collect();
    bounds.par_iter().for_each(|&(index, factor)| {
        let error = pushed(robot, design, drive, goal, Some((index, factor)));
        let name = TUNABLE[usize::from(index)].name;
        common::say(&format!("{drive}, {name} x {factor}: {error:.5} m, designed {designed:.5} m"));
        assert!(error < 3.0 * designed, "{drive}, {name} x {factor}: {error} m");
    });
    // They do something.
    assert_ne!(pushed(robot, design, drive, goal, Some((0, TUNABLE[0].high))), designed);
}

#[test]
fn planar_ballbot_at_all_bounds() {
    let robot = ballbot_planar::BallbotPlanar::from_model();
    at_all_bounds(&robot, &ballbot_planar::CONTROL, "ballbot_planar", "1");
}

#[test]
fn ballbot_at_all_bounds() {
    let robot = ballbot3d::Ballbot3d::from_model();
    at_all_bounds(&robot, &ballbot3d::CONTROL, "ballbot3d", "1, 0");
}

#[test]
fn ballbot_with_arms_at_all_bounds() {
    let robot = ballbot3d_arms::Ballbot3dArms::from_model();
    at_all_bounds(&robot, &ballbot3d_arms::CONTROL, "ballbot3d_arms", "1, 0");
}
