//! The least error that any plan can have, where axes are coupled.

use crate::common::robots::{Equations, Robot, SPATIAL};
use nalgebra::{Matrix2, Vector2};
use shapebot_dynamics::{Description, Real};
use shapebot_planner::motion::Line;
use shapebot_planner::{Refinement, Task, Workspace, refine};

/// ẍ = G(q_s − G⁻¹τ²G q̈_s): τ² and the output's Jacobian are any matrices.
struct Coupled {
    tau_squared: Matrix2<f64>,
    output: Matrix2<f64>,
}

const GAIN: f64 = 9.81;

impl Equations<2, 2> for Coupled {
    fn gamma<T: Real>(&self, qs: &Vector2<T>, _: &Vector2<T>, qsdd: &Vector2<T>) -> Vector2<T> {
        (qs - self.tau_squared.map(T::from_f64) * qsdd) * T::from_f64(GAIN)
    }
    fn output<T: Real>(&self, qx: &Vector2<T>, _: &Vector2<T>) -> Vector2<T> {
        self.output.map(T::from_f64) * qx
    }
    fn description(&self) -> &Description {
        &SPATIAL
    }
}

/// (RMSE, floor) of a line of 1.1 m in 5 s.
fn planned(tau_squared: Matrix2<f64>, output: Matrix2<f64>) -> (f64, Option<f64>) {
    let robot = Robot(Coupled { tau_squared, output });
    let line = Line::new(Vector2::zeros(), Vector2::new(1.0, 0.4), 5.0, 9).expect("a line");
    let mut workspace = Workspace::<f64, 2, 96>::new();
    let plan = refine(&robot, &Task::new(&line, 501), &Refinement::default(), &mut workspace);
    let plan = plan.expect("a plan");
    (plan.report().output_rmse, plan.floor())
}

#[test]
fn the_floor_does_not_depend_on_the_choice_of_axes() {
    let (sine, cosine) = 0.6_f64.sin_cos();
    let rotation = Matrix2::new(cosine, -sine, sine, cosine);
    for lags in [[0.12, 0.4], [0.3, -0.08], [0.25, 0.0]] {
        let lags = Matrix2::from_diagonal(&lags.into());
        let (_, floor) = planned(lags, Matrix2::identity());
        let floor = floor.expect("a floor");
        // The same robot in other coordinates q = Rx, then in coordinates that are not orthogonal.
        for change in [rotation, Matrix2::new(1.0, 0.4, -0.2, 0.7)] {
            let [[a, b], [c, d]] = change.transpose().into();
            let back = Matrix2::new(d, -b, -c, a) / (a * d - b * c);
            assert!((back * change - Matrix2::identity()).abs().max() < 1e-12);
            let (rmse, same) = planned(change * lags * back, back);
            let same = same.expect("a floor");
            assert!((same / floor - 1.0).abs() < 1e-6, "{lags}: {same} instead of {floor}");
            assert!(rmse > 0.98 * same && rmse < 2.0 * same + 1e-5, "{lags}: {rmse}, {same}");
        }
    }
}

#[test]
fn coupled_outputs_have_a_floor() {
    let skewed = Matrix2::new(1.0, 0.5, 0.0, 1.0);
    let (rmse, floor) = planned(Matrix2::from_diagonal(&[0.12, 0.4].into()), skewed);
    let floor = floor.expect("a floor");
    assert!(rmse > 0.98 * floor && rmse < 2.0 * floor, "{rmse}, {floor}");
}

#[test]
fn a_response_that_turns_has_none() {
    let (_, floor) = planned(Matrix2::new(0.1, 0.2, -0.2, 0.1), Matrix2::identity());
    assert_eq!(floor, None);
}
