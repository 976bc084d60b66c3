//! Experiments as pages of a report.

use crate::experiment::Experiment;
use shapebot_planning::number;
use shapebot_report::{Figure, RunPage, Trace};
use shapebot_tasks::Method;
use shapebot_tasks::simulation::{Law, Paper};

/// Signals of every so many recorded instants.
#[must_use]
pub fn trace(experiment: &Experiment, every: usize) -> (Vec<f64>, Trace) {
    let mut trace = Trace::default();
    let mut time = Vec::new();
    let position = experiment.description.position_count;
    for sample in experiment.samples.iter().step_by(every.max(1)) {
        time.push(sample.time);
        let [desired, planned, actual] = &sample.output;
        trace.desired.push(desired.clone());
        trace.planned.push(planned.clone());
        trace.actual.push(actual.clone());
        trace.planned_shape.push(sample.planned_shape.clone());
        trace.shape.push(sample.state[0].get(position..).unwrap_or_default().to_vec());
        trace.compensation.push(sample.compensation.clone());
        trace.forces.push(sample.force.clone());
    }
    (time, trace)
}

/// The page of an experiment: panels, animation, and figures beside the paper's.
#[must_use]
pub fn run_page(experiment: &Experiment, paper: &Paper) -> RunPage {
    let (time, trace) = trace(experiment, experiment.frame_every);
    let description = &experiment.description;
    let title = if experiment.title.is_empty() { description.name } else { &experiment.title };
    let mut notes = vec![loop_name(experiment).to_owned()];
    notes.push(format!(
        "{} s and {} s standing",
        trimmed(experiment.duration),
        trimmed(after(experiment))
    ));
    notes.extend(paper.figure.iter().map(|figure| format!("the paper's {figure}")));
    if let Some(fall) = &experiment.fell {
        notes.push(format!("fell at {:.2} s: {}", fall.time, fall.coordinate));
    }
    if let Some(rows) = &experiment.regulator {
        notes.push(regulator(rows));
    }
    RunPage {
        title: format!("{title} ({})", loop_word(experiment)),
        robot: description.name.to_owned(),
        notes,
        time,
        panels: trace.panels(description),
        animation: experiment.animation.clone(),
        figures: figures(experiment, paper),
    }
}

fn after(experiment: &Experiment) -> f64 {
    let end = experiment.samples.last().map_or(0.0, |sample| sample.time);
    (end - experiment.duration).max(0.0)
}

fn trimmed(value: f64) -> String {
    number::share(value)
}

/// A word for what closed the loop.
const fn loop_word(experiment: &Experiment) -> &'static str {
    match (experiment.law, experiment.method) {
        (Law::Regulator, _) => "LQR",
        (Law::Planned, Method::Gain) => "gain plan",
        (Law::Planned, Method::Refined) => "refined plan",
    }
}

const fn loop_name(experiment: &Experiment) -> &'static str {
    match (experiment.law, experiment.method) {
        (Law::Regulator, _) => "linear-quadratic regulator on the desired motion, without a plan",
        (Law::Planned, Method::Gain) => "gain plan (Algorithm 1), control as in Fig. 4",
        (Law::Planned, Method::Refined) => "refined plan, control as in Fig. 4",
    }
}

fn regulator(rows: &[Vec<f64>]) -> String {
    let row = |row: &Vec<f64>| {
        row.iter().map(|&k| number::significant(k, 3)).collect::<Vec<_>>().join(" ")
    };
    format!("K = [{}]", rows.iter().map(row).collect::<Vec<_>>().join("; "))
}

fn figures(experiment: &Experiment, paper: &Paper) -> Vec<Figure> {
    let errors = &experiment.errors;
    let description = &experiment.description;
    let unit = description.output_unit;
    let figure = |name: String, ours: f64, paper: Option<f64>, unit: &str| Figure {
        name,
        ours,
        paper,
        unit: unit.to_owned(),
    };
    let mut figures = vec![
        figure("RMSE against the plan".into(), errors.plan_rmse, paper.rmse, unit),
        figure("RMSE against the desired motion".into(), errors.desired_rmse, None, unit),
        figure(
            "RMSE of the plan against the desired motion".into(),
            experiment.plan_rmse,
            None,
            unit,
        ),
        figure("Largest error against the plan".into(), errors.plan_max, paper.largest, unit),
        figure("Error at the end".into(), errors.end, None, unit),
    ];
    for set in description.shape_sets {
        let angle = description.shape_coordinates().get(set.first).is_some_and(|c| c.unit == "rad");
        let (scale, unit) = if angle { (1f64.to_degrees(), "deg") } else { (1.0, "") };
        let theirs = paper.compensation.iter().find(|(name, _)| name.value == set.name);
        let ours = experiment.compensation_of(set.name).unwrap_or_default();
        let theirs = theirs.map(|(_, value)| scale * value);
        figures.push(figure(
            format!("Largest compensation of {}", set.name),
            scale * ours,
            theirs,
            unit,
        ));
    }
    figures
}
