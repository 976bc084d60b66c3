//! A run as CSV: one row per recorded instant under a head with units.

use shapebot_experiments::{Experiment, Sample};
use std::fmt::Write;

pub(super) fn csv(experiment: &Experiment) -> String {
    let mut text = head(experiment).join(",");
    text.push('\n');
    for sample in &experiment.samples {
        // Writing to a String cannot fail.
        let _ = write!(text, "{}", sample.time);
        for number in numbers(sample) {
            let _ = write!(text, ",{}", number + 0.0);
        }
        text.push('\n');
    }
    text
}

fn numbers(sample: &Sample) -> impl Iterator<Item = f64> + '_ {
    let lists = sample.output.iter().chain(&sample.state);
    let lists = lists.chain([&sample.planned_shape, &sample.compensation, &sample.force]);
    lists.flatten().copied()
}

fn head(experiment: &Experiment) -> Vec<String> {
    let robot = &experiment.description;
    let mut head = vec!["time [s]".to_owned()];
    for kind in ["desired", "planned", "actual"] {
        let names = robot.outputs.iter();
        head.extend(names.map(|name| format!("{kind} {name} [{}]", robot.output_unit)));
    }
    head.extend(robot.coordinates.iter().map(|c| format!("{} [{}]", c.name, c.unit)));
    head.extend(robot.coordinates.iter().map(|c| format!("{} rate [{}/s]", c.name, c.unit)));
    for kind in ["planned", "compensation"] {
        let names = robot.shape_coordinates().iter();
        head.extend(names.map(|c| format!("{kind} {} [{}]", c.name, c.unit)));
    }
    head.extend(robot.actuators.iter().map(|a| format!("{} [{}]", a.name, a.unit)));
    head
}
