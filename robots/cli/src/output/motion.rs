//! A planned motion as CSV and as JSON.

use super::Json;
use crate::planning::{PlannedMotion, Row, termination};

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
        let cells: Vec<String> = numbers(row).map(|value| value.to_string()).collect();
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

/// The plan with its gains, figures of merit and samples.
pub(crate) fn json(motion: &PlannedMotion) -> String {
    let robot = &motion.description;
    let matrix = |rows: &[Vec<f64>]| serde_json::json!(rows);
    let summary = serde_json::json!({
        "robot": robot.name,
        "outputs": robot.outputs,
        "output_unit": robot.output_unit,
        "position_coordinates": robot.position_coordinates().iter().map(|c| c.name).collect::<Vec<_>>(),
        "shape_coordinates": robot.shape_coordinates().iter().map(|c| c.name).collect::<Vec<_>>(),
        "shape_sets": robot.shape_sets.iter().map(|set| set.name).collect::<Vec<_>>(),
        "contributions": motion.weights,
        "K": matrix(&motion.gain),
        "K0": matrix(&motion.initial_gain),
        "K_along": motion.along,
        "cost": motion.cost,
        "cost_at_K0": motion.initial_cost,
        "output_rmse": motion.output_rmse,
        "output_max_error": motion.output_max_error,
        "output_end_error": motion.output_end_error,
        "peak_shape": motion.peak_shape,
        "iterations": motion.iterations,
        "evaluations": motion.evaluations,
        "termination": termination(motion.termination),
    });
    let summary = serde_json::to_string_pretty(&summary).unwrap_or_default();
    let open = summary.strip_suffix("\n}").unwrap_or(&summary);
    format!("{open},\n  \"samples\": [\n{}\n  ]\n}}\n", samples(motion))
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
