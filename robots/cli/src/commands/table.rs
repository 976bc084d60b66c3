//! `shapebot` alone: the task of Table II for the paper's four systems.

use crate::failure::Outcome;
use crate::output::{self, Align, Columns, number};
use crate::planning::{Path as MotionPath, PlanTask, PlannedMotion, termination};
use crate::plot;
use crate::robot::bundled;
use indicatif::{ProgressBar, ProgressStyle};
use shapebot_planner::Objective;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A row of Table II: the system, and what the paper reports for it.
struct Row {
    /// Bundled robot.
    robot: &'static str,
    /// Contributions of its shape sets.
    weights: &'static [(&'static str, f64)],
    /// The paper's planner: seconds, RMSE in metres.
    paper: (f64, f64),
    /// The paper's run of PROPT: seconds, RMSE in metres.
    propt: (f64, f64),
}

const TABLE: [Row; 4] = [
    Row { robot: "cartpole_planar", weights: &[], paper: (0.482, 0.0211), propt: (27.581, 0.1143) },
    Row { robot: "ballbot_planar", weights: &[], paper: (0.485, 0.0391), propt: (20.729, 0.1154) },
    Row { robot: "ballbot3d", weights: &[], paper: (0.991, 0.0478), propt: (27.362, 0.1159) },
    Row {
        robot: "ballbot3d_arms",
        weights: &[("phi", 1.0)],
        paper: (13.318, 0.0462),
        propt: (955.6529, 0.1148),
    },
];

/// Metres along the first axis of the output.
const DISTANCE: f64 = 2.0;
/// Seconds.
const DURATION: f64 = 5.0;
/// Degree of the timing polynomial.
const DEGREE: usize = 9;
const SAMPLES: usize = 501;

const NOTE: &str = "\
Times are those of the planner alone, on this machine; the paper's are MATLAB on a Core2 Duo.
The paper's RMSE of the ballbots do not follow from the parameters of its Table I: with these, the
planar and the 3D ballbot are the same system along an axis and have the same error.";

pub(crate) fn run(folder: &Path) -> Outcome {
    let progress = progress();
    let mut planned = Vec::new();
    for row in &TABLE {
        progress.set_message(row.robot);
        planned.push(plan(row)?);
        progress.inc(1);
    }
    progress.finish_and_clear();
    let mut files = Vec::new();
    for motion in planned.iter().flatten() {
        files.extend(write_files(folder, motion)?);
    }
    write_table(&planned)?;
    let mut stdout = anstream::stdout().lock();
    writeln!(stdout, "\n{NOTE}\n")?;
    for path in files {
        writeln!(stdout, "wrote {}", path.display())?;
    }
    Ok(())
}

/// On standard error, and nowhere if that is no terminal.
fn progress() -> ProgressBar {
    let bar = ProgressBar::new(TABLE.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// The plan of a row; nothing if its robot is not bundled.
fn plan(row: &Row) -> Outcome<Option<PlannedMotion>> {
    let Some(robot) = bundled().find(|robot| robot.name() == row.robot) else {
        return Ok(None);
    };
    let robot = robot.dynamics(&[])?;
    let mut goal = vec![0.0; robot.sizes().position];
    if let Some(first) = goal.first_mut() {
        *first = DISTANCE;
    }
    let task = PlanTask {
        path: MotionPath::Line { goal, degree: DEGREE },
        duration: DURATION,
        samples: SAMPLES,
        weights: row.weights.iter().map(|&(set, weight)| (set.to_owned(), weight)).collect(),
        objective: Objective::Output,
    };
    robot.plan(&task).map(Some)
}

fn write_files(folder: &Path, motion: &PlannedMotion) -> Outcome<[PathBuf; 2]> {
    let name = motion.description.name;
    let [csv, svg] = ["csv", "svg"].map(|extension| folder.join(format!("{name}.{extension}")));
    output::write_file(&csv, &output::csv(motion))?;
    let title = format!("{name}: {DISTANCE} m in {DURATION} s");
    output::write_file(&svg, &plot::motion_figure(motion, &title).svg())?;
    Ok([csv, svg])
}

fn write_table(planned: &[Option<PlannedMotion>]) -> Outcome {
    let mut columns = Columns::new(&[
        ("system", Align::Left),
        ("states", Align::Right),
        ("time", Align::Right),
        ("RMSE [m]", Align::Right),
        ("paper: time", Align::Right),
        ("RMSE", Align::Right),
        ("PROPT: time", Align::Right),
        ("RMSE", Align::Right),
        ("optimiser", Align::Left),
    ]);
    for (row, motion) in TABLE.iter().zip(planned) {
        columns.push(cells(row, motion.as_ref()));
    }
    let mut stdout = anstream::stdout().lock();
    writeln!(
        stdout,
        "Table II: {DISTANCE} m in {DURATION} s, degree {DEGREE}, {SAMPLES} samples\n"
    )?;
    Ok(columns.write(&mut stdout)?)
}

fn cells(row: &Row, motion: Option<&PlannedMotion>) -> Vec<String> {
    let none = || "-".to_owned();
    let of = |cell: &dyn Fn(&PlannedMotion) -> String| motion.map_or_else(none, cell);
    vec![
        row.robot.to_owned(),
        of(&|motion| (2 * motion.description.coordinates.len()).to_string()),
        of(&|motion| number::duration(motion.elapsed)),
        of(&|motion| number::metres(motion.output_rmse)),
        format!("{:.3} s", row.paper.0),
        format!("{:.4}", row.paper.1),
        format!("{:.1} s", row.propt.0),
        format!("{:.4}", row.propt.1),
        motion
            .map_or("not bundled".to_owned(), |motion| termination(motion.termination).to_owned()),
    ]
}
