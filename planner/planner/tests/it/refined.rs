//! Refined plans: how close they come, and where they begin and end.

use crate::common::robots::{CartPole, Equations, LinearArms, Planar, Robot, Spatial, TABLE_I};
use nalgebra::{SMatrix, SVector, Vector1, Vector2};
use proptest::prelude::*;
use shapebot_planner::motion::{Bezier, Line, Transfer};
use shapebot_planner::{Error, Refinement, Start, Task, Weighting, Workspace, refine};
use std::io::Write;

fn line<const NX: usize>(distance: f64, duration: f64) -> Line<f64, NX> {
    let mut goal = SVector::zeros();
    goal[0] = distance;
    Line::new(SVector::zeros(), goal, duration, 9).expect("a line")
}

/// RMSE inside [0, t_f] and over the window, on a ten times finer grid.
fn errors<E: Equations<NX, NS>, const NX: usize, const NS: usize>(
    name: &str,
    equations: E,
    standing: f64,
    bounds: [f64; 2],
) {
    let robot = Robot(equations);
    let line = line::<NX>(2.0, 5.0);
    let mut workspace = Workspace::<f64, NX, 64>::new();
    let refinement = Refinement::default().standing(standing);
    let task = Task::new(&line, 501);
    let time = (0..200)
        .map(|_| {
            let begin = std::time::Instant::now();
            let plan = refine(&robot, &task, &refinement, &mut workspace).expect("a plan");
            std::hint::black_box(plan.report());
            begin.elapsed()
        })
        .min();
    let plan = refine(&robot, &task, &refinement, &mut workspace).expect("a plan");
    let (mut inside, mut all, mut counts) = (0.0_f64, 0.0_f64, [0.0_f64; 2]);
    for row in plan.rows(&robot, 10).expect("rows") {
        let square = row.output_error().dot(&row.output_error());
        all += square;
        counts[1] += 1.0;
        if (0.0..=5.0).contains(&row.plan.time) {
            inside += square;
            counts[0] += 1.0;
        }
    }
    let [inside, all] = [(inside / counts[0]).sqrt(), (all / counts[1]).sqrt()];
    let report = plan.report();
    let _ = writeln!(
        std::io::stderr(),
        "{name}, {standing} s standing: RMSE {inside:.3e} inside, {all:.3e} window, floor {:.3e}, \
         end {:.1e} m {:.1e} m/s, peak {:.2} deg, {time:?} {report:?}",
        plan.floor().expect("a floor"),
        report.output_end_error,
        report.output_end_velocity_error,
        report.peak_shape.max().to_degrees(),
    );
    assert!(report.converged);
    assert!(inside <= bounds[0] && all <= bounds[1]);
    assert!(report.output_end_error < 1e-4 && report.output_end_velocity_error < 1e-4);
}

#[test]
fn table_2_is_beaten() {
    errors("cart-pole", CartPole { length: 0.5 }, 0.0, [0.0021, 0.0021]);
    errors("planar ballbot", Planar(TABLE_I), 0.0, [0.0095; 2]);
    errors("3D ballbot", Spatial(TABLE_I), 0.0, [0.0095; 2]);
}

#[test]
fn table_2_with_standing() {
    errors("cart-pole", CartPole { length: 0.5 }, 1.0, [5e-5; 2]);
    errors("planar ballbot", Planar(TABLE_I), 1.0, [5e-4; 2]);
    errors("3D ballbot", Spatial(TABLE_I), 1.0, [5e-4; 2]);
}

#[test]
fn a_limit_is_kept_or_reported_with_the_duration_that_would_do() {
    let robot = Robot(Spatial(TABLE_I));
    let mut workspace = Workspace::<f64, 2, 64>::new();
    let refinement = Refinement::default().limits(SVector::repeat(2.0_f64.to_radians()));
    let quick = line::<2>(2.0, 5.0);
    let error = refine(&robot, &Task::new(&quick, 501), &refinement, &mut workspace)
        .map(|_| ())
        .expect_err("refused");
    let Error::LimitExceeded { coordinate, time, value, upper, duration, .. } = error else {
        panic!("{error}");
    };
    assert_eq!(coordinate, "phi_y");
    assert!(value.abs() > upper && (0.0..5.0).contains(&time), "{error}");
    let duration = duration.expect("a duration");
    assert!(duration > 6.0 && duration < 8.5, "{error}");
    let slow = line::<2>(2.0, duration);
    let plan = refine(&robot, &Task::new(&slow, 501), &refinement, &mut workspace).expect("a plan");
    let peak = plan.report().peak_shape[1].to_degrees();
    assert!(peak <= 2.0 && peak > 1.8, "{peak}");
    assert!(error.to_string().contains("would do"), "{error}");
}

#[test]
fn a_declared_range_is_a_limit() {
    let robot = Robot(CartPole { length: 0.5 });
    let mut workspace = Workspace::<f64, 1, 64>::new();
    let leap = line::<1>(20.0, 4.0);
    let error = refine(&robot, &Task::new(&leap, 401), &Refinement::default(), &mut workspace)
        .map(|_| ())
        .expect_err("refused");
    let Error::LimitExceeded { coordinate: "phi", duration: Some(duration), .. } = error else {
        panic!("{error}");
    };
    let slower = line::<1>(20.0, duration);
    assert!(
        refine(&robot, &Task::new(&slower, 401), &Refinement::default(), &mut workspace).is_ok()
    );
}

#[test]
fn u_is_the_spline_of_its_control_points() {
    let robot = Robot(Planar(TABLE_I));
    let line = line::<1>(1.0, 5.0);
    let mut workspace = Workspace::<f64, 1, 64>::new();
    let plan = refine(&robot, &Task::new(&line, 501), &Refinement::default(), &mut workspace)
        .expect("one");
    let points: Vec<f64> = plan.virtual_points().map(|p| p[0]).collect();
    assert_eq!(points.len(), plan.report().spans + 5);
    // Rest: the first and last three are zero.
    let ends = points[..3].iter().chain(&points[points.len() - 3..]);
    assert!(ends.clone().all(|p| p.abs() < 1e-9), "{points:?}");
    // De Boor on a clamped uniform knot vector.
    let spans = plan.report().spans;
    let knot = |k: usize| k.saturating_sub(5).min(spans) as f64 * 5.0 / spans as f64;
    for i in 0..50 {
        let t = 5.0 * f64::from(i) / 50.0 + 0.03;
        let span = ((t / 5.0 * spans as f64) as usize).min(spans - 1);
        let mut d: Vec<f64> = (0..6).map(|k| points[span + k]).collect();
        for level in 1..=5 {
            for k in (level..=5).rev() {
                let (a, b) = (knot(span + k), knot(span + k + 6 - level));
                let part = (t - a) / (b - a);
                d[k] = d[k - 1] * (1.0 - part) + d[k] * part;
            }
        }
        let u = plan.virtual_acceleration(t)[0][0];
        assert!(
            (u - d[5]).abs() < 1e-9 * points.iter().fold(1.0, |m: f64, p| m.max(p.abs())),
            "{t}"
        );
    }
}

#[test]
fn single_precision_plans_are_good_to_a_tenth_of_a_millimetre() {
    let robot = Robot(Spatial(TABLE_I));
    let goal = Vector2::new(1.2_f32, -0.9);
    let line = Line::new(Vector2::zeros(), goal, 5.0, 9).expect("a line");
    let mut workspace = Workspace::<f32, 2, 40>::new();
    let refinement = Refinement { tolerance: 2e-4, ..Default::default() };
    let plan = refine(&robot, &Task::new(&line, 501), &refinement, &mut workspace).expect("a plan");
    let report = plan.report();
    assert!(report.converged, "{report:?}");
    let double = Line::new(Vector2::zeros(), Vector2::new(1.2, -0.9), 5.0, 9).expect("a line");
    let mut workspace = Workspace::<f64, 2, 40>::new();
    let exact = refine(&robot, &Task::new(&double, 501), &Refinement::default(), &mut workspace)
        .expect("one");
    let difference = f64::from(report.output_rmse) - exact.report().output_rmse;
    assert!(difference.abs() < 1e-4, "{difference}");
    for i in 0..=50_u8 {
        let t = f32::from(i) / 10.0;
        let shape = plan.at(t).shape.map(f64::from) - exact.at(f64::from(t)).shape;
        assert!(shape.abs().max() < 2e-4, "{t}: {shape}");
    }
}

#[test]
fn plans_begin_as_asked_and_end_at_rest() {
    let robot = Robot(Spatial(TABLE_I));
    let start = Start {
        position: Vector2::new(1.0, -2.0),
        velocity: Vector2::new(9.0, -1.0),
        shape: Vector2::new(0.02, 0.08),
        shape_velocity: Vector2::new(-0.05, 0.1),
        shape_acceleration: None,
    };
    let mut to = [Vector2::zeros(); 5];
    to[0] = Vector2::new(2.5, 0.3);
    let motion = Transfer::new(&start.output(&robot), &to, 6.0).expect("a motion");
    let mut workspace = Workspace::<f64, 2, 64>::new();
    let refinement = Refinement::default().start(start);
    let plan = refine(&robot, &Task::new(&motion, 601), &refinement, &mut workspace).expect("one");
    let (first, last) = (plan.at(0.0), plan.at(6.0));
    assert!((first.shape - start.shape).abs().max() < 1e-12);
    assert!((first.shape_velocity - start.shape_velocity).abs().max() < 1e-12);
    for rest in [last.shape, last.shape_velocity, last.shape_acceleration] {
        assert!(rest.abs().max() < 1e-9, "{rest}");
    }
    let rows: Vec<_> = plan.rows(&robot, 1).expect("rows").collect();
    assert_eq!((rows[0].position, rows[0].velocity), (start.position, start.velocity));
    assert!(rows[600].output_error().abs().max() < 1e-4);
    assert!(rows[600].velocity.abs().max() < 1e-3);
    assert!(plan.report().converged);
}

#[test]
fn senseless_refinements_are_refused_by_name() {
    let robot = Robot(CartPole { length: 0.5 });
    let line = line::<1>(1.0, 5.0);
    let default = Refinement::default();
    let refusal = |samples, refinement: Refinement<f64, 1, 1>| {
        let mut workspace = Workspace::<f64, 1, 32>::new();
        refine(&robot, &Task::new(&line, samples), &refinement, &mut workspace)
            .map(|_| ())
            .expect_err("refused")
            .to_string()
    };
    assert_eq!(refusal(8, default), "samples is 8, expected at least 9");
    let text = refusal(101, Refinement { standing_before: -1.0, ..default });
    assert!(text.starts_with("standing time before the motion is -1"), "{text}");
    let text = refusal(101, Refinement { standing_after: f64::INFINITY, ..default });
    assert!(text.starts_with("standing time after the motion is inf"), "{text}");
    let text = refusal(101, Refinement { spans: Some(26), ..default });
    assert!(text.starts_with("number of spans is 26"), "{text}");
    let text = refusal(101, Refinement { max_sweeps: 0, ..default });
    assert!(text.starts_with("number of sweeps is 0"), "{text}");
    let text = refusal(101, default.limits(Vector1::new(f64::NAN)));
    assert!(text.starts_with("entry 0 of the limits is NaN"), "{text}");
    let still = Vector1::new(0.0);
    let start = Start {
        position: Vector1::new(f64::NAN),
        velocity: still,
        shape: still,
        shape_velocity: still,
        shape_acceleration: None,
    };
    assert_eq!(refusal(101, default.start(start)), "the start state is not finite");
    // Standing before a motion that does not.
    let points = [Vector1::new(0.0), Vector1::new(1.0)];
    let uniform = Bezier::new(&points, 4.0).expect("a curve");
    let mut workspace = Workspace::<f64, 1, 32>::new();
    let error = refine(&robot, &Task::new(&uniform, 101), &default.standing(1.0), &mut workspace)
        .map(|_| ())
        .expect_err("refused");
    assert!(error.to_string().starts_with("speed at the start of a motion after standing is 0.25"));
}

/// Any double, the awkward ones included.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![4 => -10.0..10.0_f64, 1 => any::<f64>(), 1 => Just(0.0)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_task_gives_a_refined_plan_or_a_reason(
        goal in [any_number(), any_number()],
        duration in prop_oneof![3 => 0.5..12.0_f64, 1 => any_number()],
        samples in 0..120_usize,
        standing in prop_oneof![3 => Just(0.0), 2 => 0.0..2.0_f64, 1 => any_number()],
        spans in prop::option::of(0..40_usize),
        state in [any_number(), any_number(), any_number()],
        moving in any::<bool>(),
    ) {
        let robot = Robot(Spatial(TABLE_I));
        let Ok(line) = Line::new(Vector2::zeros(), goal.into(), duration, 9) else {
            return Ok(());
        };
        // What is tested is that it returns: not how much of the day it stands.
        prop_assume!(standing.is_nan() || standing < 100.0 * duration);
        let mut refinement = Refinement { spans, ..Default::default() }.standing(standing);
        if moving {
            let [velocity, lean, rate] = state.map(|x| Vector2::new(x, -x) * 0.1);
            refinement = refinement.start(Start {
                position: Vector2::zeros(),
                velocity,
                shape: lean,
                shape_velocity: rate,
                shape_acceleration: None,
            });
        }
        let mut workspace = Workspace::<f64, 2, 48>::new();
        match refine(&robot, &Task::new(&line, samples), &refinement, &mut workspace) {
            Ok(plan) => {
                prop_assert!(plan.report().output_rmse.is_finite());
                prop_assert!(plan.report().peak_shape.max() <= 0.5 + 1e-9);
                let end = plan.at(plan.end_time());
                prop_assert!(end.shape.abs().max() < 1e-6);
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}

/// τ² zero (a textbook marble maze), negative, and large: Γ is linear, so one sweep confirms the fit.
#[test]
fn time_constants_of_any_sign_are_planned_for() {
    let mut shape_gain = SMatrix::<f64, 2, 6>::zeros();
    (shape_gain[(0, 5)], shape_gain[(1, 4)]) = (82.0, -82.0);
    (shape_gain[(0, 1)], shape_gain[(1, 0)]) = (-0.7, 0.7);
    (shape_gain[(0, 3)], shape_gain[(1, 2)]) = (-0.7, 0.7);
    let line = Line::new(Vector2::zeros(), Vector2::new(1.5, -1.0), 6.0, 9).expect("a line");
    let ratios = [0.0, 0.0, 1.0];
    let task = Task::new(&line, 601).weighting(Weighting::Contributions(&ratios));
    let mut workspace = Workspace::<f64, 2, 48>::new();
    for tau_squared in [0.0, -0.05, -0.4, 0.12, 1.0] {
        let robot = Robot(LinearArms { shape_gain, tau_squared });
        let plan = refine(&robot, &task, &Refinement::default(), &mut workspace).expect("a plan");
        let (report, floor) = (plan.report(), plan.floor().expect("a floor"));
        assert!((plan.time_constant()[(0, 0)] - tau_squared).abs() < 1e-12);
        assert!(report.converged, "{tau_squared}: {report:?}");
        // Near the least that is possible, which for −0.4 s² is 9 cm.
        assert!(
            report.output_rmse < 2.0 * floor + 1e-5,
            "{tau_squared}: {} {floor}",
            report.output_rmse
        );
        assert!(report.output_rmse > 0.98 * floor, "{tau_squared}: {} {floor}", report.output_rmse);
        assert!(report.output_end_error < 1e-4 && report.output_end_velocity_error < 1e-4);
    }
}
