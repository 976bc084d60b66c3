//! The paper's straight line through frames.

mod common;

use shapebot_control::Gains;
use shapebot_dynamics::Robot;
use shapebot_dynamics::control::ControlDesign;
use shapebot_generated::{ballbot_planar, ballbot3d, ballbot3d_arms};
use shapebot_planner::value::PlanView;
use shapebot_rig::{Outcome, Script, network, run};
use shapebot_runtime::{Runtime, Settings};
use shapebot_sim::{Plant, Scenario};

fn follow<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    design: &ControlDesign,
    drive: &str,
    task: &str,
) -> Outcome
where
    R: Robot<f64, N, NX, NS>,
{
    let description = common::drive(drive, robot.description());
    let tables = description.tables();
    let table = tables.table();
    let file = common::plan(robot, task);
    let plan = PlanView::<f64, NX, NS, N>::open_any(&file).unwrap();
    let scenario = Scenario::default();
    let plant = Plant::new(robot, robot, &scenario, 0.0005).unwrap();
    let mut world = network(&description, robot, &plant, 1).unwrap();
    let mut gains = Gains::from_design(robot, design).unwrap();
    gains.period = f64::from(table.timing.period_us) * 1e-6;
    let mut runtime = Runtime::new(robot, &table, &gains, &Settings::default()).unwrap();
    runtime.load(plan).unwrap();
    let outcome = run(&mut runtime, (robot, &plan), &mut world, &Script::default(), &mut |_| {});
    outcome.unwrap_or_else(|error| panic!("{drive}: {error}"))
}

/// One and a half times the bound of the closed loop without frames: .001 m.
fn check(outcome: &Outcome, drive: &str) {
    assert!(outcome.is_truth);
    assert!(outcome.plan_rmse < 0.0015, "{drive}: {outcome:?}");
    assert_eq!(outcome.counters.malformed + outcome.counters.missed, 0, "{drive}");
    assert_eq!(outcome.counters.limited, 0, "{drive}");
}

#[test]
fn planar_ballbot_follows_the_line_through_frames() {
    let robot = ballbot_planar::BallbotPlanar::from_model();
    let task = common::line("ballbot_planar", "2", "5");
    check(&follow(&robot, &ballbot_planar::CONTROL, "ballbot_planar", &task), "ballbot_planar");
}

#[test]
fn ballbot_follows_the_line_through_frames() {
    let robot = ballbot3d::Ballbot3d::from_model();
    let task = common::line("ballbot3d", "2, 0", "5");
    check(&follow(&robot, &ballbot3d::CONTROL, "ballbot3d", &task), "ballbot3d");
}

#[test]
fn ballbot_with_arms_follows_the_line_through_frames() {
    let robot = ballbot3d_arms::Ballbot3dArms::from_model();
    let task = common::line("ballbot3d_arms", "2, 0", "5");
    check(&follow(&robot, &ballbot3d_arms::CONTROL, "ballbot3d_arms", &task), "ballbot3d_arms");
}
