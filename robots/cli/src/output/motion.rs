//! A planned motion as CSV and as JSON.

use super::Json;
use crate::planning::{PlannedMotion, Row, termination};
use serde_json::Value;
use shapebot_dynamics::Coordinate;

/// Every number of a sample, in the order of [`csv_head`].
fn numbers(row: &Row) -> impl Iterator<Item = f64> + '_ {
    let lists = [&row.desired, &row.output].into_iter().chain(&row.position).chain(&row.shape);
    [row.time].into_iter().chain(lists.flatten().copied())
}

fn csv_head(motion: &PlannedMotion) -> Vec<String> {
    let robot = &motion.description;
    let mut head = vec!["time [s]".to_owned()];
    for kind in ["desired", "planned"] {
        head.extend(
            robot.outputs.iter().map(|name| format!("{kind} {name} [{}]", robot.output_unit)),
        );
    }
    for coordinates in [robot.position_coordinates(), robot.shape_coordinates()] {
        for (suffix, per) in [("", ""), (" rate", "/s"), (" acceleration", "/s^2")] {
            head.extend(
                coordinates.iter().map(|c| format!("{}{suffix} [{}{per}]", c.name, c.unit)),
            );
        }
    }
    head
}

/// One row per sample under a head with units.
pub(crate) fn csv(motion: &PlannedMotion) -> String {
    let mut text = csv_head(motion).join(",");
    text.push('\n');
    for row in &motion.rows {
        text.push_str(&numbers(row).map(cell).collect::<Vec<_>>().join(","));
        text.push('\n');
    }
    text
}

/// Zero without a sign.
fn cell(value: f64) -> String {
    let mut json = Json::default();
    json.number(value + 0.0);
    json.into_text()
}

/// The plan with its gains, figures of merit and samples.
pub(crate) fn json(motion: &PlannedMotion) -> String {
    let mut text = String::from("{\n");
    for (key, value) in members(motion) {
        text.push_str(&format!("  \"{key}\": {value},\n"));
    }
    text + "  \"samples\": [\n" + &samples(motion) + "\n  ]\n}\n"
}

fn members(motion: &PlannedMotion) -> Vec<(&'static str, Value)> {
    let robot = &motion.description;
    let names = |coordinates: &[Coordinate]| coordinates.iter().map(|c| c.name).collect::<Value>();
    vec![
        ("robot", robot.name.into()),
        ("outputs", robot.outputs.iter().copied().collect()),
        ("output_unit", robot.output_unit.into()),
        ("position_coordinates", names(robot.position_coordinates())),
        ("shape_coordinates", names(robot.shape_coordinates())),
        ("shape_sets", robot.shape_sets.iter().map(|set| set.name).collect()),
        ("contributions", motion.weights.as_deref().map(list).into()),
        ("K", motion.gain.iter().map(|row| list(row)).collect()),
        ("K0", motion.initial_gain.iter().map(|row| list(row)).collect()),
        ("K_along", motion.along.as_deref().map(list).into()),
        ("cost", motion.cost.into()),
        ("cost_at_K0", motion.initial_cost.into()),
        ("output_rmse", motion.output_rmse.into()),
        ("output_max_error", motion.output_max_error.into()),
        ("output_end_error", motion.output_end_error.into()),
        ("peak_shape", list(&motion.peak_shape)),
        ("iterations", motion.iterations.into()),
        ("evaluations", motion.evaluations.into()),
        ("termination", termination(motion.termination).into()),
    ]
}

/// Zeros without a sign.
fn list(values: &[f64]) -> Value {
    values.iter().map(|value| value + 0.0).collect()
}

/// One line per sample.
fn samples(motion: &PlannedMotion) -> String {
    let line = |row: &Row| {
        let mut json = Json::default();
        json.raw("    {\"t\":");
        json.number(row.time);
        let [position, velocity, acceleration] = &row.position;
        let [shape, shape_rate, shape_acceleration] = &row.shape;
        for (key, list) in [
            (",\"desired\":", &row.desired),
            (",\"output\":", &row.output),
            (",\"qx\":", position),
            (",\"qxd\":", velocity),
            (",\"qxdd\":", acceleration),
            (",\"qs\":", shape),
            (",\"qsd\":", shape_rate),
            (",\"qsdd\":", shape_acceleration),
        ] {
            json.raw(key);
            json.array(&[list.len()], list);
        }
        json.raw("}");
        json.into_text()
    };
    motion.rows.iter().map(line).collect::<Vec<_>>().join(",\n")
}
