//! How much each robot stands: random runs, and where falls begin.

use super::{Finished, bar, unbroken};
use crate::commands::plan::task;
use crate::failure::Outcome;
use crate::output::{Align, Columns, number};
use crate::robot::identity;
use rayon::prelude::*;
use shapebot_experiments::{OnsetOf, Planned, Shard, Summary};
use shapebot_report::{Row, Table};
use shapebot_tasks::Method;
use shapebot_tasks::simulation::Law;
use std::io::{self, Write};

const TITLE: &str = "What the robots stand";

const NOTE: &str = "\
One task of each robot, by its refined plan. Random runs: everything uncertain together, as `shapebot \
robustness` draws it, and the error against the plan that 99 % of them keep (m). Below, each disturbance \
alone: the largest size that the robot stood and the smallest that made it fall, if one was found.";

const HEAD: [(&str, Align); 5] = [
    ("task", Align::Left),
    ("disturbance", Align::Left),
    ("stands", Align::Right),
    ("falls", Align::Right),
    ("", Align::Left),
];

/// Random runs of each task.
const RUNS: u64 = 100;

/// What was found for a task.
pub(super) struct Standing {
    name: &'static str,
    /// The run that the report shows of it.
    run: usize,
    summary: Summary,
    onsets: Vec<OnsetOf>,
}

/// Tries the last task of each robot in the list.
pub(super) fn try_all(finished: &[Finished]) -> Outcome<Vec<Standing>> {
    let tasks = last_of_each(finished);
    let progress = bar(tasks.len() as u64 * RUNS, "random runs");
    let found = tasks.into_par_iter().map(|run| try_one(finished[run].name, run, &progress));
    let found = found.collect();
    progress.finish_and_clear();
    found
}

/// The last run by a refined plan of each robot, in the order of the list.
fn last_of_each(finished: &[Finished]) -> Vec<usize> {
    let robot = |run: usize| finished[run].experiment.description.name;
    let planned = |run: &usize| {
        let experiment = &finished[*run].experiment;
        experiment.law == Law::Planned && experiment.method == Method::Refined
    };
    let runs: Vec<usize> = (0..finished.len()).filter(planned).collect();
    let last =
        |(i, run): &(usize, &usize)| !runs[i + 1..].iter().any(|&r| robot(r) == robot(**run));
    runs.iter().enumerate().filter(last).map(|(_, run)| *run).collect()
}

fn try_one(name: &'static str, run: usize, progress: &indicatif::ProgressBar) -> Outcome<Standing> {
    let (source, mut task) = task(name)?;
    task.method = Method::Refined;
    task.simulation.law = Law::Planned;
    let robot = source.dynamics(&[])?;
    let id = identity(robot.description(), &[]);
    let motion = robot.plan(&task, &id)?;
    let planned = Planned { task: &task, motion: &motion, id: &id };
    let trials = robot.trials((name, planned), [1, RUNS])?;
    let rows = trials.rows(Shard::WHOLE, &|| progress.inc(1))?;
    Ok(Standing { name, run, summary: Summary::of(&rows), onsets: trials.onsets(&|| ())? })
}

pub(super) fn write(to: &mut impl Write, found: &[Standing]) -> io::Result<()> {
    let mut columns = Columns::new(&HEAD);
    for (_, cells) in found.iter().flat_map(lines) {
        columns.push(cells);
    }
    writeln!(to, "{TITLE}\n")?;
    columns.write(to)?;
    writeln!(to, "\n{NOTE}")
}

/// The same for a report.
pub(super) fn report(found: &[Standing]) -> Table {
    let row = |(run, cells)| Row { cells: unbroken(cells), run };
    Table {
        title: TITLE.into(),
        note: NOTE.into(),
        columns: HEAD.iter().map(|(name, _)| (*name).to_owned()).collect(),
        rows: found.iter().flat_map(lines).map(row).collect(),
    }
}

fn lines(found: &Standing) -> Vec<(Option<usize>, Vec<String>)> {
    let Standing { name, run, summary, onsets } = found;
    let (falls, runs) = (summary.falls.len(), summary.runs);
    let error = summary.plan_rmse.map_or_else(String::new, |p| number::metres(p.p99));
    let random = vec![
        (*name).to_owned(),
        format!("{runs} random runs, error {error}"),
        (runs - falls).to_string(),
        falls.to_string(),
        "runs".to_owned(),
    ];
    let alone = onsets.iter().map(|OnsetOf { what, unit, stands, falls }| {
        let size = |size: &f64| number::significant(*size, 3);
        let falls = falls.as_ref().map_or_else(|| "-".to_owned(), size);
        let cells = [String::new(), what.replace('`', ""), size(stands), falls, (*unit).to_owned()];
        (None, cells.to_vec())
    });
    std::iter::once((Some(*run), random)).chain(alone).collect()
}
