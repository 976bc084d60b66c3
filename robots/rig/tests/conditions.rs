//! The paper's experiments through frames under the conditions of the closed loop's tests, within one and a
//! half times their bounds.

mod common;

use common::{Followed, follow_on};
use rayon::prelude::*;
use shapebot_control::Gains;
use shapebot_dynamics::LagrangianSystem;
use shapebot_generated::ballbot3d_arms::{Ballbot3dArms, CONTROL, Params};
use shapebot_planning::PlannedMotion;
use shapebot_rig::Script;
use shapebot_sim::{Floor, Friction, Plant, Push, Scenario, Sensors};
use std::sync::LazyLock;

type Bot = Ballbot3dArms<f64>;

/// What frames may cost.
const FRAMES: f64 = 1.5;
/// Friction that controller and planner do not know, N·m·s and N·m.
const FRICTION: Friction = Friction { viscous: 0.3, coulomb: 2.0 };

/// The tasks of the closed loop's tests. The longest, in which the ball should stay, comes first, so that no
/// processor waits for the last.
const TASKS: [&str; 8] = [
    "arms_waving",
    "arms_forward",
    "arms_horizontal",
    "arms_lateral",
    "body_and_arms",
    "bezier_curve",
    "table2_ballbot3d_arms",
    "straight_line",
];

static ROBOT: LazyLock<Bot> = LazyLock::new(Bot::from_model);
/// Their plans, made once.
static PLANS: LazyLock<Vec<(&str, PlannedMotion)>> = LazyLock::new(|| {
    let plan = |task: &&'static str| {
        (*task, common::motion(&*ROBOT, shapebot_tasks::text(task).expect("a bundled task")))
    };
    TASKS.par_iter().map(plan).collect()
});

/// A second of standing before the plan and after it.
const SHORT: Script =
    Script { patience: 10_000_000, before: 1_000_000, after: 1_000_000, slack: 0 };

/// A task on a plant.
fn one(
    condition: &str,
    (plant, scenario): (&Bot, &Scenario<2, 6>),
    gains: &Gains<f64, 2, 6>,
    script: &Script,
    (task, motion): &(&str, PlannedMotion),
) -> Followed {
    let plant = Plant::new(plant, &*ROBOT, scenario, 0.0005).expect("a plant");
    let followed = follow_on(&*ROBOT, &plant, gains, "ballbot3d_arms", motion, script);
    common::say(&format!("{condition}, {task}: {followed}"));
    followed
}

fn gains() -> Gains<f64, 2, 6> {
    Gains::from_design(&*ROBOT, &CONTROL).expect("gains")
}

/// All tasks on a plant.
fn all(condition: &str, on: (&Bot, &Scenario<2, 6>), script: &Script) -> Vec<Followed> {
    PLANS.par_iter().map(|task| one(condition, on, &gains(), script, task)).collect()
}

/// All tasks on the robot as the controller knows it.
fn under(condition: &str, scenario: &Scenario<2, 6>) -> Vec<Followed> {
    all(condition, (&ROBOT, scenario), &SHORT)
}

fn assert_within(followed: &[Followed], bound: f64) {
    assert_eq!(followed.len(), TASKS.len());
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
        let on = (&with_body(factor), &Scenario::default());
        assert_within(&all(&condition, on, &SHORT), 0.02);
    }
}

#[test]
fn delay_and_noise() {
    // Beside the cycle that frames take.
    let delayed = Scenario { actuation_delay: 0.006, ..Scenario::default() };
    let delayed = under("6 ms", &delayed);
    assert_within(&delayed, 0.002);
    let sensors = Sensors {
        lean_noise: 0.05_f64.to_radians(),
        lean_rate_noise: 0.3_f64.to_radians(),
        ..Sensors::default()
    };
    let noisy = [0, 1, 2].map(|seed| {
        let noisy = Scenario { sensors, seed, ..Scenario::default() };
        under(&format!("noise of seed {seed}"), &noisy)
    });
    noisy.iter().for_each(|noisy| assert_within(noisy, 0.002));
    // The conditions are there.
    let last = PLANS.last().expect("a task");
    let nominal = one("nominal", (&ROBOT, &Scenario::default()), &gains(), &SHORT, last);
    for others in noisy.iter().chain([&delayed]) {
        let other = others.last().expect("a run").outcome().plan_rmse;
        assert!(other > 1.5 * nominal.outcome().plan_rmse, "{other} m, {nominal}");
    }
}

#[test]
fn friction_at_the_drive() {
    let rubbing = Scenario { drive: FRICTION, ..Scenario::default() };
    let observed = under("friction at the drive", &rubbing);
    assert_within(&observed, 0.008);
    assert_hardly_moves(&observed[0]);
    let gains = Gains { observer: false, ..gains() };
    let alone = |task| one("friction, no observer", (&ROBOT, &rubbing), &gains, &SHORT, task);
    let alone: Vec<Followed> = PLANS.par_iter().map(alone).collect();
    assert_within(&alone, 0.08);
    // It is the observer that does it.
    assert!(alone.iter().any(|followed| followed.outcome().plan_rmse > 0.02));
}

#[test]
fn friction_at_the_floor() {
    let rubbing = Scenario { contact: FRICTION, ..Scenario::default() };
    let observed = under("friction at the floor", &rubbing);
    assert_within(&observed, 0.025);
    assert_hardly_moves(&observed[0]);
    let everywhere = Scenario { drive: FRICTION, ..rubbing };
    let waving = &PLANS[0];
    let both = one("friction at both", (&ROBOT, &everywhere), &gains(), &SHORT, waving);
    assert_hardly_moves(&both);
}

/// Of the waving arms: the ball should stay where it began.
fn assert_hardly_moves(waving: &Followed) {
    let way = waving.distance();
    assert!(way <= 0.02 * FRAMES, "{way} m from the start, {waving}");
}

/// A push as the plan begins, and two seconds of standing after its end.
#[test]
fn what_is_beside_the_plan_at_its_beginning_is_forgotten() {
    let at = ROBOT.description().points.len() - 1;
    let push = Push { point: at, force: [50.0, 0.0, 0.0].into(), start: 2.0, duration: 0.2 };
    let pushed = Scenario { pushes: vec![push], ..Scenario::default() };
    let script = Script { after: 2_000_000, ..SHORT };
    for followed in all("beside", (&ROBOT, &pushed), &script) {
        let outcome = followed.outcome();
        assert!(outcome.plan_max > 0.1, "{} m beside the plan", outcome.plan_max);
        assert!(outcome.end_error <= 0.01 * FRAMES, "{} m 2 s after it", outcome.end_error);
    }
}

#[test]
fn a_bias_of_the_inertial_unit_is_found() {
    let mut sensors = Sensors::default();
    sensors.lean_bias[5] = 0.5_f64.to_radians();
    let biased = Scenario { sensors, ..Scenario::default() };
    let script = Script { after: 8_000_000, ..SHORT };
    for followed in all("bias", (&ROBOT, &biased), &script) {
        let end = followed.outcome().end_error;
        assert!(end <= 0.005 * FRAMES, "{end} m 8 s after the plan");
    }
}

#[test]
fn a_slope_of_two_degrees_is_climbed() {
    let points = ROBOT.description().points;
    let center = points.iter().position(|name| *name == "center").expect("the ball's centre");
    let hill = Scenario {
        floor: Floor::rising(2.0_f64.to_radians()),
        // The model writes the ball as an energy.
        weights: vec![(center, 2.44 * 9.81)],
        ..Scenario::default()
    };
    // A plan is followed from its start only, to which the robot has to come back first.
    let script = Script { before: 3_000_000, after: 4_000_000, ..SHORT };
    for followed in all("slope", (&ROBOT, &hill), &script) {
        let end = followed.outcome().end_error;
        assert!(end <= 0.02 * FRAMES, "{end} m from the goal");
        assert!(followed.outcome().plan_rmse > 1e-3, "no slope at all");
    }
}
