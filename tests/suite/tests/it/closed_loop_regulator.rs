//! The paper's comparison with a linear-quadratic regulator that tracks the desired motion.

use rayon::prelude::*;
use shapebot_control::Gains;
use shapebot_generated::ballbot3d::{Ballbot3d, CONTROL};
use shapebot_sim::{Lqr, LqrWeights, Scenario, Timing, World, simulate};
use shapebot_tests::closed_loop::{Method, follow, straight};
use shapebot_tests::environment::say;

/// Weights of squares in units of .1 m of the ball's way, 1° of lean, and 10 N·m; `rate` is that of the
/// rates beside their coordinates, s².
fn weights([position, lean, rate, effort]: [f64; 4]) -> LqrWeights {
    let way = position * (0.1058_f64 / 0.1).powi(2);
    let angle = lean * 1.0_f64.to_radians().powi(-2);
    let torque = effort * 0.1_f64.powi(2);
    let (way_rate, angle_rate) = (rate * way, rate * angle);
    LqrWeights {
        state: vec![way, way, angle, angle, way_rate, way_rate, angle_rate, angle_rate],
        actuator: vec![torque; 2],
    }
}

fn list(values: &[f64]) -> String {
    values.iter().map(|value| format!("{value:.3e}")).collect::<Vec<_>>().join(", ")
}

#[test]
fn plans_beat_a_regulator_that_tracks_the_desired_motion() {
    let robot = Ballbot3d::<f64>::from_model();
    let gains = Gains::from_design(&robot, &CONTROL).expect("gains");
    let [refined, gain] = [Method::Refined, Method::Gain].map(|method| {
        let line = straight(&robot, 1.414, 4.0, method);
        let run = follow((&robot, &robot), &line.table, &gains, &Scenario::default(), 0.0);
        assert!(run.fell.is_none());
        run.errors.desired_rmse
    });
    let line = straight(&robot, 1.414, 4.0, Method::Refined);
    let mut tried: Vec<[f64; 4]> = Vec::new();
    for position in [0.01, 0.1, 1.0, 10.0, 100.0, 1e3] {
        for effort in [1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.1, 1.0] {
            let rest = [
                (1e-6, 1e-3),
                (1e-4, 1e-3),
                (1e-6, 0.01),
                (1e-4, 0.01),
                (1e-4, 0.3),
                (0.01, 0.01),
                (0.01, 0.3),
                (1.0, 0.01),
                (1.0, 0.3),
            ];
            tried.extend(rest.map(|(lean, rate)| [position, lean, rate, effort]));
        }
    }
    let errors: Vec<_> = tried
        .par_iter()
        .filter_map(|choice| {
            let mut regulator = Lqr::new(&robot, &weights(*choice), 0.002).ok()?;
            let scenario = Scenario::default();
            let timing = Timing { after: 0.0, ..Timing::default() };
            let world = World { system: &robot, map: &robot, scenario: &scenario, timing };
            let run = simulate(&world, &line.table, &mut regulator).ok()?;
            run.fell.is_none().then_some((run.errors.desired_rmse, choice))
        })
        .collect();
    assert!(errors.len() > 20, "only {} regulators balance", errors.len());
    let best = errors.iter().min_by(|a, b| a.0.total_cmp(&b.0)).expect("a regulator");
    let LqrWeights { state, actuator } = weights(*best.1);
    say(&format!(
        "best regulator: {:.4} m with Q = diag({}), R = diag({}); gain plan {gain:.4} m, refined plan \
         {refined:.4} m",
        best.0,
        list(&state),
        list(&actuator)
    ));
    assert!(best.0 >= 8.0 * refined, "{} m, refined plan {refined} m", best.0);
    assert!(best.0 >= 2.0 * gain, "{} m, gain plan {gain} m", best.0);
}
