//! Desired motions: values known in closed form, exact ends, derivatives that are derivatives.

use nalgebra::{Vector1, Vector2};
use shapebot_planner::Error;
use shapebot_planner::motion::{Bezier, DesiredMotion, Line, MAX_BEZIER_DEGREE, SmoothStep};

const DEGREES: [usize; 6] = [7, 9, 11, 13, 15, 17];

fn line(distance: f64, duration: f64, degree: usize) -> Line<f64, 1> {
    Line::new(Vector1::new(0.0), Vector1::new(distance), duration, degree).expect("a line")
}

/// The largest magnitude of the r-th derivative, on a fine grid.
fn peak(motion: &impl DesiredMotion<f64, 1>, r: usize) -> f64 {
    let times = (0..=100_000).map(|i| motion.duration() * f64::from(i) / 1e5);
    times.map(|t| motion.derivatives(t)[r][0].abs()).fold(0.0, f64::max)
}

/// Largest difference of derivative r + 1 from a central difference of derivative r, as a fraction of
/// the derivative's own size.
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
fn smooth_steps_are_the_textbook_polynomials() {
    // Degree 7: 35 τ⁴ − 84 τ⁵ + 70 τ⁶ − 20 τ⁷; degree 9: 126 τ⁵ − 420 τ⁶ + 540 τ⁷ − 315 τ⁸ + 70 τ⁹.
    let textbook: [(usize, &[f64]); 2] =
        [(7, &[35.0, -84.0, 70.0, -20.0]), (9, &[126.0, -420.0, 540.0, -315.0, 70.0])];
    for (degree, coefficients) in textbook {
        let step = SmoothStep::new(degree).expect("a degree");
        for i in 0..=64 {
            let tau = f64::from(i) / 64.0;
            let lowest = i32::try_from(degree / 2 + 1).expect("small");
            let powers = (lowest..).map(|power| tau.powi(power));
            let expected: f64 = coefficients.iter().zip(powers).map(|(c, p)| c * p).sum();
            assert!((step.derivatives(tau)[0] - expected).abs() < 1e-13, "{degree} {tau}");
        }
    }
}

#[test]
fn smooth_steps_end_exactly() {
    for degree in DEGREES {
        let step = SmoothStep::new(degree).expect("a degree");
        assert_eq!(step.degree(), degree);
        let zeros = if degree == 7 { 3 } else { 4 };
        let (start, end) = (step.derivatives(0.0_f64), step.derivatives(1.0_f64));
        assert_eq!((start[0], end[0]), (0.0, 1.0));
        assert!(start[1..=zeros].iter().chain(&end[1..=zeros]).all(|&d| d == 0.0), "{degree}");
        let (start, end) = (step.derivatives(0.0_f32), step.derivatives(1.0_f32));
        assert_eq!((start[0], end[0]), (0.0, 1.0));
        assert!(start[1..=zeros].iter().chain(&end[1..=zeros]).all(|&d| d == 0.0), "{degree}");
    }
    // Degree seven has three zero derivatives, not four.
    assert_eq!(SmoothStep::new(7).expect("a degree").derivatives(0.0)[4], 840.0);
}

#[test]
fn smooth_steps_are_symmetric_and_monotone() {
    for degree in DEGREES {
        let step = SmoothStep::new(degree).expect("a degree");
        let mut last = -1.0;
        for i in 0..=128 {
            let tau = f64::from(i) / 128.0;
            let (here, mirrored) = (step.derivatives(tau), step.derivatives(1.0 - tau));
            assert!((here[0] + mirrored[0] - 1.0).abs() < 1e-15, "{degree} {tau}");
            for (r, sign) in [(1, 1.0), (2, -1.0), (3, 1.0), (4, -1.0)] {
                assert!((here[r] - sign * mirrored[r]).abs() <= 1e-13 * here[r].abs().max(1.0));
            }
            assert!(here[0] > last || here[0] == 1.0 || tau < 0.02);
            last = here[0];
        }
    }
}

#[test]
fn the_ninth_degree_peaks_where_hand_computation_says() {
    let line = line(2.0, 5.0, 9);
    assert_eq!(line.derivatives(2.5)[1][0], 2.0 / 5.0 * 315.0 / 128.0);
    assert!((peak(&line, 1) - 0.984_375).abs() < 1e-9);
    // s″ = 2520 u³ (1 − 2τ) is largest at (1 − 2τ)² = 1/7, with u = τ(1 − τ) = 3/14.
    let acceleration = 2520.0 * (3.0_f64 / 14.0).powi(3) / 7.0_f64.sqrt();
    assert!((peak(&line, 2) - 2.0 / 25.0 * acceleration).abs() < 1e-9);
}

/// Fig. 6's motion: 1.414 m in 4 s.
#[test]
fn figure_6_peaks_at_0_870_and_0_828() {
    let line = line(1.414, 4.0, 9);
    assert!((peak(&line, 1) - 0.870).abs() < 5e-4);
    assert!((peak(&line, 2) - 0.828).abs() < 5e-4);
}

#[test]
fn derivatives_are_derivatives() {
    for degree in DEGREES {
        for r in 0..4 {
            let worst = worst_difference(&line(1.5, 3.0, degree), r);
            assert!(worst < 1e-6, "degree {degree}, derivative {r}: {worst:e}");
        }
    }
    let points: Vec<_> =
        (0..12).map(|k| Vector2::new(f64::from(k * k % 7), f64::from(k) * 0.3)).collect();
    for count in 2..=12 {
        let curve = Bezier::new(&points[..count], 2.5).expect("a curve");
        for r in (0..4).take(count - 1) {
            let worst = worst_difference(&curve, r);
            assert!(worst.is_nan() || worst < 1e-6, "{count} points, derivative {r}: {worst:e}");
        }
    }
}

#[test]
fn lines_stand_still_outside_their_time() {
    let (from, to) = (Vector2::new(1.0, -2.0), Vector2::new(0.25, 3.0));
    let line = Line::new(from, to, 4.0, 7).expect("a line");
    for (t, at) in [(-1.0, from), (4.5, to)] {
        let derivatives = line.derivatives(t);
        assert_eq!(derivatives[0], at);
        assert!(derivatives[1..].iter().all(|d| *d == Vector2::zeros()));
    }
}

#[test]
fn a_bezier_curve_of_degree_one_is_uniform_motion() {
    let points = [Vector2::new(1.0, 2.0), Vector2::new(3.0, -2.0)];
    let curve = Bezier::new(&points, 4.0).expect("a curve");
    let at = curve.derivatives(3.0);
    assert_eq!(at[0], Vector2::new(2.5, -1.0));
    assert_eq!(at[1], Vector2::new(0.5, -1.0));
    assert!(at[2..].iter().all(|d| *d == Vector2::zeros()));
}

/// A smooth step is the Bézier curve with half of its points at either end.
#[test]
fn a_bezier_curve_with_points_at_both_ends_is_a_smooth_step() {
    for degree in DEGREES {
        let points: Vec<_> =
            (0..=degree).map(|k| Vector1::new(if k > degree / 2 { 2.0 } else { 0.0 })).collect();
        let curve = Bezier::new(&points, 5.0).expect("a curve");
        assert_eq!(curve.degree(), degree);
        let line = line(2.0, 5.0, degree);
        for i in 0..=100 {
            let t = f64::from(i) / 20.0;
            for (a, b) in curve.derivatives(t).iter().zip(&line.derivatives(t)) {
                assert!((a - b).abs().max() < 1e-11, "{degree} {t}");
            }
        }
    }
}

#[test]
fn the_highest_degree_does_not_underflow_in_single_precision() {
    let constant = [Vector1::new(1.0_f32); MAX_BEZIER_DEGREE + 1];
    let curve = Bezier::new(&constant, 1.0).expect("a curve");
    for i in 0..=100_u8 {
        let at = curve.derivatives(f32::from(i) / 100.0);
        assert!((at[0][0] - 1.0).abs() < 1e-4, "{i}: {}", at[0][0]);
        assert_eq!(at[1][0], 0.0);
    }
}

#[test]
fn unusable_motions_are_refused_by_name() {
    let origin = Vector1::new(0.0);
    let refusal = |result: Result<Line<f64, 1>, Error>| result.expect_err("refused").to_string();
    for (degree, text) in [(8, "degree is 8"), (5, "degree is 5"), (19, "degree is 19")] {
        assert!(refusal(Line::new(origin, origin, 1.0, degree)).starts_with(text));
    }
    for (duration, text) in
        [(0.0, "duration is 0"), (-1.0, "duration is -1"), (f64::NAN, "duration is NaN")]
    {
        assert!(refusal(Line::new(origin, origin, duration, 9)).starts_with(text));
    }
    let nowhere = Vector1::new(f64::INFINITY);
    assert_eq!(
        refusal(Line::new(origin, nowhere, 1.0, 9)),
        "entry 0 of the goal is inf, expected a finite number"
    );
    for count in [0, 1, MAX_BEZIER_DEGREE + 2] {
        let points = vec![origin; count];
        let error = Bezier::new(&points, 1.0).expect_err("refused");
        assert!(matches!(error, Error::Invalid { field: "number of control points", .. }));
    }
}
