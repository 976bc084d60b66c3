//! Every bundled robot with its controller, on its full dynamics.

use crate::common::{Check, PERIOD, World, balances, every, reach, rest, run, standing, travel};
use nalgebra::SVector;
use shapebot_control::{Gains, State};
use shapebot_dynamics::Robot;
use shapebot_dynamics::control::ControlDesign;

type With<'a, R> = &'a dyn Fn(&str, f64) -> R;

struct Tracks;

impl Check for Tracks {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        let gains = Gains::from_design(robot, design).expect("gains");
        let plan = travel(robot, reach(robot), 5.0, 1.0);
        let run = run(robot, robot, &gains, &plan, rest(), &World::default());
        assert!(run.rmse <= 1e-3 && run.rmse > 0.0, "{name}: {run:?}");
        assert!(run.compensation.to_degrees() <= 0.05, "{name}: {run:?}");
        assert_eq!(run.limited, 0, "{name}: at a limit");
    }
}

#[test]
fn a_plan_is_tracked_within_a_millimetre() {
    every::<Tracks>();
}

struct Recovers;

impl Check for Recovers {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        let gains = Gains::from_design(robot, design).expect("gains");
        let coordinates = robot.description().shape_coordinates();
        // 2° of ±30°.
        let lean = SVector::from_fn(|i, _| coordinates[i].upper / 15.0);
        let start = State { q: R::join(&SVector::zeros(), &lean), ..rest() };
        let run = run(robot, robot, &gains, &standing(10.0), start, &World::default());
        assert!(run.end <= 0.02 * run.largest, "{name}: {run:?}");
        assert!(run.lean <= 3.0 * lean.max(), "{name}: {run:?}");
    }
}

#[test]
fn a_lean_is_recovered_from() {
    every::<Recovers>();
}

struct DecaysAsStated;

impl Check for DecaysAsStated {
    /// The slowest pole of the figures is the one that is seen: law and synthesis are of one mind.
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        let gains = Gains::from_design(robot, design).expect("gains");
        let lean = SVector::from_fn(|i, _| 1e-4 * (1.0 + i as f64));
        let start = State { q: R::join(&SVector::zeros(), &lean), ..rest() };
        let world = World { delay: 1, ..World::default() };
        // The largest error in the last fifth of so long a run is that at its beginning.
        let tail =
            |duration: f64| run(robot, robot, &gains, &standing(duration), start, &world).tail;
        let slow = design.figures.decay;
        let (first, second) = (8.0 / slow, 24.0 / slow);
        let rate = (tail(first) / tail(second)).ln() / (0.8 * (second - first));
        assert!((rate / slow - 1.0).abs() < 0.12, "{name}: {rate} of {slow}");
    }
}

#[test]
fn the_slowest_decay_is_that_of_the_figures() {
    every::<DecaysAsStated>();
}

struct HoldsOverRanges;

impl Check for HoldsOverRanges {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        with: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        let gains = Gains::from_design(robot, design).expect("gains");
        let coordinates = robot.description().shape_coordinates();
        let lean = SVector::from_fn(|i, _| coordinates[i].upper / 60.0);
        let start = State { q: R::join(&SVector::zeros(), &lean), ..rest() };
        let world = World { delay: 1, ..World::default() };
        assert!(!design.figures.ranges.is_empty(), "{name}");
        for range in design.figures.ranges {
            for value in [range.lower, range.upper] {
                let plant = with(range.name, value);
                let run = run(robot, &plant, &gains, &standing(12.0), start, &world);
                let what = format!("{name}, {} = {value}: {run:?}", range.name);
                assert!(run.tail <= 0.5 * run.largest, "{what}");
            }
        }
    }
}

#[test]
fn the_stated_ranges_hold_on_the_full_dynamics() {
    every::<HoldsOverRanges>();
}

struct Unbiased;

impl Check for Unbiased {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        let gains = Gains::from_design(robot, design).expect("gains");
        let unactuated = |i: usize| !robot.description().coordinates[i].actuated;
        let bias = SVector::from_fn(|i, _| {
            if i >= NX && (unactuated(i) || !balances(robot)) { 0.5_f64.to_radians() } else { 0.0 }
        });
        let world = World { bias, ..World::default() };
        let plan = travel(robot, reach(robot), 5.0, 8.0);
        let with = run(robot, robot, &gains, &plan, rest(), &world);
        assert!(with.end <= 0.005, "{name}: {with:?}");
        let gains = Gains { offset: false, ..gains };
        let without = run(robot, robot, &gains, &plan, rest(), &world);
        assert!(without.end > 5.0 * with.end, "{name}: {without:?}, with the observer {with:?}");
    }
}

#[test]
fn an_offset_of_half_a_degree_is_found_and_made_up_for() {
    every::<Unbiased>();
}

struct Friction;

impl Check for Friction {
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
        let gains = Gains::from_design(robot, design).expect("gains");
        // Of a drive of 60 N·m: 0.3 N·m·s and 2 N·m.
        let share = robot.description().actuators[0].limit / 60.0;
        let world = World { drive: [0.3 * share, 2.0 * share], ..World::default() };
        let plan = travel(robot, reach(robot), 5.0, 2.0);
        let run = run(robot, robot, &gains, &plan, rest(), &world);
        assert!(run.rmse <= 0.008, "{name}: {run:?}");
    }
}

#[test]
fn friction_at_the_drive_is_observed() {
    every::<Friction>();
}

#[test]
fn periods_are_those_of_the_designs() {
    struct Periods;
    impl Check for Periods {
        fn check<R, const N: usize, const NX: usize, const NS: usize>(
            name: &str,
            _: &R,
            design: &ControlDesign,
            _: With<'_, R>,
        ) where
            R: Robot<f64, N, NX, NS>,
        {
            assert!((design.period - PERIOD).abs() < 1e-12, "{name}");
        }
    }
    every::<Periods>();
}
