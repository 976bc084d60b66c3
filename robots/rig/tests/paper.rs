//! The paper's experiments with the arms (Sec. V) through frames, within one and a half times the bounds
//! of the closed loop without frames.

mod common;

use common::{Followed, follow};
use shapebot_control::{Compensate, Gains};
use shapebot_generated::ballbot3d_arms::{Ballbot3dArms, CONTROL};
use shapebot_sim::{Friction, Scenario};

/// Bounds of the closed loop, m and degrees, and what frames may cost.
const NOMINAL: f64 = 0.001;
const RUBBING: f64 = 0.008;
const BODY: f64 = 0.05;
const ARMS: f64 = 5.0;
const FRAMES: f64 = 1.5;

/// A task through frames, with the paper's drive of the arms.
fn experiment(task: &str, by: Compensate, scenario: &Scenario<2, 6>) -> Followed {
    let robot = Ballbot3dArms::from_model();
    let text = shapebot_tasks::text(task).unwrap();
    let motion = common::motion(&robot, text);
    let mut gains = Gains::from_design(&robot, &CONTROL).unwrap();
    gains.compensate = by;
    gains.plan_gain = common::plan_gain(&motion);
    let followed = follow(&robot, &gains, "ballbot3d_arms", &motion, scenario);
    common::say(&format!("{task}, {by:?}: {followed}"));
    followed
}

fn check(task: &str, by: Compensate) {
    let followed = experiment(task, by, &Scenario::default());
    followed.assert_within(NOMINAL * FRAMES);
    assert!(followed.compensation(4..6) <= BODY * FRAMES, "{followed}");
    assert!(followed.compensation(0..4) <= ARMS * FRAMES, "{followed}");
}

fn by_leaning(task: &str) {
    check(task, Compensate::Body);
}

/// Position errors are made up for as in the plan, or by the body.
fn by_arms(task: &str) {
    check(task, Compensate::Plan);
    check(task, Compensate::Body);
}

#[test]
fn straight_line() {
    by_leaning("straight_line");
}

#[test]
fn bezier_curve() {
    by_leaning("bezier_curve");
}

#[test]
fn arms_forward() {
    by_arms("arms_forward");
}

#[test]
fn arms_lateral() {
    by_arms("arms_lateral");
}

#[test]
fn arms_horizontal() {
    by_arms("arms_horizontal");
}

#[test]
fn body_and_arms() {
    by_arms("body_and_arms");
}

#[test]
fn arms_waving() {
    by_leaning("arms_waving");
}

#[test]
fn friction_at_the_drive_is_observed_through_frames() {
    let drive = Friction { viscous: 0.3, coulomb: 2.0 };
    let scenario = Scenario { drive, ..Scenario::default() };
    for task in ["straight_line", "arms_forward", "arms_waving"] {
        experiment(task, Compensate::Body, &scenario).assert_within(RUBBING * FRAMES);
    }
}
