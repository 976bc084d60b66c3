//! `shapebot inspect`: what a plan file holds, and the same in another form.

mod table;

use crate::args::{InspectArgs, PlanForm};
use crate::failure::{Failure, Outcome};
use crate::output::{self, number};
use crate::robot::{self, Bundled, Dynamics, Source, bundled, identity};
use shapebot_dynamics::Description;
use shapebot_planner::value::{FileError, RobotId};
use std::io::Write;
use std::path::Path;
use table::{Form, PlanTable};

/// A longer file is no plan: a million rows of fifty numbers.
const LONGEST_FILE: u64 = 1 << 30;

pub(crate) fn run(args: &InspectArgs) -> Outcome {
    let place = args.file.display().to_string();
    let content = read(&args.file)?;
    let mut plan = PlanTable::read(&content).map_err(|e| refusal(&e).at(&place))?;
    let robot = robot(args, &plan.robot)?;
    if let Some(robot) = &robot {
        let id = identity(robot.description(), &args.parameters.values);
        let found = RobotId::check(&id, &plan.id());
        found.map_err(|error| other_robot(&plan.robot, &id, error).at(&place))?;
        plan.name_columns(robot.description());
    }
    let description = robot.as_ref().map(|robot| robot.description());
    let mut stdout = anstream::stdout().lock();
    let bold = anstyle::Style::new().bold();
    writeln!(stdout, "{bold}{place}{bold:#}")?;
    let lines = summary(&plan, description);
    let width = lines.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    for (name, value) in lines {
        writeln!(stdout, "  {name:<width$}  {value}")?;
    }
    if let Some(path) = &args.output {
        let form = form(path, args.format)?;
        let converted = plan.convert(&content, form, description)?;
        output::write_file(path, converted)?;
        writeln!(stdout, "wrote {}", path.display())?;
    }
    Ok(())
}

fn refusal(error: &FileError) -> Failure {
    Failure::refused(match error {
        FileError::NotAPlan => format!("{error}; `shapebot plan -o DIR` writes plan files"),
        _ => error.to_string(),
    })
}

fn read(path: &Path) -> Outcome<Vec<u8>> {
    let failure = |error| Failure::file("read", path, &error);
    if std::fs::metadata(path).map_err(failure)?.len() > LONGEST_FILE {
        return Err(Failure::usage(format!("{} is too long for a plan", path.display())));
    }
    std::fs::read(path).map_err(failure)
}

/// The robot that the user names, or the bundled one of the plan's name.
fn robot(args: &InspectArgs, name: &str) -> Outcome<Option<Box<dyn Dynamics>>> {
    let source = match &args.robot {
        Some(named) => Some(robot::open(named)?),
        None => bundled().find(|robot| Bundled::name(robot) == name).map(Source::Bundled),
    };
    match source {
        Some(source) => source.dynamics(&args.parameters.values).map(Some),
        None if args.parameters.values.is_empty() => Ok(None),
        None => Err(Failure::usage("--param is for a robot: give --robot")),
    }
}

fn other_robot(name: &str, id: &RobotId<'_>, error: impl std::fmt::Display) -> Failure {
    Failure::refused(if id.name() == name {
        format!("{error}; --param sets parameters")
    } else {
        format!("{error}; the plan is for `{name}`, the robot is `{}`", id.name())
    })
}

fn form(path: &Path, given: Option<PlanForm>) -> Outcome<Form> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    match (given, ending) {
        (Some(PlanForm::Csv), _) | (None, "csv") => Ok(Form::Csv),
        (Some(PlanForm::Json), _) | (None, "json") => Ok(Form::Json),
        (Some(PlanForm::Plan), _) | (None, "plan") => Ok(Form::Binary),
        (None, _) => Err(Failure::usage(format!(
            "{} ends in none of .csv, .json and .plan: --format says which form it is to have",
            path.display()
        ))),
    }
}

/// Names and values.
fn summary(plan: &PlanTable<'_>, robot: Option<&Description>) -> Vec<(String, String)> {
    let line = |name: &str, value: String| (name.to_owned(), value);
    let checked = match robot {
        Some(_) => "as the robot's parameters say",
        None => "not checked: --robot FILE says which robot to check it with",
    };
    let (first, last) = (plan.time(0), plan.time(plan.rows.len().saturating_sub(1)));
    let mut lines = vec![
        line("form", format!("{}, whole and unaltered", plan.form.word())),
        line("robot", plan.robot.clone()),
        line("fingerprint", format!("{:08x}, {checked}", plan.fingerprint)),
        line("samples", plan.rows.len().to_string()),
        line("time", format!("{first} s to {} s", number::significant(last, 6))),
    ];
    let Some(robot) = robot else {
        return lines;
    };
    for coordinate in robot.position_coordinates() {
        if let Some(end) = plan.column(coordinate.name).and_then(|values| values.last().copied()) {
            lines.push(line(
                &format!("{} at end", coordinate.name),
                format!("{} {}", number::significant(end, 5), coordinate.unit),
            ));
        }
    }
    for coordinate in robot.shape_coordinates() {
        if let Some(peak) = plan.column(coordinate.name).map(|values| peak(&values)) {
            let (unit, [text]) = number::shown(coordinate.unit, [peak]);
            lines.push(line(&format!("peak {}", coordinate.name), format!("{text} {unit}")));
        }
    }
    for coordinate in robot.coordinates.iter().filter(|coordinate| coordinate.actuated) {
        let name = format!("{}{}", table::FORCE, coordinate.name);
        let unit = if coordinate.unit == "rad" { "N*m" } else { "N" };
        if let Some(peak) = plan.column(&name).map(|values| peak(&values)) {
            lines
                .push((format!("peak {name}"), format!("{} {unit}", number::significant(peak, 4))));
        }
    }
    lines
}

fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |peak, value| peak.max(value.abs()))
}
