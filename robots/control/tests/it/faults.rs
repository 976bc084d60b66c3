//! What the controller does with what it cannot use.

use crate::common::{Check, World, every, rest, run, standing};
use nalgebra::SVector;
use shapebot_control::{Controller, Error, Gains, State, Target};
use shapebot_dynamics::Robot;
use shapebot_dynamics::control::ControlDesign;

type With<'a, R> = &'a dyn Fn(&str, f64) -> R;

struct NotFinite;

impl Check for NotFinite {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        let gains = Gains::from_design(robot, design).expect("gains");
        let mut controller = Controller::new(robot, &gains).expect("a controller");
        let mut untouched = controller;
        let lean = SVector::from_fn(|i, _| 0.01 * (1.0 + i as f64));
        let state = State { q: R::join(&SVector::zeros(), &lean), ..rest() };
        let target = Target::stand(SVector::zeros());
        assert_eq!(controller.step(&state, &target), untouched.step(&state, &target));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200] {
            for i in 0..N {
                let mut broken = state;
                broken.qd[i] = bad;
                let command = controller.step(&broken, &target);
                let forces = command.force.abs().max() + command.actuator.abs().max();
                assert!(forces.is_finite(), "{name}: {command:?}");
                if !bad.is_finite() {
                    assert!(command.fault && forces == 0.0, "{name}: {command:?}");
                }
                if !command.fault {
                    // A number, however large, is taken at its word.
                    controller = untouched;
                }
            }
            let mut broken = target;
            broken.shape[1][0] = bad;
            let command = controller.step(&state, &broken);
            assert!(command.fault || bad.is_finite(), "{name}: {command:?}");
            if !command.fault {
                controller = untouched;
            }
        }
        // As if nothing had happened.
        let (after, expected) = (controller.step(&state, &target), untouched.step(&state, &target));
        assert_eq!(after, expected, "{name}");
        assert!(!after.fault && after.force.abs().max() > 0.0, "{name}");
    }
}

#[test]
fn what_is_not_finite_gives_no_force_and_leaves_no_trace() {
    every::<NotFinite>();
}

struct Limited;

impl Check for Limited {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        let gains = Gains { force_slew: 10.0, ..Gains::from_design(robot, design).expect("gains") };
        let mut controller = Controller::new(robot, &gains).expect("a controller");
        let coordinates = robot.description().shape_coordinates();
        let lean = SVector::from_fn(|i, _| coordinates[i].upper);
        let state = State { q: R::join(&SVector::zeros(), &lean), ..rest() };
        let target = Target::stand(SVector::zeros());
        let actuators = robot.description().actuators;
        let mut last = SVector::<f64, N>::zeros();
        for step in 0..200 {
            let command = controller.step(&state, &target);
            assert!(command.saturated || step > 0, "{name}");
            for (i, actuator) in actuators.iter().enumerate() {
                let (now, before) = (command.actuator[i], last[i]);
                assert!(now.abs() <= actuator.limit * (1.0 + 1e-12), "{name}: {command:?}");
                let most = 10.0 * actuator.limit * design.period * (1.0 + 1e-9);
                assert!((now - before).abs() <= most, "{name}: {before} to {now}");
            }
            last = command.actuator;
        }
        assert!(last.abs().max() > 0.0, "{name}");
    }
}

#[test]
fn forces_keep_their_limits_and_their_slew() {
    every::<Limited>();
}

struct Wrong;

impl Check for Wrong {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        let other = ControlDesign { balancing: !design.balancing, ..*design };
        assert_eq!(Gains::from_design(robot, &other).err(), Some(Error::Kind), "{name}");
        let short = ControlDesign { position: &[], ..*design };
        let axes = Error::Axes { what: "position", found: 0, expected: NX };
        assert_eq!(Gains::from_design(robot, &short).err(), Some(axes), "{name}");
        let gains = Gains::from_design(robot, design).expect("gains");
        let late = Gains { period: 0.0, ..gains };
        let error = Controller::new(robot, &late).err();
        assert_eq!(error, Some(Error::Gain { what: "period" }), "{name}");
        let broken = Gains { position: SVector::repeat(f64::NAN), ..gains };
        let error = Controller::new(robot, &broken).err();
        assert_eq!(error, Some(Error::Gain { what: "position" }), "{name}");
    }
}

#[test]
fn designs_and_gains_that_do_not_fit_are_refused() {
    every::<Wrong>();
}

struct Winds;

impl Check for Winds {
    /// A drive that is far too weak for a while leaves nothing behind in the integrators.
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        let gains = Gains::from_design(robot, design).expect("gains");
        let far = State { q: R::join(&SVector::repeat(0.05), &SVector::zeros()), ..rest() };
        let weak = Gains { compensation_limit: gains.compensation_limit * 0.02, ..gains };
        let away = run(robot, robot, &weak, &standing(30.0), far, &World::default());
        assert!(away.end <= 0.5 * away.largest, "{name}: {away:?}");
        assert!(away.largest <= 1.5 * 0.05, "{name}: {away:?}");
    }
}

#[test]
fn a_clipped_compensation_does_not_wind_up() {
    every::<Winds>();
}
