//! Refined plans: how close they come, and where they begin and end.

mod common;

use common::robots::{CartPole, Equations, Planar, Robot, Spatial, TABLE_I};
use nalgebra::SVector;
use shapebot_planner::motion::Line;
use shapebot_planner::{Refinement, Task, Workspace, refine};
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
    let (mut inside, mut all, mut counts) = (0.0, 0.0, [0.0; 2]);
    for row in plan.rows(&robot, 10).expect("rows") {
        let square = row.output_error().dot(&row.output_error());
        all += square;
        counts[1] += 1.0;
        if (0.0..=5.0).contains(&row.plan.time) {
            inside += square;
            counts[0] += 1.0;
        }
    }
    let [inside, all] = [(inside / counts[0] as f64).sqrt(), (all / counts[1] as f64).sqrt()];
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
