//! Planning as a whole: what a plan promises, and what is refused.

use crate::common::robots::{
    CartPole, Equations, LinearArms, Planar, Robot, SPATIAL, Spatial, TABLE_I,
};
use nalgebra::{Matrix2, Matrix2x6, SMatrix, SVector, Vector1, Vector2};
use proptest::prelude::*;
use shapebot_dynamics::{Description, Real, ShapeAccelerated};
use shapebot_planner::motion::{Bezier, Derivatives, DesiredMotion, Line};
use shapebot_planner::{Error, LevenbergMarquardt, Objective, Task, Termination, Weighting, plan};

const OBJECTIVES: [Objective; 3] =
    [Objective::Output, Objective::Position, Objective::Acceleration];

const BALLBOT: Robot<Spatial> = Robot(Spatial(TABLE_I));
const CART_POLE: Robot<CartPole> = Robot(CartPole { length: 0.5 });

fn line(goal: [f64; 2], duration: f64) -> Line<f64, 2> {
    Line::new(Vector2::zeros(), goal.into(), duration, 9).expect("a line")
}

#[test]
fn a_trait_object_is_planned_for() {
    let line = line([2.0, 0.0], 5.0);
    let robot: &dyn ShapeAccelerated<f64, 2, 2> = &BALLBOT;
    let motion: &dyn DesiredMotion<f64, 2> = &line;
    let dynamic = plan(robot, &Task::new(motion, 501)).expect("a plan");
    let concrete = plan(&BALLBOT, &Task::new(&line, 501)).expect("a plan");
    assert_eq!(dynamic.gain(), concrete.gain());
    assert_eq!(dynamic.rows(robot).len(), 501);
}

#[test]
fn directions_across_a_line_keep_the_initial_gain() {
    for objective in OBJECTIVES {
        let along_x = line([2.0, 0.0], 5.0);
        let plan_x =
            plan(&BALLBOT, &Task::new(&along_x, 501).objective(objective)).expect("a plan");
        assert_eq!(plan_x.gain().column(1), plan_x.initial_gain().column(1), "{objective:?}");
        assert_ne!(plan_x.gain().column(0), plan_x.initial_gain().column(0), "{objective:?}");

        let slanted = line([1.2, 0.7], 5.0);
        let plan = plan(&BALLBOT, &Task::new(&slanted, 501).objective(objective)).expect("a plan");
        let across = Vector2::new(-0.7, 1.2).map(|x| x / 1.93_f64.sqrt());
        let moved = plan.factor() * across - across;
        assert!(moved.abs().max() < 1e-9, "{objective:?}: {moved}");
    }
}

#[test]
fn single_precision_plans_agree_with_double() {
    fn compare<E: Equations<NX, NS>, const NX: usize, const NS: usize>(
        equations: E,
        goal: [f64; NX],
    ) {
        let robot = Robot(equations);
        let double = Line::new(SVector::zeros(), goal.into(), 5.0, 9).expect("a line");
        let goal = SVector::from(goal).map(<f32 as Real>::from_f64);
        let single = Line::new(SVector::zeros(), goal, 5.0, 9).expect("a line");
        for objective in OBJECTIVES {
            let double =
                plan(&robot, &Task::new(&double, 501).objective(objective)).expect("a plan");
            let single =
                plan(&robot, &Task::new(&single, 501).objective(objective)).expect("a plan");
            let (a, b) = (single.report(), double.report());
            assert!(a.termination.converged(), "{objective:?}: {:?}", a.termination);
            assert!((f64::from(a.output_rmse) - b.output_rmse).abs() < 2e-5, "{objective:?}");
            assert!((f64::from(a.cost) / b.cost - 1.0).abs() < 1e-4, "{objective:?}");
            let difference = single.gain().map(f64::from) - double.gain();
            assert!(difference.abs().max() < 2e-4 * double.gain().abs().max(), "{difference}");
        }
    }
    compare(CartPole { length: 0.5 }, [2.0]);
    compare(Planar(TABLE_I), [2.0]);
    compare(Spatial(TABLE_I), [2.0, 0.0]);
    compare(Spatial(TABLE_I), [1.2, -0.9]);
}

/// The operator 1 − τ² d²/dt² of a linear robot has no constant inverse, but the best gain is known:
/// the regression of the desired on what a unit gain does.
#[test]
fn a_linear_robot_gets_the_regression_gain() {
    let shape_gain = Matrix2x6::new(
        0.0, -0.7, 0.0, -0.7, 0.0, 82.0, //
        0.7, 0.0, 0.7, 0.0, -82.0, 0.0,
    );
    let robot = Robot(LinearArms { shape_gain, tau_squared: 0.12 });
    let motion = line([1.0, 0.0], 5.0);
    let task = Task::new(&motion, 401)
        .weighting(Weighting::Contributions(&[0.0, 0.0, 1.0]))
        .objective(Objective::Acceleration);
    let plan = plan(&robot, &task).expect("a plan");
    let (mut above, mut below) = (0.0, 0.0);
    for i in 0..=400 {
        let x = motion.derivatives(f64::from(i) / 80.0);
        let unit = x[2][0] - 0.12 * x[4][0];
        above += unit * x[2][0];
        below += unit * unit;
    }
    assert!((plan.factor()[(0, 0)] - above / below).abs() < 1e-9);
    assert!(plan.report().peak_shape.iter().take(4).all(|&peak| peak == 0.0));
}

#[test]
fn each_objective_is_best_at_its_own_game() {
    let line = line([2.0, 0.0], 5.0);
    let [output, position, acceleration] = OBJECTIVES.map(|objective| {
        *plan(&BALLBOT, &Task::new(&line, 501).objective(objective)).expect("a plan").report()
    });
    assert!(
        output.output_rmse < position.output_rmse && position.position_rmse < output.position_rmse
    );
    assert!(acceleration.acceleration_cost < output.acceleration_cost);
    // Eq. 33 to the letter tracks the position worse: 0.30 m.
    assert!(acceleration.output_rmse > 5.0 * output.output_rmse);
    for report in [output, position, acceleration] {
        assert!(report.cost < report.initial_cost);
        assert!(report.output_max_error >= report.output_rmse.max(report.output_end_error));
    }
}

#[test]
fn rows_satisfy_equations_31_and_32() {
    let points = [[0.0, 0.0], [0.0, 0.2], [0.6, 0.2], [0.6, 0.8]].map(Vector2::from);
    let curve = Bezier::new(&points, 6.0).expect("a curve");
    let plan = plan(&BALLBOT, &Task::new(&curve, 301)).expect("a plan");
    let rows: Vec<_> = plan.rows(&BALLBOT).collect();
    assert_eq!(rows.len(), 301);
    assert_eq!((rows[0].plan.time, rows[300].plan.time), (0.0, 6.0));
    // The plan starts with the motion's own position and velocity.
    assert_eq!(rows[0].position, rows[0].plan.desired.position[0]);
    assert_eq!(rows[0].velocity, rows[0].plan.desired.position[1]);
    let mut squares = 0.0_f64;
    for row in &rows {
        let point = plan.at(row.plan.time);
        assert_eq!(point, row.plan);
        assert_eq!(point.shape, plan.gain() * point.desired.position[2]);
        let gamma = BALLBOT.gamma(&point.shape, &point.shape_velocity, &point.shape_acceleration);
        assert_eq!(row.acceleration, gamma);
        assert_eq!(row.output, BALLBOT.output(&row.position, &point.shape));
        squares += row.output_error().dot(&row.output_error());
    }
    let report = plan.report();
    assert!((report.cost - squares).abs() < 1e-12 * squares);
    assert!((report.output_rmse - (squares / 301.0).sqrt()).abs() < 1e-14);
    assert_eq!(
        report.output_end_error,
        rows[300].output_error().dot(&rows[300].output_error()).sqrt()
    );
}

#[test]
fn resampled_rows_are_of_the_same_motion() {
    let line = line([1.0, 0.5], 5.0);
    let plan = plan(&BALLBOT, &Task::new(&line, 251)).expect("a plan");
    let fine = plan.resampled_rows(&BALLBOT, 1001).expect("rows").step_by(4);
    for (a, b) in plan.rows(&BALLBOT).zip(fine) {
        assert!((a.plan.time - b.plan.time).abs() < 1e-12);
        assert!((a.output - b.output).abs().max() < 1e-7);
    }
    assert!(plan.resampled_rows(&BALLBOT, 3).is_err());
}

/// An output that is not zero at the origin and mixes its axes.
#[derive(Clone, Copy)]
struct Surveyed;

const AXES: Matrix2<f64> = Matrix2::new(0.05, -0.1, 0.2, 0.03);

impl Equations<2, 2> for Surveyed {
    fn gamma<T: Real>(&self, a: &Vector2<T>, b: &Vector2<T>, c: &Vector2<T>) -> Vector2<T> {
        BALLBOT.0.gamma(a, b, c)
    }
    fn output<T: Real>(&self, qx: &Vector2<T>, qs: &Vector2<T>) -> Vector2<T> {
        AXES.map(T::from_f64) * (qx + qs * qs[0]) + Vector2::new(3.0, -4.0).map(T::from_f64)
    }
    fn description(&self) -> &Description {
        &SPATIAL
    }
}

#[test]
fn outputs_with_an_offset_are_reached() {
    let (from, to) = (Vector2::new(3.0, -4.0), Vector2::new(3.5, -3.5));
    let line = Line::new(from, to, 6.0, 9).expect("a line");
    let plan = plan(&Robot(Surveyed), &Task::new(&line, 301)).expect("a plan");
    assert!(plan.report().termination.converged());
    assert!(plan.report().output_end_error < 0.05, "{:?}", plan.report());
    let start = plan.at(0.0).desired;
    assert!(start.position[0].abs().max() < 1e-12 && start.output[0] == from);
}

#[test]
fn a_motion_that_stands_still_needs_no_shape() {
    let line = line([0.0, 0.0], 5.0);
    let plan = plan(&BALLBOT, &Task::new(&line, 11)).expect("a plan");
    assert_eq!(plan.report().termination, Termination::SmallCost);
    assert_eq!(plan.report().peak_shape, Vector2::zeros());
    assert_eq!(plan.gain(), plan.initial_gain());
    assert_eq!(plan.report().evaluations, 22);
}

#[test]
fn the_optimiser_can_be_told_when_to_stop() {
    let line = line([2.0, 0.0], 5.0);
    let with = |optimiser| {
        *plan(&BALLBOT, &Task::new(&line, 501).optimiser(optimiser)).expect("a plan").report()
    };
    let default = LevenbergMarquardt::default();
    let none = with(LevenbergMarquardt { max_iterations: 0, ..default });
    assert_eq!((none.iterations, none.termination), (0, Termination::IterationLimit));
    assert_eq!(none.cost, none.initial_cost);
    let threshold = with(LevenbergMarquardt { cost_threshold: 1.5, ..default });
    assert_eq!(threshold.termination, Termination::SmallCost);
    assert!(threshold.cost > with(default).cost);
    let task =
        Task::new(&line, 501).optimiser(LevenbergMarquardt { step_tolerance: -1.0, ..default });
    let error = plan(&BALLBOT, &task).expect_err("refused");
    assert!(error.to_string().starts_with("step tolerance is -1, expected"), "{error}");
}

#[test]
fn a_plan_beyond_a_declared_range_is_refused_with_place_and_time() {
    let line = line([0.0, 20.0], 5.0);
    let error = plan(&BALLBOT, &Task::new(&line, 501)).expect_err("refused");
    let Error::OutOfRange { coordinate, unit, time, value, lower, upper } = error else {
        panic!("{error}");
    };
    assert_eq!((coordinate, unit, lower, upper), ("phi_x", "rad", -0.5, 0.5));
    assert!(value < -0.5 && value > -0.6 && time > 0.5 && time < 1.5, "{error}");
    assert!(error.to_string().starts_with("`phi_x` is planned to -0.5"), "{error}");
}

#[test]
fn senseless_tasks_are_refused_by_name() {
    struct Custom(f64, f64);
    impl DesiredMotion<f64, 2> for Custom {
        fn duration(&self) -> f64 {
            self.0
        }
        fn derivatives(&self, t: f64) -> Derivatives<f64, 2> {
            [Vector2::repeat(if t > 0.5 { self.1 } else { 0.0 }); 5]
        }
    }
    let refusal = |motion: Custom, samples| {
        plan(&BALLBOT, &Task::new(&motion, samples)).expect_err("refused").to_string()
    };
    for samples in 0..4 {
        let text = refusal(Custom(1.0, 0.0), samples);
        assert_eq!(text, format!("samples is {samples}, expected at least 4"));
    }
    assert!(refusal(Custom(0.0, 0.0), 10).starts_with("duration is 0"));
    assert!(refusal(Custom(f64::NAN, 0.0), 10).starts_with("duration is NaN"));
    let text = refusal(Custom(1.0, f64::NAN), 11);
    assert_eq!(text, "the desired motion is not finite at t = 0.6000000000000001 s");
}

/// A robot that falls over a singularity at a lean of 0.1.
#[derive(Clone, Copy)]
struct Brittle;

impl Equations<1, 1> for Brittle {
    fn gamma<T: Real>(&self, qs: &Vector1<T>, _: &Vector1<T>, _: &Vector1<T>) -> Vector1<T> {
        let margin = T::from_f64(0.01) - qs[0] * qs[0];
        Vector1::new(qs[0] * T::from_f64(98.1) * margin.sqrt())
    }
    fn output<T: Real>(&self, qx: &Vector1<T>, _: &Vector1<T>) -> Vector1<T> {
        *qx
    }
    fn description(&self) -> &Description {
        CART_POLE.0.description()
    }
}

#[test]
fn a_response_that_is_no_number_is_refused_with_its_time() {
    let line = Line::new(Vector1::new(0.0), Vector1::new(10.0), 5.0, 9).expect("a line");
    let error = plan(&Robot(Brittle), &Task::new(&line, 101)).expect_err("refused");
    let Error::NonFinite { quantity: "acceleration response", time } = error else {
        panic!("{error}");
    };
    assert!(time > 0.2 && time < 1.5, "{error}");
}

#[test]
fn a_description_of_another_robot_is_refused() {
    #[derive(Clone, Copy)]
    struct Mislabelled;
    impl Equations<1, 1> for Mislabelled {
        fn gamma<T: Real>(&self, qs: &Vector1<T>, _: &Vector1<T>, _: &Vector1<T>) -> Vector1<T> {
            *qs
        }
        fn output<T: Real>(&self, qx: &Vector1<T>, _: &Vector1<T>) -> Vector1<T> {
            *qx
        }
        fn description(&self) -> &Description {
            &SPATIAL
        }
    }
    let line = Line::new(Vector1::new(0.0), Vector1::new(1.0), 5.0, 9).expect("a line");
    let error = plan(&Robot(Mislabelled), &Task::new(&line, 101)).expect_err("refused");
    assert_eq!(error.to_string(), "the number of position coordinates described is 2, expected 1");
}

/// Any double, the awkward ones included.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![4 => -10.0..10.0_f64, 1 => any::<f64>(), 1 => Just(0.0)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_task_gives_a_plan_or_a_reason(
        goal in [any_number(), any_number()],
        duration in any_number(),
        degree in 0..20_usize,
        samples in 0..120_usize,
        objective in prop::sample::select(OBJECTIVES.to_vec()),
    ) {
        let Ok(line) = Line::new(Vector2::zeros(), goal.into(), duration, degree) else {
            prop_assert!(
                degree % 2 == 0 || !(7..=17).contains(&degree) || duration <= 0.0
                    || !duration.is_finite() || goal.iter().any(|x| !x.is_finite())
            );
            return Ok(());
        };
        match plan(&BALLBOT, &Task::new(&line, samples).objective(objective)) {
            Ok(plan) => {
                let report = plan.report();
                prop_assert!(report.cost <= report.initial_cost);
                prop_assert!(report.output_rmse.is_finite() && report.peak_shape.max() <= 0.5);
                prop_assert!(plan.gain().iter().all(|k| k.is_finite()));
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }

    #[test]
    fn gentle_tasks_are_planned_and_converge(
        goal in [-2.0..2.0_f64, -2.0..2.0_f64],
        duration in 4.0..12.0_f64,
        degree in prop::sample::select(vec![7, 9, 11, 13]),
        samples in 100..300_usize,
    ) {
        let line = Line::new(Vector2::zeros(), goal.into(), duration, degree).expect("a line");
        let plan = plan(&BALLBOT, &Task::new(&line, samples)).expect("a plan");
        prop_assert!(plan.report().termination.converged(), "{:?}", plan.report());
        prop_assert!(plan.report().iterations <= 10);
    }

    #[test]
    fn any_weights_give_a_gain_or_a_reason(ratios in [any_number(), any_number(), any_number()]) {
        let shape_gain = Matrix2x6::new(
            0.0, -0.7, 0.0, -0.7, 0.0, 82.0, //
            0.7, 0.0, 0.7, 0.0, -82.0, 0.0,
        );
        let robot = Robot(LinearArms { shape_gain, tau_squared: 0.1 });
        let refused = Weighting::Contributions(&ratios).gain(&robot).is_err();
        let senseless = ratios.iter().any(|c| !c.is_finite() || *c < 0.0)
            || (ratios.iter().sum::<f64>() - 1.0).abs() > 1e-5;
        prop_assert_eq!(refused, senseless);
        let total: f64 = ratios.iter().map(|c| c.abs()).sum();
        if total.is_finite() && total > 1e-3 {
            let shares = ratios.map(|c| c.abs() / total);
            let gain: SMatrix<f64, 6, 2> =
                Weighting::Contributions(&shares).gain(&robot).expect("a gain");
            let identity = shape_gain * gain - Matrix2::identity();
            prop_assert!(identity.abs().max() < 1e-13);
        }
    }
}
