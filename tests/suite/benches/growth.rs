//! Time per plan over the number of samples, from 10² to 10⁵, for both planners: a table, and a plot
//! in `target/growth.svg`.

#[path = "growth/figure.rs"]
mod figure;

use figure::{Curve, figure};
use shapebot_dynamics::nalgebra::Vector2;
use shapebot_generated::ballbot3d::Ballbot3d;
use shapebot_generated::ballbot3d_arms::Ballbot3dArms;
use shapebot_planner::motion::Line;
use shapebot_planner::{Refinement, Task, Weighting, Workspace, plan, refine};
use std::hint::black_box;
use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

/// Samples of the plans: 1, 2 and 5 per decade, and the first. Where samples less one have no small
/// divisor, the refined planner cannot thin its first sweeps and takes up to four times as long.
fn counts() -> Vec<usize> {
    let decades = [100, 1000, 10_000].into_iter().flat_map(|ten| [ten, 2 * ten, 5 * ten]);
    decades.chain([100_000]).map(|intervals| intervals + 1).collect()
}

/// Seconds per call: the best of several, since whatever else runs can only add.
fn seconds(mut plan: impl FnMut() -> f64) -> f64 {
    let mut best = f64::INFINITY;
    let begin = Instant::now();
    for round in 0..50 {
        let start = Instant::now();
        black_box(plan());
        best = best.min(start.elapsed().as_secs_f64());
        if round > 2 && begin.elapsed().as_secs_f64() > 0.3 {
            break;
        }
    }
    best
}

/// Slope of the straight line through logarithms: 1 is linear.
fn exponent(curve: &Curve) -> f64 {
    let points: Vec<(f64, f64)> = curve.points.iter().map(|(n, t)| (n.ln(), t.ln())).collect();
    let count = points.len() as f64;
    let (sum_x, sum_y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0, y + point.1));
    let (x, y) = (sum_x / count, sum_y / count);
    let slope = |(a, b), point: &(f64, f64)| {
        let dx = point.0 - x;
        (a + dx * (point.1 - y), b + dx * dx)
    };
    let (above, below) = points.iter().fold((0.0, 0.0), slope);
    above / below
}

fn curve(name: &'static str, time: impl Fn(usize) -> f64) -> Curve {
    Curve { name, points: counts().into_iter().map(|count| (count as f64, time(count))).collect() }
}

fn curves() -> Vec<Curve> {
    let (robot, arms) = (Ballbot3d::<f64>::from_model(), Ballbot3dArms::<f64>::from_model());
    let line = Line::new(Vector2::zeros(), Vector2::new(2.0, 0.0), 5.0, 9).expect("a line");
    let leaning = Weighting::<f64, 6>::Contributions(&[0.0, 0.0, 1.0]);
    let task = |count| Task::<_, f64, 2>::new(&line, count);
    let with_arms = |count| Task::new(&line, count).weighting(leaning);
    vec![
        curve("ballbot3d, gain", |count| {
            seconds(|| plan(&robot, &task(count)).expect("a plan").report().output_rmse)
        }),
        curve("ballbot3d, refined", |count| {
            let mut workspace = Workspace::<f64, 2, 64>::new();
            let refinement = Refinement::default();
            seconds(|| {
                refine(&robot, &task(count), &refinement, &mut workspace)
                    .expect("a plan")
                    .report()
                    .output_rmse
            })
        }),
        curve("ballbot3d_arms, gain", |count| {
            seconds(|| plan(&arms, &with_arms(count)).expect("a plan").report().output_rmse)
        }),
        curve("ballbot3d_arms, refined", |count| {
            let mut workspace = Workspace::<f64, 2, 64>::new();
            let refinement = Refinement::default();
            let task = with_arms(count);
            seconds(|| {
                refine(&arms, &task, &refinement, &mut workspace)
                    .expect("a plan")
                    .report()
                    .output_rmse
            })
        }),
    ]
}

fn main() -> io::Result<()> {
    // `cargo test --benches` only wants to know that it runs.
    if std::env::args().any(|argument| argument == "--test") {
        return Ok(());
    }
    let curves = curves();
    let mut out = io::stdout().lock();
    for curve in &curves {
        writeln!(out, "{}: time grows with samples^{:.2}", curve.name, exponent(curve))?;
        for (count, seconds) in &curve.points {
            writeln!(out, "  {count:>7} samples  {:>10.3} ms", seconds * 1e3)?;
        }
    }
    let target = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target");
    std::fs::create_dir_all(&target)?;
    let path = target.join("growth.svg");
    std::fs::write(&path, figure(&curves))?;
    writeln!(out, "wrote {}", path.display())
}
