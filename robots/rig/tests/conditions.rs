//! The paper's experiments through frames under the conditions of the closed loop's tests, within one and a
//! half times their bounds.

mod common;

use common::{Followed, follow_on};
use rayon::prelude::*;
use shapebot_control::Gains;
use shapebot_dynamics::LagrangianSystem;
use shapebot_generated::ballbot3d_arms::{Ballbot3dArms, CONTROL, Params};
use shapebot_rig::Script;
use shapebot_sim::{Floor, Friction, Plant, Scenario, Sensors};

type Bot = Ballbot3dArms<f64>;

/// What frames may cost.
const FRAMES: f64 = 1.5;
/// Friction that controller and planner do not know, N·m·s and N·m.
const FRICTION: Friction = Friction { viscous: 0.3, coulomb: 2.0 };

/// The ball goes, arms go with it, and arms move while the ball stands.
const TASKS: [&str; 3] = ["straight_line", "arms_forward", "arms_waving"];

/// Tasks on a plant, with so much standing after the plan, µs.
fn all(
    condition: &str,
    plant: &Bot,
    scenario: &Scenario<2, 6>,
    gains: impl Fn(&mut Gains<f64, 2, 6>) + Sync,
    after: u64,
) -> Vec<Followed> {
    let robot = Bot::from_model();
    let run = |task: &&str| {
        let motion = common::motion(&robot, shapebot_tasks::text(task).expect("a bundled task"));
        let mut own = Gains::from_design(&robot, &CONTROL).expect("gains");
        gains(&mut own);
        let plant = Plant::new(plant, &robot, scenario, 0.0005).expect("a plant");
        let script = Script { after, ..Script::default() };
        let followed = follow_on(&robot, &plant, &own, "ballbot3d_arms", &motion, &script);
        common::say(&format!("{condition}, {task}: {followed}"));
        followed
    };
    TASKS.par_iter().map(run).collect()
}

/// As designed, with a second of standing after the plan.
fn designed(condition: &str, plant: &Bot, scenario: &Scenario<2, 6>) -> Vec<Followed> {
    all(condition, plant, scenario, |_| (), 1_000_000)
}

fn assert_within(followed: &[Followed], bound: f64) {
    followed.iter().for_each(|followed| followed.assert_within(bound * FRAMES));
}

fn with_body(factor: f64) -> Bot {
    let mut parameters = Params::<f64>::model();
    parameters.m_b *= factor;
    parameters.Ixx_b *= factor;
    parameters.Iyy_b *= factor;
    parameters.Izz_b *= factor;
    Bot::try_new(parameters).expect("in range")
}

#[test]
fn a_body_of_a_fifth_more_or_less_mass() {
    for factor in [0.8, 1.2] {
        let condition = format!("{factor} of the body");
        assert_within(&designed(&condition, &with_body(factor), &Scenario::default()), 0.02);
    }
}

#[test]
fn delay_and_noise() {
    let robot = Bot::from_model();
    let nominal = designed("nominal", &robot, &Scenario::default());
    // Beside the cycle that frames take.
    let delayed = Scenario { actuation_delay: 0.006, ..Scenario::default() };
    let delayed = designed("6 ms", &robot, &delayed);
    assert_within(&delayed, 0.002);
    let sensors = Sensors {
        lean_noise: 0.05_f64.to_radians(),
        lean_rate_noise: 0.3_f64.to_radians(),
        ..Sensors::default()
    };
    let noisy = designed("noise", &robot, &Scenario { sensors, seed: 1, ..Scenario::default() });
    assert_within(&noisy, 0.002);
    // The conditions are there.
    for (other, nominal) in delayed.iter().chain(&noisy).zip(nominal.iter().chain(&nominal)) {
        assert_ne!(other.outcome().plan_rmse, nominal.outcome().plan_rmse);
    }
}

#[test]
fn friction_at_drive_and_floor() {
    let robot = Bot::from_model();
    let rubbing = Scenario { drive: FRICTION, ..Scenario::default() };
    assert_within(&designed("friction at the drive", &robot, &rubbing), 0.008);
    let alone = |gains: &mut Gains<f64, 2, 6>| gains.observer = false;
    let alone = all("friction, no observer", &robot, &rubbing, alone, 1_000_000);
    assert_within(&alone, 0.08);
    let rubbing = Scenario { contact: FRICTION, ..Scenario::default() };
    assert_within(&designed("friction at the floor", &robot, &rubbing), 0.025);
}

#[test]
fn a_bias_of_the_inertial_unit_is_found() {
    let mut sensors = Sensors::default();
    sensors.lean_bias[5] = 0.5_f64.to_radians();
    let biased = Scenario { sensors, ..Scenario::default() };
    for followed in all("bias", &Bot::from_model(), &biased, |_| (), 8_000_000) {
        let end = followed.outcome().end_error;
        assert!(end <= 0.005 * FRAMES, "{end} m 8 s after the plan");
    }
}

#[test]
fn a_slope_of_two_degrees_is_climbed() {
    let robot = Bot::from_model();
    let points = robot.description().points;
    let center = points.iter().position(|name| *name == "center").expect("the ball's centre");
    let hill = Scenario {
        floor: Floor::rising(2.0_f64.to_radians()),
        // The model writes the ball as an energy.
        weights: vec![(center, 2.44 * 9.81)],
        ..Scenario::default()
    };
    for followed in all("slope", &robot, &hill, |_| (), 4_000_000) {
        let end = followed.outcome().end_error;
        assert!(end <= 0.02 * FRAMES, "{end} m from the goal");
        assert!(followed.outcome().plan_rmse > 1e-3, "no slope at all");
    }
}
