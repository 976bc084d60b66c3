//! Time per plan over the number of samples, from 10² to 10⁵, for both planners: a table with the
//! straight line through it, a fixed part and a part per sample, and a plot in `target/growth.svg`.

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

/// Samples of the plans: 1, 2 and 5 per decade, and the first; between them counts whose number of
/// intervals is a prime.
const COUNTS: [usize; 14] =
    [101, 201, 501, 564, 1001, 1780, 2001, 5001, 5624, 10_001, 17_784, 20_001, 50_001, 100_001];

/// Seconds per call: the best of several, since whatever else runs can only add. Calls that outlast the
/// scheduler's slices are counted in processor time, where the system tells it.
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
    if best < 1e-3 {
        return best;
    }
    let calls = (0.3 / best).ceil();
    for _ in 0..3 {
        let start = processor_seconds();
        (0..calls as usize).for_each(|_| {
            black_box(plan());
        });
        if let (Some(start), Some(end)) = (start, processor_seconds()) {
            best = best.min((end - start) / calls);
        }
    }
    best
}

/// What this thread has run so far: on Linux, to a few milliseconds.
fn processor_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(text.split_whitespace().next()?.parse::<f64>().ok()? * 1e-9)
}

/// Seconds per plan and per sample whose sum is closest to the points, in proportion to each.
fn fit(points: &[(f64, f64)]) -> (f64, f64) {
    let (mut a, mut b, mut c, mut right) = (0.0, 0.0, 0.0, (0.0, 0.0));
    for &(count, time) in points {
        let (fixed, slope) = (1.0 / time, count / time);
        a += fixed * fixed;
        b += fixed * slope;
        c += slope * slope;
        right.0 += fixed;
        right.1 += slope;
    }
    let determinant = a * c - b * b;
    ((c * right.0 - b * right.1) / determinant, (a * right.1 - b * right.0) / determinant)
}

fn curve(name: &'static str, time: impl Fn(usize) -> f64) -> Curve {
    let points: Vec<_> = COUNTS.map(|count| (count as f64, time(count))).to_vec();
    Curve { name, fit: fit(&points), points }
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
        let (fixed, slope) = curve.fit;
        let line = |count: f64| fixed + slope * count;
        writeln!(out, "{}: {:.1} µs + {:.1} ns · samples", curve.name, fixed * 1e6, slope * 1e9)?;
        for &(count, seconds) in &curve.points {
            let off = (seconds / line(count) - 1.0) * 1e2;
            writeln!(out, "  {count:>7} samples  {:>10.4} ms  {off:>+5.0} %", seconds * 1e3)?;
        }
    }
    let target = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target");
    std::fs::create_dir_all(&target)?;
    let path = target.join("growth.svg");
    std::fs::write(&path, figure(&curves))?;
    writeln!(out, "wrote {}", path.display())
}
