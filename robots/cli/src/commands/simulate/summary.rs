//! A run in words and numbers.

use crate::output::{method, number};
use shapebot_dynamics::Coordinate;
use shapebot_experiments::Experiment;
use shapebot_tasks::simulation::{Law, Paper};
use std::io::{self, Write};

/// Names, ours, the paper's.
type Line = (String, String, Option<String>);

pub(crate) fn write_summary(
    to: &mut impl Write,
    experiment: &Experiment,
    paper: &Paper,
) -> io::Result<()> {
    let bold = anstyle::Style::new().bold();
    let title = match experiment.title.as_str() {
        "" => experiment.description.name,
        title => title,
    };
    writeln!(to, "{bold}{title}{bold:#}")?;
    let mut lines = lines(experiment, paper);
    lines.extend(regulator(experiment));
    let width = lines.iter().map(|(name, ..)| name.chars().count()).max().unwrap_or(0);
    for (name, ours, theirs) in &lines {
        let theirs = theirs.as_ref().map_or(String::new(), |value| format!("   (paper {value})"));
        writeln!(to, "  {name:<width$}  {ours}{theirs}")?;
    }
    Ok(())
}

fn lines(experiment: &Experiment, paper: &Paper) -> Vec<Line> {
    let (errors, robot) = (&experiment.errors, &experiment.description);
    let unit = robot.output_unit;
    let length = |value: f64| format!("{} {unit}", number::metres(value));
    let mut lines: Vec<Line> = Vec::new();
    let mut say = |name: &str, ours: String, theirs: Option<String>| {
        lines.push((name.to_owned(), ours, theirs));
    };
    say("loop", loop_name(experiment), None);
    if let Some(fall) = &experiment.fell {
        let (at, value) = (fall.time, number::significant(fall.value, 3));
        say("fell", format!("at {at:.2} s, `{}` was {value}", fall.coordinate), None);
    }
    say("RMSE against plan", length(errors.plan_rmse), paper.rmse.map(length));
    say("RMSE against desired", length(errors.desired_rmse), None);
    say("RMSE of plan against desired", length(experiment.plan_rmse), None);
    say("largest error against plan", length(errors.plan_max), paper.largest.map(length));
    say("error at the plan's end", length(errors.goal), None);
    say("error at the run's end", length(errors.end), None);
    for set in robot.shape_sets {
        let Some(first) = robot.shape_coordinates().get(set.first) else { continue };
        let theirs = paper.compensation.iter().find(|(name, _)| name.value == set.name);
        let ours = experiment.compensation_of(set.name).unwrap_or_default();
        let theirs = theirs.map(|(_, value)| angle_or(first, *value));
        say(&format!("compensation by {}", set.name), angle_or(first, ours), theirs);
    }
    for (coordinate, error) in robot.shape_coordinates().iter().zip(&errors.shape) {
        say(&format!("largest error of {}", coordinate.name), angle_or(coordinate, *error), None);
    }
    for (actuator, peak) in robot.actuators.iter().zip(&errors.force) {
        let text = format!("{} {}", number::significant(*peak, 4), actuator.unit);
        say(&format!("peak {}", actuator.name), text, None);
    }
    if errors.saturated > 0.0 {
        say("at a limit", format!("{:.1} % of the time", 100.0 * errors.saturated), None);
    }
    lines
}

/// An angle in degrees, anything else in its unit.
fn angle_or(coordinate: &Coordinate, value: f64) -> String {
    let (unit, value) = match coordinate.unit {
        "rad" => ("deg", value.to_degrees()),
        other => (other, value),
    };
    format!("{} {unit}", number::significant(value, 3))
}

fn loop_name(experiment: &Experiment) -> String {
    match experiment.law {
        Law::Planned => format!("{} plan, control law", method(experiment.method)),
        Law::Regulator => "linear-quadratic regulator on the desired motion".to_owned(),
    }
}

fn regulator(experiment: &Experiment) -> Vec<Line> {
    let rows = experiment.regulator.iter().flatten().zip(experiment.description.actuators);
    let line = |(row, actuator): (&Vec<f64>, &shapebot_dynamics::Actuator)| {
        let row = row.iter().map(|&k| number::significant(k + 0.0, 4)).collect::<Vec<_>>();
        (format!("K {}", actuator.name), row.join("  "), None)
    };
    rows.map(line).collect()
}
