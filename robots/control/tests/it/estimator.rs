//! The estimator on readings made from simulated motions.

use crate::common::{Check, PERIOD, Plan, advance, balances, every, reach, rest, standing, travel};
use nalgebra::{SMatrix, SVector, Vector3};
use shapebot_control::estimator::{Estimate, Estimator, Reading, Settings};
use shapebot_control::{Controller, Gains, State};
use shapebot_dynamics::control::ControlDesign;
use shapebot_dynamics::{LagrangianSystem, Robot};

type With<'a, R> = &'a dyn Fn(&str, f64) -> R;

/// What the sensors get wrong.
#[derive(Clone, Copy, Debug, Default)]
struct Faults {
    /// Of every gyro axis, rad/s.
    gyro: f64,
    /// Angle by which the unit is mounted wrongly, rad, about the axis along which it matters.
    tilt: f64,
    /// Rate at which the robot turns about the vertical, rad/s.
    turning: f64,
    /// Added to the counts at the start.
    counts: i32,
}

/// Sensors on a frame and a point of a robot.
struct Suite<'r, R, const N: usize> {
    robot: &'r R,
    frame: usize,
    settings: Settings<f64, N>,
    faults: Faults,
}

impl<R: LagrangianSystem<f64, N>, const N: usize> Suite<'_, R, N> {
    fn turned(&self, state: &State<f64, N>, time: f64) -> SMatrix<f64, 3, 3> {
        self.robot.frame_rotation(&(state.q + state.qd * time), self.frame)
    }

    fn velocity(&self, state: &State<f64, N>) -> Vector3<f64> {
        self.robot.point_jacobian(&state.q, self.settings.point) * state.qd
    }

    /// A reading between two states, a period apart.
    fn read(&self, state: &State<f64, N>, next: &State<f64, N>) -> Reading<f64, N> {
        let (h, up) = (1e-4, Vector3::z());
        let rotation = self.turned(state, 0.0);
        let change = (self.turned(state, h) - self.turned(state, -h)) / (2.0 * h);
        let spin = rotation.transpose() * change;
        let turning = rotation.transpose() * up * self.faults.turning;
        let gyro = Vector3::new(spin[(2, 1)], spin[(0, 2)], spin[(1, 0)]) + turning;
        let (before, after) = (self.velocity(state), self.velocity(next));
        let carried = up.cross(&before) * self.faults.turning;
        let felt = (after - before) / self.settings.period + carried + up * self.settings.gravity;
        let (s, c) = self.faults.tilt.sin_cos();
        let wrong = SMatrix::<f64, 3, 3>::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c);
        let count = |i: usize| (state.q[i] / self.settings.resolution[i]).round() as i64;
        Reading {
            counts: std::array::from_fn(|i| (count(i) as i32).wrapping_add(self.faults.counts)),
            gyro: wrong.transpose() * gyro + Vector3::repeat(self.faults.gyro),
            accelerometer: wrong.transpose() * (rotation.transpose() * felt),
        }
    }
}

/// Largest errors over the last fifth of a run, and the last estimate.
struct Outcome<const N: usize, const NS: usize> {
    angle: f64,
    rate: f64,
    last: Estimate<f64, N, NS>,
    /// Error of the plan at the end, any coordinate of q_x.
    end: f64,
    /// The largest such error of the output, m.
    largest: f64,
}

/// Follows a plan; the controller gets the truth, or the estimate.
fn follow<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    design: &ControlDesign,
    plan: &Plan<N, NX, NS>,
    faults: Faults,
    trusting: bool,
) -> Outcome<N, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    let gains = Gains::from_design(robot, design).expect("gains");
    let mut controller = Controller::new(robot, &gains).expect("a controller");
    let settings = Settings::new(PERIOD);
    let mut estimator = Estimator::new(robot, &settings, &SVector::zeros()).expect("an estimator");
    let frame = estimator.frame().unwrap_or(0);
    let suite = Suite { robot, frame, settings, faults };
    let mut state = rest();
    let mut reading = suite.read(&state, &state);
    let (mut angle, mut rate, mut end, mut largest) = (0.0_f64, 0.0_f64, 0.0, 0.0_f64);
    let output = |q: &SVector<f64, N>| {
        let (qx, qs) = R::split(q);
        robot.output(&qx, &qs)
    };
    let mut last = estimator.step(&reading, &SVector::zeros());
    for (step, target) in plan.iter().enumerate() {
        let command = controller.step(if trusting { &last.state } else { &state }, target);
        assert!(!command.fault);
        let next = advance(robot, &state, &command.force, [0.0; 2], PERIOD);
        reading = suite.read(&next, &next);
        reading.accelerometer = suite.read(&state, &next).accelerometer;
        state = next;
        let expected = R::join(&target.position[2], &target.shape[2]);
        last = estimator.step(&reading, &expected);
        assert!(!last.fault);
        if 5 * step >= 4 * plan.len() {
            angle = angle.max((last.state.q - state.q).abs().max());
            rate = rate.max((last.state.qd - state.qd).abs().max());
        }
        end = (R::split(&state.q).0 - target.position[0]).abs().max();
        let wanted = robot.output(&target.position[0], &target.shape[0]);
        largest = largest.max((output(&state.q) - wanted).abs().max());
    }
    Outcome { angle, rate, last, end, largest }
}

struct Follows;

impl Check for Follows {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        let plan = travel(robot, reach(robot), 5.0, 0.0);
        let outcome = follow(robot, design, &plan, Faults::default(), false);
        assert!(outcome.angle < 0.05_f64.to_radians(), "{name}: {}", outcome.angle);
        assert!(outcome.rate < 0.03, "{name}: {}", outcome.rate);
        assert_eq!(estimated_frame(robot), balances(robot), "{name}");
    }
}

fn estimated_frame<R, const N: usize, const NX: usize, const NS: usize>(robot: &R) -> bool
where
    R: Robot<f64, N, NX, NS>,
{
    let estimator = Estimator::new(robot, &Settings::new(PERIOD), &SVector::zeros());
    estimator.expect("an estimator").frame().is_some()
}

#[test]
fn a_motion_is_followed() {
    every::<Follows>();
}

/// How far a robot may go until its unit's errors are found, m.
const MOVED: f64 = 0.07;

struct FindsGyroBias;

impl Check for FindsGyroBias {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        if !balances(robot) {
            return;
        }
        let bias = 0.3_f64.to_radians();
        let faults = Faults { gyro: bias, ..Faults::default() };
        let outcome = follow(robot, design, &standing(40.0), faults, true);
        assert!(outcome.angle < 0.1_f64.to_radians(), "{name}: {}", outcome.angle);
        // Along the horizontal axes about which the robot leans.
        let found = outcome.last.gyro_bias;
        assert!((found[1] - bias).abs() < 0.02 * bias, "{name}: {found}");
        if NX > 1 {
            assert!((found[0] - bias).abs() < 0.02 * bias, "{name}: {found}");
        }
        assert!(outcome.end < 0.001, "{name}: {}", outcome.end);
        assert!(outcome.largest < MOVED, "{name}: {}", outcome.largest);
    }
}

#[test]
fn a_bias_of_the_gyro_is_found() {
    every::<FindsGyroBias>();
}

struct FindsOffset;

impl Check for FindsOffset {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        if !balances(robot) {
            return;
        }
        let tilt = 0.5_f64.to_radians();
        let faults = Faults { tilt, ..Faults::default() };
        let outcome = follow(robot, design, &standing(40.0), faults, true);
        // The unit says less than the true lean about y.
        let lean = N - 1;
        let found = outcome.last.offset[NS - 1];
        assert!((found.abs() / tilt - 1.0).abs() < 0.02, "{name}: {found}");
        let measured = outcome.last.state.q[lean];
        assert!((measured - found).abs() < 0.02 * tilt, "{name}: {measured} less {found}");
        assert!(outcome.end < 0.01, "{name}: {}", outcome.end);
        assert!(outcome.largest < MOVED, "{name}: {}", outcome.largest);
    }
}

#[test]
fn a_unit_that_is_mounted_askew_is_found_and_the_robot_ends_where_it_should() {
    every::<FindsOffset>();
}

struct Turns;

impl Check for Turns {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        if !balances(robot) {
            return;
        }
        let faults = Faults { turning: 0.4, counts: i32::MAX - 1000, ..Faults::default() };
        let plan = travel(robot, reach(robot), 5.0, 0.0);
        let duration = plan.len() as f64 * PERIOD;
        let outcome = follow(robot, design, &plan, faults, false);
        let heading = outcome.last.heading;
        assert!((heading - 0.4 * duration).abs() < 0.01, "{name}: {heading}");
        assert!(outcome.angle < 0.05_f64.to_radians(), "{name}: {}", outcome.angle);
    }
}

#[test]
fn turning_is_heading_and_no_lean_and_counts_may_wrap() {
    every::<Turns>();
}

struct KeepsLast;

impl Check for KeepsLast {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        _: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        let settings = Settings::new(PERIOD);
        let mut estimator = Estimator::new(robot, &settings, &SVector::zeros()).expect("settings");
        let accelerometer = Vector3::new(0.0, 0.0, 9.81);
        let good = Reading { counts: [100; N], gyro: Vector3::repeat(0.01), accelerometer };
        let before = estimator.step(&good, &SVector::zeros());
        let bad = Reading { gyro: Vector3::repeat(f64::NAN), ..good };
        let during = estimator.step(&bad, &SVector::zeros());
        assert!(during.fault && during.state == before.state, "{name}");
        let after = estimator.step(&good, &SVector::zeros());
        assert!(!after.fault && after.state.q.iter().all(|x| x.is_finite()), "{name}");
    }
}

#[test]
fn a_broken_reading_leaves_the_last_estimate() {
    every::<KeepsLast>();
}
