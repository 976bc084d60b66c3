//! `shapebot plan`: one motion of one robot.

use crate::args::{self, PlanArgs, Point};
use crate::failure::Outcome;
use crate::output::{self, number};
use crate::planning::{Path, PlanTask, PlannedMotion, termination};
use crate::plot;
use crate::robot;
use shapebot_dynamics::Coordinate;
use shapebot_planner::Objective;
use std::io::{self, Write};

pub(crate) fn run(args: &PlanArgs) -> Outcome {
    let robot = robot::open(&args.robot)?.dynamics(&args.parameters.values)?;
    let task = task(args);
    let motion = robot.plan(&task)?;
    let mut stdout = anstream::stdout().lock();
    let title = format!("{}: {}", motion.description.name, describe(&task, &motion));
    write_summary(&mut stdout, &title, &motion)?;
    let files =
        [(&args.csv, output::csv as fn(&PlannedMotion) -> String), (&args.json, output::json)];
    for (path, text) in files {
        if let Some(path) = path {
            output::write_file(path, &text(&motion))?;
            writeln!(stdout, "wrote {}", path.display())?;
        }
    }
    if let Some(path) = &args.svg {
        output::write_file(path, &plot::motion_figure(&motion, &title).svg())?;
        writeln!(stdout, "wrote {}", path.display())?;
    }
    Ok(())
}

fn task(args: &PlanArgs) -> PlanTask {
    let entries = |point: &Point| point.0.clone();
    let path = match (&args.line, &args.bezier) {
        (Some(goal), _) => Path::Line { goal: entries(goal), degree: args.degree },
        (None, points) => {
            let points = points.iter().flat_map(|points| points.0.iter().map(entries));
            Path::Bezier { points: points.collect() }
        }
    };
    PlanTask {
        path,
        duration: args.duration,
        samples: args.samples,
        weights: args.weights.clone(),
        objective: match args.objective {
            args::Objective::Position => Objective::Output,
            args::Objective::Acceleration => Objective::Acceleration,
            args::Objective::Coordinates => Objective::Position,
        },
    }
}

/// The task in words.
fn describe(task: &PlanTask, motion: &PlannedMotion) -> String {
    let unit = motion.description.output_unit;
    let path = match &task.path {
        Path::Line { goal, degree } => {
            let goal: Vec<String> = goal.iter().map(f64::to_string).collect();
            let goal =
                if goal.len() == 1 { goal.join("") } else { format!("({})", goal.join(", ")) };
            format!("line to {goal} {unit}, degree {degree}")
        }
        Path::Bezier { points } => format!("Bézier curve, {} control points", points.len()),
    };
    format!("{path}, {} s, {} samples", task.duration, task.samples)
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
    let mut lines = vec![
        length("RMSE", motion.output_rmse),
        length("largest error", motion.output_max_error),
        length("error at end", motion.output_end_error),
    ];
    let peaks = shape.iter().zip(&motion.peak_shape);
    lines.extend(peaks.map(|(c, peak)| (format!("peak {}", c.name), angle(c, *peak))));
    if let Some(weights) = &motion.weights {
        lines.push(("contributions".to_owned(), contributions(motion, weights)));
    }
    lines.push(("optimiser".to_owned(), optimiser(motion)));
    match &motion.along {
        // Along a line, this is all of K that the task determines.
        Some(along) => lines.push(("K · direction".to_owned(), entries(along))),
        None => {
            let rows = shape.iter().zip(&motion.gain);
            lines.extend(rows.map(|(c, row)| (format!("K {}", c.name), entries(row))));
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
    moving.map(|(set, weight)| format!("{} {weight}", set.name)).collect::<Vec<_>>().join(", ")
}

fn optimiser(motion: &PlannedMotion) -> String {
    format!(
        "{}, {} steps, {} evaluations of Γ, {}",
        termination(motion.termination),
        motion.iterations,
        motion.evaluations,
        number::duration(motion.elapsed)
    )
}

fn entries(values: &[f64]) -> String {
    values.iter().map(|&value| number::significant(value, 6)).collect::<Vec<_>>().join("  ")
}
