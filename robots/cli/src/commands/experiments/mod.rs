//! `shapebot experiments`: all bundled experiments by both planners, in parallel.

pub(crate) mod report;
mod standing;
mod table;

use super::plan::task;
use super::simulate::simulate;
use super::table as table_two;
use crate::failure::Outcome;
use crate::robot::Source;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use report::Pages;
use shapebot_experiments::Experiment;
use shapebot_report::Table;
use shapebot_tasks::simulation::Law;
use shapebot_tasks::{Method, TASKS, Task};
use std::io::Write;
use std::path::Path;
use std::time::Duration;

/// Name of the report in its folder.
const REPORT: &str = "report.html";

/// A run of the list.
pub(crate) struct Finished {
    /// The task's name.
    pub(crate) name: &'static str,
    pub(crate) task: Task,
    pub(crate) experiment: Experiment,
}

/// Simulates all experiments and writes the report.
pub(crate) fn run(folder: &Path) -> Outcome {
    let finished = simulated()?;
    finish(folder, &finished, None)
}

/// Plans Table II and simulates all experiments.
pub(crate) fn everything(folder: &Path) -> Outcome {
    let planning = table_two::run(folder)?;
    writeln!(anstream::stdout().lock())?;
    let finished = simulated()?;
    finish(folder, &finished, Some(planning))
}

/// Tries what the robots stand, writes the report, and prints.
fn finish(folder: &Path, finished: &[Finished], planning: Option<Table>) -> Outcome {
    let standing = standing::try_all(finished)?;
    let mut pages = Pages::default();
    pages.add_table(table::report(finished));
    planning.into_iter().for_each(|table| pages.add_table(table));
    pages.add_table(standing::report(&standing));
    for done in finished {
        let (source, _) = task(done.name)?;
        if !pages.has_robot(done.experiment.description.name) {
            pages.add_robot(&source, &*source.dynamics(&[])?)?;
        }
        pages.add_run(&done.experiment, &done.task.paper);
    }
    let path = folder.join(REPORT);
    pages.write(&path)?;
    let mut stdout = anstream::stdout().lock();
    table::write(&mut stdout, finished)?;
    writeln!(stdout)?;
    standing::write(&mut stdout, &standing)?;
    Ok(writeln!(stdout, "\nreport: {}", path.display())?)
}

/// Runs of a task: by both planners, and by the regulator if the task has one.
fn variants((name, text): &(&'static str, &str)) -> Outcome<Vec<(&'static str, Source, Task)>> {
    // Tasks that say nothing about a simulation are for planning.
    if !text.contains("[simulation]") {
        return Ok(Vec::new());
    }
    let mut variants = Vec::new();
    let (_, own) = task(name)?;
    let regulator = (own.simulation.law == Law::Regulator)
        .then_some((Law::Regulator, Method::Refined))
        .into_iter();
    let planned = [(Law::Planned, Method::Gain), (Law::Planned, Method::Refined)];
    for (law, method) in regulator.chain(planned) {
        let (source, mut task) = task(name)?;
        task.method = method;
        task.simulation.law = law;
        variants.push((*name, source, task));
    }
    Ok(variants)
}

/// The paper's experiments in its order, then the others.
fn place(task: &Task) -> u32 {
    let figure = task.paper.figure.as_deref().unwrap_or_default();
    let digits = figure.trim_start_matches(|c: char| !c.is_ascii_digit());
    let end = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
    digits[..end].parse().unwrap_or(u32::MAX)
}

fn simulated() -> Outcome<Vec<Finished>> {
    let jobs = TASKS.iter().map(variants).collect::<Outcome<Vec<_>>>()?;
    let mut jobs: Vec<_> = jobs.into_iter().flatten().collect();
    jobs.sort_by_key(|(_, _, task)| place(task));
    let bar = bar(jobs.len() as u64, "experiments");
    let finished = jobs.into_par_iter().map(|(name, source, task)| {
        let robot = source.dynamics(&[])?;
        let (_, experiment) = simulate(&*robot, &task, &[])?;
        bar.inc(1);
        Ok(Finished { name, task, experiment })
    });
    let finished = finished.collect::<Outcome<Vec<_>>>();
    bar.finish_and_clear();
    finished
}

/// Cells of a report, in which numbers stay beside their units.
pub(crate) fn unbroken(cells: Vec<String>) -> Vec<String> {
    cells.into_iter().map(|cell| cell.replace(' ', "\u{a0}")).collect()
}

/// Progress with the time left; on standard error, and nowhere if that is no terminal.
pub(crate) fn bar(count: u64, what: &'static str) -> ProgressBar {
    let bar = ProgressBar::new(count).with_message(what);
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} {msg}, {eta} left") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
