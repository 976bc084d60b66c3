//! `shapebot table`: the task of Table II for the paper's four systems.

use super::experiments::unbroken;
use super::plan::task;
use crate::failure::Outcome;
use crate::output::{self, Align, Columns, number};
use crate::plot;
use crate::robot::{bundled, identity};
use indicatif::{ProgressBar, ProgressStyle};
use shapebot_planning::PlannedMotion;
use shapebot_report::{Row, Table};
use shapebot_tasks::Method;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A line of Table II: the system, and what the paper reports for it.
struct Line {
    /// Bundled robot.
    robot: &'static str,
    /// Bundled task.
    task: &'static str,
    /// The paper's planner: seconds, RMSE in metres.
    paper: (f64, f64),
    /// The paper's run of PROPT: seconds, RMSE in metres.
    propt: (f64, f64),
}

const TABLE: [Line; 4] = [
    Line {
        robot: "cartpole_planar",
        task: "table2_cartpole",
        paper: (0.482, 0.0211),
        propt: (27.581, 0.1143),
    },
    Line {
        robot: "ballbot_planar",
        task: "table2_ballbot_planar",
        paper: (0.485, 0.0391),
        propt: (20.729, 0.1154),
    },
    Line {
        robot: "ballbot3d",
        task: "table2_ballbot3d",
        paper: (0.991, 0.0478),
        propt: (27.362, 0.1159),
    },
    Line {
        robot: "ballbot3d_arms",
        task: "table2_ballbot3d_arms",
        paper: (13.318, 0.0462),
        propt: (955.6529, 0.1148),
    },
];

const HEAD: &str = "Table II: 2 m in 5 s, degree 9, 501 samples; RMSE in metres";

const NOTE: &str = "\
gain: Algorithm 1. refined: the shape trajectory is a spline. floor: no plan at rest at both ends of
the 5 s has a smaller RMSE, as the robot cannot lean before its time (linearised). standing: refined,
with 1 s before and after, RMSE over all 7 s.
Times are those of the planner alone, on this machine; the paper's are MATLAB on a Core2 Duo.
The paper's RMSE of the ballbots do not follow from the parameters of its Table I: with these, the
planar and the 3D ballbot are the same system along an axis and have the same error.";

const COLUMNS: [(&str, Align); 13] = [
    ("system", Align::Left),
    ("states", Align::Right),
    ("gain: time", Align::Right),
    ("RMSE", Align::Right),
    ("refined: time", Align::Right),
    ("RMSE", Align::Right),
    ("floor", Align::Right),
    ("standing: time", Align::Right),
    ("RMSE", Align::Right),
    ("paper: time", Align::Right),
    ("RMSE", Align::Right),
    ("PROPT: time", Align::Right),
    ("RMSE", Align::Right),
];

/// Standing before and after the motion in the last plan, seconds.
const STANDING: f64 = 1.0;

/// The plans of a row.
struct Plans {
    gain: PlannedMotion,
    refined: PlannedMotion,
    standing: PlannedMotion,
}

/// Plans, prints and writes; the table for a report is returned.
pub(crate) fn run(folder: &Path) -> Outcome<Table> {
    let progress = progress();
    let mut planned = Vec::new();
    for row in &TABLE {
        progress.set_message(row.robot);
        planned.push(plan(row)?);
        progress.inc(1);
    }
    progress.finish_and_clear();
    let mut files = Vec::new();
    for plans in planned.iter().flatten() {
        let name = plans.gain.description.name;
        files.extend(write_files(folder, name, &plans.gain)?);
        files.extend(write_files(folder, &format!("{name}_refined"), &plans.refined)?);
    }
    write_table(&planned)?;
    let mut stdout = anstream::stdout().lock();
    writeln!(stdout, "\n{NOTE}\n")?;
    for path in files {
        writeln!(stdout, "wrote {}", path.display())?;
    }
    Ok(report(&planned))
}

/// The table for a report.
fn report(planned: &[Option<Plans>]) -> Table {
    let rows = TABLE.iter().zip(planned);
    Table {
        title: HEAD.into(),
        note: NOTE.into(),
        columns: COLUMNS.iter().map(|(name, _)| (*name).to_owned()).collect(),
        rows: rows
            .map(|(row, plans)| Row { cells: unbroken(cells(row, plans.as_ref())), run: None })
            .collect(),
    }
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

/// The plans of a row; nothing if its robot is not bundled.
fn plan(row: &Line) -> Outcome<Option<Plans>> {
    if !bundled().any(|robot| robot.name() == row.robot) {
        return Ok(None);
    }
    let (robot, mut task) = task(row.task)?;
    let robot = robot.dynamics(&[])?;
    let id = identity(robot.description(), &[]);
    task.method = Method::Gain;
    let gain = robot.plan(&task, &id)?;
    task.method = Method::Refined;
    let refined = robot.plan(&task, &id)?;
    task.standing.value = [STANDING; 2];
    let standing = robot.plan(&task, &id)?;
    Ok(Some(Plans { gain, refined, standing }))
}

fn write_files(folder: &Path, name: &str, motion: &PlannedMotion) -> Outcome<[PathBuf; 2]> {
    let [csv, svg] = ["csv", "svg"].map(|extension| folder.join(format!("{name}.{extension}")));
    output::write_file(&csv, output::csv(motion))?;
    let title =
        format!("{}: 2 m in 5 s, {}", motion.description.name, output::method(motion.method));
    output::write_file(&svg, plot::motion_figure(motion, &title).svg())?;
    Ok([csv, svg])
}

fn write_table(planned: &[Option<Plans>]) -> Outcome {
    let mut columns = Columns::new(&COLUMNS);
    for (row, plans) in TABLE.iter().zip(planned) {
        columns.push(cells(row, plans.as_ref()));
    }
    let mut stdout = anstream::stdout().lock();
    writeln!(stdout, "{HEAD}\n")?;
    columns.write(&mut stdout)?;
    writeln!(stdout, "\nhow the optimisers ended")?;
    let width = TABLE.iter().map(|row| row.robot.len()).max().unwrap_or(0);
    for (row, plans) in TABLE.iter().zip(planned) {
        let Some(Plans { gain, refined, standing }) = plans else {
            writeln!(stdout, "{} is not bundled", row.robot)?;
            continue;
        };
        let ends = [("gain", gain), ("refined", refined), ("standing", standing)]
            .map(|(name, plan)| format!("{name} {}", plan.termination()));
        writeln!(stdout, "{:<width$}  {}", row.robot, ends.join("; "))?;
    }
    Ok(())
}

fn cells(row: &Line, plans: Option<&Plans>) -> Vec<String> {
    let none = || "-".to_owned();
    let of = |cell: &dyn Fn(&Plans) -> String| plans.map_or_else(none, cell);
    vec![
        row.robot.to_owned(),
        of(&|plans| (2 * plans.gain.description.coordinates.len()).to_string()),
        of(&|plans| number::duration(plans.gain.elapsed)),
        of(&|plans| number::metres(plans.gain.output_rmse)),
        of(&|plans| number::duration(plans.refined.elapsed)),
        of(&|plans| number::metres(plans.refined.output_rmse)),
        of(&|plans| plans.refined.floor.map_or_else(|_| none(), |floor| format!("{floor:.5}"))),
        of(&|plans| number::duration(plans.standing.elapsed)),
        of(&|plans| number::metres(plans.standing.output_rmse)),
        format!("{:.3} s", row.paper.0),
        format!("{:.4}", row.paper.1),
        format!("{:.1} s", row.propt.0),
        format!("{:.4}", row.propt.1),
    ]
}
