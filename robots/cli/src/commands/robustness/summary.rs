//! What random runs say together.

use crate::output::{Align, Columns, number};
use shapebot_experiments::{OnsetOf, Percentiles, Row, Summary};
use std::io::{self, Write};

pub(super) fn write(to: &mut impl Write, rows: &[Row]) -> io::Result<()> {
    let summary = Summary::of(rows);
    let bold = anstyle::Style::new().bold();
    if let Some(Row { identity, .. }) = rows.first() {
        let (task, method, seed) = (&identity.task, &identity.method, identity.seed);
        writeln!(to, "{bold}{task}, {method} plan, seed {seed}{bold:#}")?;
    }
    let falls = summary.falls.len();
    writeln!(to, "{} runs, {falls} {}", summary.runs, if falls == 1 { "fall" } else { "falls" })?;
    if falls > 0 {
        writeln!(to, "fell: {}", list(&summary.falls))?;
    }
    let mut columns = Columns::new(&[
        ("", Align::Left),
        ("median", Align::Right),
        ("90 %", Align::Right),
        ("99 %", Align::Right),
        ("largest", Align::Right),
    ]);
    let mut push = |name: &str, found: Option<Percentiles>| {
        let Some(Percentiles { median, p90, p99, largest }) = found else { return };
        let values = [median, p90, p99, largest].map(number::metres);
        columns.push([name.to_owned()].into_iter().chain(values).collect());
    };
    push("RMSE against plan", summary.plan_rmse);
    push("error at the end", summary.end_error);
    columns.write(to)?;
    writeln!(to, "worst: {}   (--replay RUN makes one of them again)", list(&summary.worst))
}

/// At most a dozen.
fn list(runs: &[u64]) -> String {
    let mut texts: Vec<String> = runs.iter().take(12).map(u64::to_string).collect();
    if runs.len() > texts.len() {
        texts.push("...".to_owned());
    }
    texts.join(", ")
}

pub(super) fn write_onsets(to: &mut impl Write, onsets: &[OnsetOf]) -> io::Result<()> {
    let mut columns = Columns::new(&[
        ("alone", Align::Left),
        ("stands up to", Align::Right),
        ("falls from", Align::Right),
        ("", Align::Left),
    ]);
    for OnsetOf { what, unit, stands, falls } in onsets {
        let falls = falls.map_or_else(|| "-".to_owned(), |size| number::significant(size, 3));
        let stands = number::significant(*stands, 3);
        columns.push(vec![what.clone(), stands, falls, (*unit).to_owned()]);
    }
    writeln!(to)?;
    columns.write(to)
}
