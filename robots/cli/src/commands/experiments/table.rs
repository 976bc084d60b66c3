//! The table of closed loops.

use super::{Finished, unbroken};
use crate::output::{Align, Columns, number};
use shapebot_experiments::Experiment;
use shapebot_report::{Row, Table};
use shapebot_tasks::Method;
use shapebot_tasks::simulation::{Law, Paper};
use std::io::{self, Write};

const TITLE: &str = "Closed loops";

const NOTE: &str = "\
Errors of the output, root of the mean square over the plan's time, in its unit (m). plan: of the plan \
against the desired motion; loop: of the robot against its plan; desired: of the robot against the \
desired motion. largest: robot against plan. Compensation: largest, in degrees. In brackets: the paper's, \
with its real robot.";

const HEAD: [(&str, Align); 9] = [
    ("experiment", Align::Left),
    ("by", Align::Left),
    ("plan", Align::Right),
    ("loop", Align::Right),
    ("desired", Align::Right),
    ("largest", Align::Right),
    ("end", Align::Right),
    ("compensation: body", Align::Right),
    ("joints", Align::Right),
];

pub(super) fn write(to: &mut impl Write, finished: &[Finished]) -> io::Result<()> {
    let mut columns = Columns::new(&HEAD);
    let mut before = "";
    for done in finished {
        let mut cells = cells(done);
        if done.name == before {
            cells[0].clear();
        }
        before = done.name;
        columns.push(cells);
    }
    writeln!(to, "{TITLE}\n")?;
    columns.write(to)?;
    writeln!(to, "\n{NOTE}")
}

/// The same for a report; runs in the order of the list.
pub(super) fn report(finished: &[Finished]) -> Table {
    let row =
        |(run, done): (usize, &Finished)| Row { cells: unbroken(cells(done)), run: Some(run) };
    Table {
        title: TITLE.into(),
        note: NOTE.into(),
        columns: HEAD.iter().map(|(name, _)| (*name).to_owned()).collect(),
        rows: finished.iter().enumerate().map(row).collect(),
    }
}

fn cells(done: &Finished) -> Vec<String> {
    let Finished { name, task, experiment } = done;
    let (errors, paper) = (&experiment.errors, &task.paper);
    let by = match (experiment.law, experiment.method) {
        (Law::Regulator, _) => "LQR",
        (_, Method::Gain) => "gain",
        (_, Method::Refined) => "refined",
    };
    let of_plan = experiment.law == Law::Planned;
    let if_planned = |text: String| if of_plan { text } else { "-".to_owned() };
    let end = match &experiment.fell {
        Some(fall) => format!("fell at {:.1} s", fall.time),
        None => number::metres(errors.end),
    };
    vec![
        (*name).to_owned(),
        by.to_owned(),
        if_planned(number::metres(experiment.plan_rmse)),
        if_planned(beside(number::metres(errors.plan_rmse), paper.rmse.map(number::metres))),
        number::metres(errors.desired_rmse),
        if_planned(beside(number::metres(errors.plan_max), paper.largest.map(number::metres))),
        end,
        if_planned(compensation(experiment, paper, false)),
        if_planned(compensation(experiment, paper, true)),
    ]
}

fn beside(ours: String, paper: Option<String>) -> String {
    paper.map_or(ours.clone(), |paper| format!("{ours} ({paper})"))
}

/// Largest compensation of the actuated or unactuated shape sets, degrees.
fn compensation(experiment: &Experiment, paper: &Paper, actuated: bool) -> String {
    let sets = || experiment.description.shape_sets.iter().filter(|set| set.actuated == actuated);
    if sets().next().is_none() {
        return "-".to_owned();
    }
    let ours = sets().filter_map(|set| experiment.compensation_of(set.name)).fold(0.0, f64::max);
    let theirs = paper.compensation.iter().filter(|(name, _)| sets().any(|s| s.name == name.value));
    let theirs = theirs.map(|(_, value)| *value).reduce(f64::max);
    let degrees = |value: f64| match value.to_degrees() {
        tiny if tiny.abs() < 5e-4 => "0".to_owned(),
        value => number::significant(value, 2),
    };
    beside(degrees(ours), theirs.map(degrees))
}
