//! A straight line of 2 m in 5 s through frames, by three robots.

mod common;

use shapebot_control::Gains;
use shapebot_dynamics::Robot;
use shapebot_dynamics::control::ControlDesign;
use shapebot_generated::{ballbot_planar, ballbot3d, ballbot3d_arms};
use shapebot_sim::Scenario;

/// One and a half times the bound of the closed loop without frames, m.
const BOUND: f64 = 0.0015;

fn follow<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    design: &ControlDesign,
    drive: &str,
    goal: &str,
) where
    R: Robot<f64, N, NX, NS>,
{
    let motion = common::motion(robot, &common::line(robot.description().name, goal, "5"));
    let gains = Gains::from_design(robot, design).unwrap();
    let followed = common::follow(robot, &gains, drive, &motion, &Scenario::default());
    common::say(&format!("{drive}: {followed}"));
    followed.assert_within(BOUND);
}

#[test]
fn planar_ballbot_follows_the_line_through_frames() {
    let robot = ballbot_planar::BallbotPlanar::from_model();
    follow(&robot, &ballbot_planar::CONTROL, "ballbot_planar", "2");
}

#[test]
fn ballbot_follows_the_line_through_frames() {
    let robot = ballbot3d::Ballbot3d::from_model();
    follow(&robot, &ballbot3d::CONTROL, "ballbot3d", "2, 0");
}

#[test]
fn ballbot_follows_the_line_through_frames_at_1_khz() {
    let robot = ballbot3d::Ballbot3d::from_model();
    follow(&robot, &ballbot3d::CONTROL, "ballbot3d_1khz", "2, 0");
}

#[test]
fn ballbot_with_arms_follows_the_line_through_frames() {
    let robot = ballbot3d_arms::Ballbot3dArms::from_model();
    follow(&robot, &ballbot3d_arms::CONTROL, "ballbot3d_arms", "2, 0");
}
