//! The ballbot with arms in closed loop: the paper's experiments under the conditions that a controller
//! has to bear, each with its bound on the error against the plan.

use rayon::prelude::*;
use shapebot_control::{Compensate, Gains};
use shapebot_dynamics::LagrangianSystem;
use shapebot_dynamics::nalgebra::SVector;
use shapebot_generated::ballbot3d_arms::{Ballbot3dArms, CONTROL, Params};
use shapebot_sim::{Floor, Friction, Reference, Run, Scenario, Sensors};
use shapebot_tests::closed_loop::{Experiment, Method, experiments, follow};
use shapebot_tests::environment::say;
use std::sync::LazyLock;

type Bot = Ballbot3dArms<f64>;
type Result = (&'static Experiment<8, 2, 6>, Run<8, 2, 6>);

static ROBOT: LazyLock<Bot> = LazyLock::new(Bot::from_model);
static REFINED: LazyLock<Vec<Experiment<8, 2, 6>>> =
    LazyLock::new(|| experiments(&ROBOT, Method::Refined));

/// Radius of the ball, m.
const RADIUS: f64 = 0.1058;
/// Friction that controller and planner do not know, N·m·s and N·m.
const FRICTION: Friction = Friction { viscous: 0.3, coulomb: 2.0 };

fn gains() -> Gains<f64, 2, 6> {
    Gains::from_design(&*ROBOT, &CONTROL).expect("gains")
}

/// Mass and inertia of the body times a factor.
fn with_body(factor: f64) -> Bot {
    let mut parameters = Params::<f64>::model();
    parameters.m_b *= factor;
    parameters.Ixx_b *= factor;
    parameters.Iyy_b *= factor;
    parameters.Izz_b *= factor;
    Bot::try_new(parameters).expect("in range")
}

/// All experiments by the refined plan, on a plant.
fn all_on(
    plant: &Bot,
    gains: &Gains<f64, 2, 6>,
    scenario: &Scenario<2, 6>,
    after: f64,
) -> Vec<Result> {
    let run = |experiment: &'static Experiment<8, 2, 6>| {
        let mut gains = *gains;
        if let (Compensate::Plan, Some(plan_gain)) = (gains.compensate, experiment.plan_gain) {
            gains.plan_gain = plan_gain;
        }
        (experiment, follow((&*ROBOT, plant), &experiment.table, &gains, scenario, after))
    };
    REFINED.par_iter().map(run).collect()
}

fn all(gains: &Gains<f64, 2, 6>, scenario: &Scenario<2, 6>, after: f64) -> Vec<Result> {
    all_on(&ROBOT, gains, scenario, after)
}

/// Nobody falls, and the RMSE against the plan stays below a bound, metres.
fn assert_bound(condition: &str, bound: f64, results: &[Result]) {
    for (experiment, run) in results {
        say(&format!(
            "{condition}, {}: {:.5} m against the plan, {:.5} m against the desired motion",
            experiment.name, run.errors.plan_rmse, run.errors.desired_rmse
        ));
    }
    for (experiment, run) in results {
        let name = experiment.name;
        assert_eq!(run.fell, None, "{condition}, {name}");
        let error = run.errors.plan_rmse;
        assert!(error <= bound, "{condition}, {name}: {error} m");
    }
}

fn degrees(angle: f64) -> f64 {
    angle.to_radians()
}

/// Largest compensation of arms and body, degrees.
fn compensation(run: &Run<8, 2, 6>) -> [f64; 2] {
    let peak = run.errors.compensation_peak;
    [peak.fixed_rows::<4>(0).max().to_degrees(), peak.fixed_rows::<2>(4).max().to_degrees()]
}

#[test]
fn nominally_the_plan_is_followed_within_a_millimetre() {
    let results = all(&gains(), &Scenario::default(), 0.0);
    assert_bound("nominal", 0.001, &results);
    for (experiment, run) in &results {
        let [_, body] = compensation(run);
        assert!(body <= 0.05, "{}: compensation of {body} deg", experiment.name);
        assert_eq!(run.errors.saturated, 0.0, "{}: at a limit", experiment.name);
    }
    let by_plan = Gains { compensate: Compensate::Plan, ..gains() };
    for (experiment, run) in all(&by_plan, &Scenario::default(), 0.0) {
        let [arms, body] = compensation(&run);
        assert!(arms <= 5.0 && body <= 0.05, "{}: {arms}, {body} deg", experiment.name);
    }
}

#[test]
fn a_body_of_a_fifth_more_or_less_mass_is_within_two_centimetres() {
    for factor in [0.8, 1.2] {
        let results = all_on(&with_body(factor), &gains(), &Scenario::default(), 0.0);
        assert_bound(&format!("{factor} of the body"), 0.02, &results);
    }
}

/// .05°, .3°/s, 4096 counts per revolution.
fn noise() -> Sensors<6> {
    Sensors {
        lean_noise: degrees(0.05),
        lean_rate_noise: degrees(0.3),
        position_step: std::f64::consts::TAU / 4096.0,
        ..Sensors::default()
    }
}

#[test]
fn delay_and_noise_cost_two_millimetres() {
    let delayed = Scenario { actuation_delay: 0.006, ..Scenario::default() };
    assert_bound("6 ms", 0.002, &all(&gains(), &delayed, 0.0));
    for seed in 0..3 {
        let noisy = Scenario { sensors: noise(), seed, ..Scenario::default() };
        assert_bound("noise", 0.002, &all(&gains(), &noisy, 0.0));
    }
}

#[test]
fn the_observer_makes_up_for_friction_at_the_drive() {
    let rubbing = Scenario { drive: FRICTION, ..Scenario::default() };
    assert_bound("friction at the drive", 0.008, &all(&gains(), &rubbing, 0.0));
    let alone = Gains { observer: false, ..gains() };
    let results = all(&alone, &rubbing, 0.0);
    assert_bound("friction at the drive, no observer", 0.08, &results);
    // It is the observer that does it.
    assert!(results.iter().any(|(_, run)| run.errors.plan_rmse > 0.02));
}

#[test]
fn friction_at_the_floor_is_seen_in_part() {
    let rubbing = Scenario { contact: FRICTION, ..Scenario::default() };
    assert_bound("friction at the floor", 0.025, &all(&gains(), &rubbing, 0.0));
}

#[test]
fn a_start_beside_the_plan_is_forgotten() {
    let mut lean = SVector::zeros();
    lean[5] = degrees(2.0);
    let beside = Scenario {
        start_position: [0.1 / RADIUS, 0.0].into(),
        start_shape: lean,
        ..Scenario::default()
    };
    for (experiment, run) in all(&gains(), &beside, 3.0) {
        let late = run.plan_error_after(experiment.table.duration() + 2.0);
        assert!(late <= 0.01, "{}: {late} m", experiment.name);
    }
}

#[test]
fn a_bias_of_the_inertial_unit_is_found() {
    let mut sensors = Sensors::default();
    sensors.lean_bias[5] = degrees(0.5);
    let biased = Scenario { sensors, ..Scenario::default() };
    for (experiment, run) in all(&gains(), &biased, 9.0) {
        let late = run.plan_error_after(experiment.table.duration() + 8.0);
        assert!(late <= 0.005, "{}: {late} m", experiment.name);
    }
}

#[test]
fn a_slope_of_two_degrees_is_climbed() {
    let points = ROBOT.description().points;
    let center = points.iter().position(|name| *name == "center").expect("the ball's centre");
    let hill = Scenario {
        floor: Floor::rising(degrees(2.0)),
        // The model writes the ball as an energy.
        weights: vec![(center, 2.44 * 9.81)],
        ..Scenario::default()
    };
    for (experiment, run) in all(&gains(), &hill, 4.0) {
        assert_eq!(run.fell, None, "{}", experiment.name);
        let end = run.errors.end_error;
        assert!(end <= 0.02, "{}: {end} m from the goal", experiment.name);
        assert!(run.errors.plan_rmse > 1e-3, "{}: no slope at all", experiment.name);
    }
}

#[test]
fn waving_arms_hardly_move_a_ball_with_friction() {
    let waving = REFINED.iter().find(|e| e.name.starts_with("arms waving")).expect("waving");
    for (drive, contact) in
        [(FRICTION, Friction::default()), (Friction::default(), FRICTION), (FRICTION, FRICTION)]
    {
        let scenario = Scenario { drive, contact, ..Scenario::default() };
        let run = follow((&*ROBOT, &*ROBOT), &waving.table, &gains(), &scenario, 0.0);
        // The paper: .04 m.
        let error = run.errors.desired_rmse;
        assert!(run.fell.is_none() && error <= 0.02, "{error} m, {:?}", run.fell);
    }
}

#[test]
fn runs_repeat_to_the_bit() {
    let line = &REFINED[0];
    let run = |seed| {
        let noisy = Scenario { sensors: noise(), seed, ..Scenario::default() };
        follow((&*ROBOT, &*ROBOT), &line.table, &gains(), &noisy, 0.0)
    };
    assert_eq!(run(5), run(5));
    assert_ne!(run(5), run(6));
}
