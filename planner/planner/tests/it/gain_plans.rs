//! What the gain planner offers beside its defaults: other optimisers and parametrisations, warnings,
//! Fig. 5.

use crate::common::arms::PlanarArms;
use crate::common::robots::{CartPole, Planar, Robot, Spatial, TABLE_I};
use nalgebra::{SVector, Vector1, Vector2, Vector3};
use shapebot_planner::motion::Line;
use shapebot_planner::{
    NelderMead, Objective, Parametrisation, Task, Warning, Weighting, acceleration_bound,
    constant_acceleration, plan,
};

const ARMS: Robot<PlanarArms> =
    Robot(PlanarArms { ballbot: TABLE_I, m_a: 1.0, l_a: 0.55, i_a: 0.0016, d_z: 1.3 });

fn line<const NX: usize>(distance: f64, duration: f64) -> Line<f64, NX> {
    let mut goal = SVector::zeros();
    goal[0] = distance;
    Line::new(SVector::zeros(), goal, duration, 9).expect("a line")
}

#[test]
fn nelder_mead_agrees_with_levenberg_marquardt() {
    let robot = Robot(Spatial(TABLE_I));
    let line = Line::new(Vector2::zeros(), Vector2::new(1.2_f64, 0.7), 5.0, 9).expect("a line");
    for objective in [Objective::Output, Objective::Position, Objective::Acceleration] {
        let task = Task::new(&line, 251).objective(objective);
        let exact = plan(&robot, &task).expect("a plan");
        let simplex = plan(&robot, &task.optimiser(NelderMead::default())).expect("a plan");
        let (a, b) = (simplex.report(), exact.report());
        assert!(a.termination.converged(), "{:?}", a.termination);
        assert!((a.cost / b.cost - 1.0).abs() < 1e-9, "{} {}", a.cost, b.cost);
        let difference = simplex.gain() - exact.gain();
        assert!(difference.abs().max() < 1e-5 * exact.gain().abs().max(), "{difference}");
        // Across the line nothing is excited: K stays at K⁰.
        let across = Vector2::new(-0.7, 1.2);
        let moved = (simplex.gain() - simplex.initial_gain()) * across;
        assert!(moved.abs().max() < 1e-7 * exact.gain().abs().max(), "{moved}");
    }
}

#[test]
fn free_rows_do_no_worse_and_keep_what_is_not_excited() {
    let line = line::<1>(0.25, 5.0);
    let ratios = [1.0 / 3.0; 3];
    let task = Task::new(&line, 251).weighting(Weighting::Contributions(&ratios));
    let kept = plan(&ARMS, &task).expect("a plan");
    let free = plan(&ARMS, &task.parametrisation(Parametrisation::FreeRows));
    if let Ok(free) = free {
        assert!(free.report().cost <= kept.report().cost * (1.0 + 1e-9));
    }
    let ratios = [0.0, 0.0, 1.0];
    let task = task
        .weighting(Weighting::Contributions(&ratios))
        .parametrisation(Parametrisation::FreeRows);
    let body = plan(&ARMS, &task).expect("a plan");
    // Rows that K⁰ does not use stay zero; with one row left both parametrisations are one.
    assert_eq!((body.gain()[0], body.gain()[1]), (0.0, 0.0));
    let kept = plan(&ARMS, &task.parametrisation(Parametrisation::Proportions)).expect("a plan");
    assert!((body.gain()[2] / kept.gain()[2] - 1.0).abs() < 1e-9);
    assert!((body.factor()[0] / kept.factor()[0] - 1.0).abs() < 1e-9);
}

#[test]
fn plans_beyond_the_linear_region_warn_with_the_figure() {
    let robot = Robot(CartPole { length: 0.5 });
    let gentle = line::<1>(1.0, 6.0);
    let report = *plan(&robot, &Task::new(&gentle, 301)).expect("a plan").report();
    assert_eq!(report.warning(), None);
    let rough = line::<1>(4.0, 3.5);
    let report = *plan(&robot, &Task::new(&rough, 301)).expect("a plan").report();
    let Some(Warning::BeyondLinearRegion { nonlinearity }) = report.warning() else {
        panic!("{report:?}");
    };
    // Γ′ = g tan φ against g φ.
    let lean = report.peak_shape[0];
    assert!((nonlinearity - (lean.tan() / lean - 1.0)).abs() < 1e-3, "{nonlinearity} {lean}");
    assert!(report.termination.converged());
}

/// Fig. 5 as it comes out of Table I.
#[test]
fn figure_5() {
    let robot = Robot(Planar(TABLE_I));
    let lean = |degrees: f64| constant_acceleration(&robot, &Vector1::new(degrees.to_radians()))[0];
    assert!((lean(10.0) - 1.53).abs() < 5e-3, "{}", lean(10.0));
    assert!((lean(13.0) - 2.0).abs() < 1e-2, "{}", lean(13.0));
    let linear = lean(1e-4) / 1e-4;
    assert!((1.0 - lean(10.0) / (10.0 * linear)).abs() < 0.0095);
    assert!(((1.0 - lean(30.0) / (30.0 * linear)).abs() - 0.084).abs() < 1e-3);
    let arms = |left: f64, right: f64| {
        let shape = Vector3::new(left, right, 0.0).map(f64::to_radians);
        constant_acceleration(&ARMS, &shape)[0]
    };
    assert!((arms(-55.0, 0.0) - 0.0623).abs() < 5e-4, "{}", arms(-55.0, 0.0));
    assert!((arms(-55.0, -55.0) - 0.124).abs() < 1e-3, "{}", arms(-55.0, -55.0));
}

#[test]
fn acceleration_bounds_are_set_by_the_nearest_limit() {
    let forward = Vector1::new(1.0);
    let limits = Vector3::new(55.0, 55.0, 10.0).map(f64::to_radians);
    let bound = |ratios: &[f64; 3]| {
        acceleration_bound(&ARMS, &Weighting::Contributions(ratios), &forward, Some(&limits))
            .expect("a bound")
    };
    let body = bound(&[0.0, 0.0, 1.0]);
    assert_eq!(body.coordinate, 2);
    assert!((body.shape[2].to_degrees() - 10.0).abs() < 1e-9);
    let arms = bound(&[0.5, 0.5, 0.0]);
    assert!(arms.coordinate < 2 && (arms.acceleration - 0.124).abs() < 1e-3, "{arms:?}");
    let weighting = Weighting::<f64, 3>::MinimumNorm;
    let nowhere = acceleration_bound(&ARMS, &weighting, &Vector1::new(0.0), None);
    assert!(nowhere.is_err());
}
