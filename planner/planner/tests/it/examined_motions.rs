//! Motions in a row, through waypoints, in other times: and what is said about them.

use nalgebra::{SVector, Vector1, Vector2};
use shapebot_planner::motion::{
    Bezier, DesiredMotion, Knot, Legs, Line, MotionPeaks, Rest, Sampled, Stretched, Transfer,
    Waypoint, Waypoints, fastest, first_jump, minimum_duration, peaks,
};
use shapebot_planner::{Error, TwoPhases, Workspace};

fn line(distance: f64, duration: f64, degree: usize) -> Line<f64, 1> {
    Line::new(Vector1::new(0.0), Vector1::new(distance), duration, degree).expect("a line")
}

/// Largest difference of derivative r + 1 from a central difference of derivative r, over its size.
fn worst_difference<const N: usize>(motion: &impl DesiredMotion<f64, N>, r: usize) -> f64 {
    let h = motion.duration() * 1e-5;
    let (mut size, mut worst) = (0.0_f64, 0.0_f64);
    for i in 1..200 {
        let t = motion.duration() * f64::from(i) / 200.0;
        let [after, before] = [t + h, t - h].map(|t| motion.derivatives(t)[r]);
        let exact = motion.derivatives(t)[r + 1];
        size = size.max(exact.abs().max());
        worst = worst.max((exact - (after - before) / (2.0 * h)).abs().max());
    }
    worst / size
}

#[test]
fn a_transfer_between_rests_is_the_nonic() {
    let zero = Vector1::new(0.0);
    let transfer = Transfer::between([zero, zero], [Vector1::new(2.0), zero], 5.0).expect("one");
    let line = line(2.0, 5.0, 9);
    for i in 0..=100 {
        let t = f64::from(i) / 20.0;
        for (a, b) in transfer.derivatives(t).iter().zip(&line.derivatives(t)) {
            assert!((a - b).abs().max() < 1e-11, "{t}");
        }
        assert_eq!(transfer.position(t), transfer.derivatives(t)[0]);
    }
}

#[test]
fn a_transfer_meets_every_derivative_at_both_ends() {
    let ends: [[SVector<f64, 2>; 5]; 2] = [0.0, 1.0].map(|k| {
        core::array::from_fn(|r| Vector2::new((r as f64 + k).sin(), (2.0 * r as f64 - k).cos()))
    });
    let transfer = Transfer::new(&ends[0], &ends[1], 1.7).expect("a transfer");
    for (end, time) in ends.iter().zip([0.0, 1.7]) {
        for (r, (found, asked)) in transfer.derivatives(time).iter().zip(end).enumerate() {
            assert!((found - asked).abs().max() < 1e-10, "{r} at {time}: {found} {asked}");
        }
    }
    for r in 0..4 {
        assert!(worst_difference(&transfer, r) < 1e-6, "{r}");
    }
}

#[test]
fn legs_join_and_gaps_are_refused() {
    let rest = Rest::new(Vector1::new(0.0), 1.0).expect("a rest");
    let (go, far) = (line(2.0, 3.0, 9), Rest::new(Vector1::new(2.1), 1.0).expect("a rest"));
    let parts: [&dyn DesiredMotion<f64, 1>; 2] = [&rest, &go];
    let legs = Legs::new(&parts).expect("legs");
    assert_eq!(legs.duration(), 4.0);
    assert_eq!(legs.derivatives(2.5), go.derivatives(1.5));
    assert_eq!(legs.derivatives(0.5), rest.derivatives(0.5));
    assert_eq!(legs.derivatives(9.0)[0][0], 2.0);
    assert_eq!(first_jump(&legs), None);
    let parts: [&dyn DesiredMotion<f64, 1>; 2] = [&go, &far];
    let error = Legs::new(&parts).map(|_| ()).expect_err("refused");
    assert!(
        error.to_string().starts_with("entry 1 of the gaps ahead of the legs is 0.1"),
        "{error}"
    );
    let none: [&dyn DesiredMotion<f64, 1>; 0] = [];
    assert!(Legs::new(&none).is_err());
}

#[test]
fn waypoints_are_passed_with_four_continuous_derivatives() {
    let passed = [(0.0, [0.0, 0.0]), (1.5, [0.5, 0.2]), (2.2, [0.8, -0.3]), (4.0, [1.0, 1.0])];
    let waypoints = passed.map(|(time, position)| Waypoint { time, position: position.into() });
    let mut knots = [Knot::default(); 4];
    let spline = Waypoints::<f64, 2>::new(&waypoints, &mut knots).expect("a spline");
    for Waypoint { time, position } in waypoints {
        assert!((spline.position(time) - position).abs().max() < 1e-12, "{time}");
    }
    assert_eq!(first_jump(&spline), None);
    for r in 0..4 {
        assert!(worst_difference(&spline, r) < 1e-4, "{r}: {}", worst_difference(&spline, r));
    }
    for time in [0.0, 4.0] {
        let end = spline.derivatives(time);
        assert!(end[1..].iter().all(|d| d.abs().max() < 1e-9), "{end:?}");
    }
    // A polynomial of ninth degree through its own points is itself.
    let transfer = Transfer::new(
        &[0.0, 0.3, -0.2, 0.5, 0.1].map(Vector1::new),
        &[1.0, -0.3, 0.1, 0.2, 0.4].map(Vector1::new),
        3.0,
    )
    .expect("a transfer");
    let along =
        [0.0, 0.7, 1.9, 3.0].map(|time| Waypoint { time, position: transfer.position(time) });
    let inner = |t: f64| {
        let d = transfer.derivatives(t);
        [d[1], d[2], d[3], d[4]]
    };
    let mut knots = [Knot::default(); 4];
    let spline = Waypoints::with_ends(&along, [inner(0.0), inner(3.0)], &mut knots).expect("one");
    for i in 0..=60 {
        let t = f64::from(i) / 20.0;
        for (a, b) in spline.derivatives(t).iter().zip(&transfer.derivatives(t)) {
            assert!((a - b).abs().max() < 1e-8, "{t}: {a} {b}");
        }
    }
}

#[test]
fn unusable_waypoints_are_refused_by_name() {
    let at = |time: f64, x: f64| Waypoint { time, position: Vector1::new(x) };
    let mut knots = [Knot::default(); 3];
    let mut refusal = |points: &[Waypoint<f64, 1>]| {
        Waypoints::new(points, &mut knots).map(|_| ()).expect_err("refused").to_string()
    };
    assert!(refusal(&[at(0.0, 0.0)]).starts_with("the number of waypoints is 1"));
    assert!(refusal(&[at(0.1, 0.0), at(1.0, 0.0)]).starts_with("entry 0 of the times"));
    assert!(refusal(&[at(0.0, 0.0), at(0.0, 1.0)]).starts_with("entry 1 of the times"));
    assert!(refusal(&[at(0.0, 0.0), at(1.0, f64::NAN)]).contains("coordinates of a waypoint"));
    let many = [at(0.0, 0.0), at(1.0, 0.0), at(2.0, 0.0), at(3.0, 0.0)];
    assert!(refusal(&many).starts_with("the number of knots for the waypoints is 3"));
}

#[test]
fn jumps_are_found_with_derivative_place_and_size() {
    assert_eq!(first_jump(&line(2.0, 5.0, 9)), None);
    assert_eq!(first_jump(&line(2.0, 5.0, 17)), None);
    // Degree seven starts with a snap.
    let jump = first_jump(&line(2.0, 5.0, 7)).expect("a jump");
    assert_eq!(jump.derivative, 4);
    assert!(jump.time.abs() < 1e-9 && (jump.size - 2.0 * 840.0 / 625.0).abs() < 1e-9, "{jump:?}");
    // Uniform motion starts with a speed.
    let points = [Vector1::new(0.0_f64), Vector1::new(3.0)];
    let jump = first_jump(&Bezier::new(&points, 2.0).expect("a curve")).expect("a jump");
    assert_eq!(jump.derivative, 1);
    assert!((jump.size - 1.5).abs() < 1e-12 && jump.time.abs() < 1e-9);
    // Two legs that meet with another acceleration.
    let states =
        |a: f64| [[0.5, 0.2, a, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0, 0.0]].map(|s| s.map(Vector1::new));
    let [middle, end] = states(0.3);
    let first = Transfer::new(&[Vector1::new(0.0); 5], &middle, 2.0).expect("a transfer");
    let second = Transfer::new(&states(-0.1)[0], &end, 2.0).expect("a transfer");
    let legs = [first, second];
    let jump = first_jump(&Legs::new(&legs).expect("legs")).expect("a jump");
    assert_eq!(jump.derivative, 2);
    assert!((jump.time - 2.0).abs() < 1e-9 && (jump.size - 0.4).abs() < 1e-6, "{jump:?}");
}

#[test]
fn two_phases_meet_at_cruise_speed() {
    let phases = TwoPhases::new(Vector1::new(0.0), Vector1::new(1.0), 12.3).expect("phases");
    assert_eq!(first_jump(&phases), None);
    for (half, sign) in phases.halves.iter().zip([1.0, -1.0]) {
        for i in 0..=200 {
            let a = half.derivatives(half.duration() * f64::from(i) / 200.0)[2][0];
            assert!(a * sign >= -1e-12, "{a}");
        }
    }
    let middle = phases.derivatives(6.15);
    assert!((middle[0][0] - 0.5).abs() < 1e-12 && (middle[1][0] - 1.0 / 6.15).abs() < 1e-12);
    assert!(middle[2..].iter().all(|d| d[0].abs() < 1e-9), "{middle:?}");
}

#[test]
fn the_minimum_duration_meets_its_bounds() {
    let line = line(1.414, 4.0, 9);
    let found = peaks(&line);
    assert!((found.speed - 0.869_94).abs() < 1e-4 && (found.acceleration - 0.828).abs() < 5e-4);
    for bounds in [
        MotionPeaks { speed: 0.5, acceleration: f64::INFINITY },
        MotionPeaks { speed: f64::INFINITY, acceleration: 0.2 },
        MotionPeaks { speed: 1.0, acceleration: 0.5 },
    ] {
        let fast = fastest(&line, bounds).expect("a motion");
        let found = peaks(&fast);
        assert!(found.speed <= bounds.speed * (1.0 + 1e-9));
        assert!(found.acceleration <= bounds.acceleration * (1.0 + 1e-9));
        let used = (found.speed / bounds.speed).max(found.acceleration / bounds.acceleration);
        assert!((used - 1.0).abs() < 1e-9, "{used}");
        assert_eq!(fast.duration(), minimum_duration(&line, bounds).expect("a duration"));
        assert_eq!(first_jump(&fast), None);
    }
    // Pure arm motion, 2 m within .082 m/s²: 15.2 s.
    let bounds = MotionPeaks { speed: f64::INFINITY, acceleration: 0.0813 };
    let arms = Line::new(Vector1::new(0.0), Vector1::new(2.0), 5.0, 9).expect("a line");
    assert!((minimum_duration(&arms, bounds).expect("a duration") - 15.2).abs() < 0.05);
    let senseless = MotionPeaks { speed: 0.0, acceleration: 1.0 };
    let error = minimum_duration(&arms, senseless).expect_err("refused");
    assert!(matches!(error, Error::Invalid { field: "speed bound", .. }));
    assert!(Stretched::new(arms, 0.0).is_err() && Stretched::new(arms, f64::NAN).is_err());
}

#[test]
fn samples_are_fitted_with_a_stated_error() {
    let line = line(2.0, 5.0, 9);
    let exact: Vec<_> = (0..=500).map(|i| line.position(5.0 * f64::from(i) / 500.0)).collect();
    let mut workspace = Workspace::<f64, 1, 40>::new();
    let curve = Sampled::fit(&exact, 5.0, 25, &mut workspace).expect("a curve");
    assert!(
        curve.rmse() < 1e-6 && curve.max_error() < 1e-5,
        "{} {}",
        curve.rmse(),
        curve.max_error()
    );
    assert_eq!(first_jump(&curve), None);
    let noisy: Vec<_> = exact
        .iter()
        .enumerate()
        .map(|(i, x)| x + Vector1::new(1e-3 * (i as f64 * 12.9898).sin()))
        .collect();
    let curve = Sampled::fit(&noisy, 5.0, 12, &mut workspace).expect("a curve");
    assert!(curve.rmse() > 5e-4 && curve.rmse() < 1e-3 && curve.max_error() < 2e-3);
    for r in 0..4 {
        assert!(worst_difference(&curve, r) < 1e-3, "{r}: {}", worst_difference(&curve, r));
    }
    let found: Vec<f64> = (0..=500)
        .map(|i| (curve.position(5.0 * f64::from(i) / 500.0) - noisy[i as usize])[0])
        .collect();
    let rmse = (found.iter().map(|e| e * e).sum::<f64>() / 501.0).sqrt();
    assert!((rmse / curve.rmse() - 1.0).abs() < 1e-9);
    let mut refusal = |samples: &[Vector1<f64>], spans| {
        Sampled::fit(samples, 5.0, spans, &mut workspace).map(|_| ()).expect_err("refused")
    };
    assert!(matches!(refusal(&exact[..8], 4), Error::Invalid { field: "samples", .. }));
    assert!(matches!(refusal(&exact, 34), Error::Invalid { field: "number of spans", .. }));
    let mut broken = exact.clone();
    broken[7][0] = f64::INFINITY;
    assert!(matches!(refusal(&broken, 9), Error::InvalidEntry { field: "samples", index: 7, .. }));
}
