//! Every bundled robot on its default task with nothing but encoder counts, a gyro and an accelerometer:
//! the estimator closes the loop.

use shapebot_control::{Controller, Gains};
use shapebot_dynamics::Robot;
use shapebot_dynamics::control::ControlDesign;
use shapebot_sim::{Estimated, Run, Scenario, Sensors, Timing, World, simulate};
use shapebot_tests::closed_loop::{Method, straight};
use shapebot_tests::environment::say;

/// Standing after the motion, s.
const AFTER: f64 = 9.0;

/// When the errors of the unit have to be found, s after the motion.
const FOUND: f64 = 8.0;

/// .05° (as the accelerometer's), .3°/s, 4096 counts per revolution or metre.
fn noise<R, const N: usize, const NX: usize, const NS: usize>(robot: &R) -> Sensors<NS>
where
    R: Robot<f64, N, NX, NS>,
{
    let unit = robot.description().coordinates[0].unit;
    let turn = if unit == "rad" { std::f64::consts::TAU } else { 1.0 };
    Sensors {
        lean_noise: 0.05_f64.to_radians(),
        lean_rate_noise: 0.3_f64.to_radians(),
        position_step: turn / 4096.0,
        ..Sensors::default()
    }
}

fn run<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    design: &ControlDesign,
    sensors: Sensors<NS>,
    seed: u64,
) -> Run<N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    let upper = robot.description().coordinates[0].upper;
    let half_way = 0.5 * upper * robot.output_jacobian_position()[(0, 0)];
    let task = straight(robot, half_way.min(2.0), 5.0, Method::Refined);
    let gains = Gains::from_design(robot, design).expect("gains");
    let scenario = Scenario { sensors, seed, ..Scenario::default() };
    let timing = Timing { period: gains.period, after: AFTER, ..Timing::default() };
    let world = World { system: robot, map: robot, scenario: &scenario, timing };
    let controller = Controller::new(robot, &gains).expect("a controller");
    let estimated = Estimated::new(robot, controller, &sensors, gains.period);
    let mut estimated = estimated.expect("an estimator");
    simulate(&world, &task.table, &mut estimated).expect("a run")
}

/// RMSE over the motion, and the largest error once the unit's errors have to be found, m.
fn errors<R, const N: usize, const NX: usize, const NS: usize>(
    (name, robot, design): (&str, &R, &ControlDesign),
    sensors: Sensors<NS>,
    seed: u64,
) -> [f64; 2]
where
    R: Robot<f64, N, NX, NS>,
{
    let run = run(robot, design, sensors, seed);
    assert_eq!(run.fell, None, "{name}");
    let errors = [run.errors.plan_rmse, run.plan_error_after(5.0 + FOUND)];
    say(&format!("{name}, seed {seed}: RMSE {:.5} m, late {:.5} m", errors[0], errors[1]));
    errors
}

/// A unit half a degree askew whose gyro is off by .3°/s.
fn biased<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    mut sensors: Sensors<NS>,
) -> Sensors<NS>
where
    R: Robot<f64, N, NX, NS>,
{
    for index in robot.description().unactuated_shape() {
        sensors.lean_bias[index] = 0.5_f64.to_radians();
        sensors.lean_rate_bias[index] = 0.3_f64.to_radians();
    }
    sensors
}

fn bears_noise<R, const N: usize, const NX: usize, const NS: usize>(
    name: &str,
    robot: &R,
    design: &ControlDesign,
) where
    R: Robot<f64, N, NX, NS>,
{
    for seed in 0..3 {
        let [error, _] = errors((name, robot, design), noise(robot), seed);
        assert!(error <= 0.006, "{name}: {error} m");
    }
}

fn finds_errors<R, const N: usize, const NX: usize, const NS: usize>(
    name: &str,
    robot: &R,
    design: &ControlDesign,
) where
    R: Robot<f64, N, NX, NS>,
{
    let quiet = Sensors { lean_noise: 0.0, lean_rate_noise: 0.0, ..noise(robot) };
    let [error, late] = errors((name, robot, design), biased(robot, quiet), 0);
    assert!(error <= 0.07, "{name}: {error} m");
    assert!(late <= 0.005, "{name}: {late} m");
    for seed in 0..3 {
        let [error, late] = errors((name, robot, design), biased(robot, noise(robot)), seed);
        assert!(error <= 0.07, "{name}: {error} m");
        assert!(late <= 0.01, "{name}: {late} m");
    }
}

macro_rules! robots {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        $(mod $module {
            use shapebot_generated::$module::{CONTROL, $robot};

            #[test]
            fn noise_and_counts_cost_millimetres() {
                super::bears_noise($name, &$robot::<f64>::from_model(), &CONTROL);
            }

            #[test]
            fn the_unit_s_errors_are_found() {
                super::finds_errors($name, &$robot::<f64>::from_model(), &CONTROL);
            }
        })*
    };
}

shapebot_generated::for_each_robot!(robots);
