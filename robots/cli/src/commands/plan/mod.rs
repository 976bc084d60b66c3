//! `shapebot plan`: one motion of one robot.

mod request;

use crate::args::PlanArgs;
use crate::failure::Outcome;
use crate::output::{self, number};
use crate::plot;
use crate::robot::identity;
use request::Request;
use shapebot_dynamics::Coordinate;
use shapebot_planning::{Detail, Phase, PlannedMotion};
use shapebot_tasks::{Method, Motion, Task};
use std::io::{self, Write};
use std::path::Path;

pub(crate) use request::{NamedTask, open_task, task};

pub(crate) fn run(args: &PlanArgs) -> Outcome {
    let Request { name, robot, task } = request::request(args)?;
    let motion = robot.plan(&task, &identity(robot.description(), &args.parameters.values))?;
    let mut stdout = anstream::stdout().lock();
    let title = task.title.clone();
    let title = title
        .unwrap_or_else(|| format!("{}: {}", motion.description.name, describe(&task, &motion)));
    write_summary(&mut stdout, &title, &motion)?;
    let mut write = |path: &Path, text: &[u8]| -> Outcome {
        output::write_file(path, text)?;
        Ok(writeln!(stdout, "wrote {}", path.display())?)
    };
    if let Some(path) = &args.csv {
        write(path, output::csv(&motion).as_bytes())?;
    }
    if let Some(path) = &args.json {
        write(path, output::json(&motion).as_bytes())?;
    }
    let figure = || plot::motion_figure(&motion, &title).svg();
    if let Some(path) = &args.svg {
        write(path, figure().as_bytes())?;
    }
    if let Some(folder) = &args.output {
        let files = &motion.files;
        write(&folder.join(format!("{name}.csv")), files.csv.as_bytes())?;
        write(&folder.join(format!("{name}.json")), files.json.as_bytes())?;
        write(&folder.join(format!("{name}.plan")), &files.binary)?;
        write(&folder.join(format!("{name}.report.json")), output::report(&motion).as_bytes())?;
    }
    if args.plot {
        let folder = args.output.as_deref().unwrap_or(Path::new(""));
        write(&folder.join(format!("{name}.svg")), figure().as_bytes())?;
    }
    Ok(())
}

/// The task in words.
fn describe(task: &Task, motion: &PlannedMotion) -> String {
    let unit = motion.description.output_unit;
    let path = match &task.motion.value {
        Motion::Line { goal, degree, duration } => {
            let goal: Vec<String> = goal.value.values.iter().map(f64::to_string).collect();
            let goal =
                if goal.len() == 1 { goal.join("") } else { format!("({})", goal.join(", ")) };
            format!("line to {goal} {unit}, degree {degree}, {duration} s")
        }
        Motion::Bezier { points, duration } => {
            format!("Bézier curve, {} control points, {duration} s", points.len())
        }
        Motion::Waypoints(points) => format!("{} waypoints", points.len()),
        Motion::Rest { duration } => format!("standing for {duration} s"),
        Motion::Legs(legs) => format!("{} legs", legs.len()),
        Motion::TwoPhases { duration, .. } => format!("two phases, {duration} s"),
    };
    format!("{path}, {} samples", task.samples.value)
}

fn write_summary(to: &mut impl Write, title: &str, motion: &PlannedMotion) -> io::Result<()> {
    let bold = anstyle::Style::new().bold();
    writeln!(to, "{bold}{title}{bold:#}")?;
    let lines = summary(motion);
    let width = lines.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    lines.iter().try_for_each(|(name, value)| writeln!(to, "  {name:<width$}  {value}"))
}

/// Names and values.
fn summary(motion: &PlannedMotion) -> Vec<(String, String)> {
    let unit = motion.description.output_unit;
    let length = |name: &str, value| (name.to_owned(), format!("{} {unit}", number::metres(value)));
    let shape = motion.description.shape_coordinates();
    let mut lines = vec![("method".to_owned(), output::method(motion.method).to_owned())];
    lines.push(length("RMSE", motion.output_rmse));
    match motion.floor {
        Ok(floor) => lines.push(length("floor", floor)),
        Err(why) if motion.method == Method::Refined => lines.push(("floor".into(), why.into())),
        Err(_) => {}
    }
    lines.push(length("largest error", motion.output_max_error));
    lines.push(length("error at end", motion.output_end_error));
    let peaks = shape.iter().zip(&motion.peak_shape);
    lines.extend(peaks.map(|(c, peak)| (format!("peak {}", c.name), angle(c, *peak))));
    let forces = motion.description.actuators.iter().zip(&motion.peak_force);
    lines.extend(forces.map(|(actuator, peak)| {
        let text = format!("{} {}", number::significant(*peak, 4), actuator.unit);
        (format!("peak {}", actuator.name), text)
    }));
    lines.push(("planning time".to_owned(), number::duration(motion.elapsed)));
    let single = motion.phases.len() == 1;
    for (phase, half) in motion.phases.iter().zip(["accelerate", "brake"]) {
        let summary = phase_summary(motion, phase).into_iter();
        lines.extend(summary.map(|(name, value)| match single {
            true => (name, value),
            false => (format!("{half}: {name}"), value),
        }));
    }
    lines
}

fn phase_summary(motion: &PlannedMotion, phase: &Phase) -> Vec<(String, String)> {
    let mut lines = Vec::new();
    if let Some(weights) = &phase.weights {
        lines.push(("contributions".to_owned(), contributions(motion, weights)));
    }
    let ended = phase.detail.termination();
    match &phase.detail {
        Detail::Gain(gain) => {
            let (steps, evaluations) = (gain.iterations, gain.evaluations);
            let text = format!("{ended}, {steps} steps, {evaluations} evaluations of Γ");
            lines.push(("optimiser".to_owned(), text));
            lines.extend(gain.warning.iter().map(|text| ("warning".to_owned(), text.clone())));
            match &gain.along {
                // Along a line, this is all of K that the task determines.
                Some(along) => lines.push(("K · direction".to_owned(), entries(along))),
                None => {
                    let shape = motion.description.shape_coordinates();
                    let rows = shape.iter().zip(&phase.gain);
                    lines.extend(rows.map(|(c, row)| (format!("K {}", c.name), entries(row))));
                }
            }
        }
        Detail::Refined(refined) => {
            let (sweeps, spans) = (refined.sweeps, refined.spans);
            let evaluations = refined.evaluations;
            let text =
                format!("{ended}, {sweeps} sweeps, {spans} spans, {evaluations} evaluations of Γ");
            lines.push(("sweeps".to_owned(), text));
        }
    }
    lines
}

fn angle(coordinate: &Coordinate, value: f64) -> String {
    let text = format!("{} {}", number::significant(value, 4), coordinate.unit);
    match coordinate.unit {
        "rad" => format!("{text} ({:.2} deg)", value.to_degrees()),
        _ => text,
    }
}

fn contributions(motion: &PlannedMotion, weights: &[f64]) -> String {
    let pairs = motion.description.shape_sets.iter().zip(weights);
    let moving = pairs.filter(|(_, weight)| **weight != 0.0);
    let share = |weight: &f64| number::share(*weight);
    moving
        .map(|(set, weight)| format!("{} {}", set.name, share(weight)))
        .collect::<Vec<_>>()
        .join(", ")
}

fn entries(values: &[f64]) -> String {
    values.iter().map(|&value| number::significant(value + 0.0, 6)).collect::<Vec<_>>().join("  ")
}
