//! A planned motion as CSV and as JSON.

use super::Json;
use serde_json::Value;
use shapebot_dynamics::Coordinate;
use shapebot_planning::{Detail, Phase, PlannedMotion, Row};
use shapebot_tasks::Method;

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

/// The same without samples.
pub(crate) fn report(motion: &PlannedMotion) -> String {
    let lines = members(motion).into_iter().map(|(key, value)| format!("  \"{key}\": {value}"));
    format!("{{\n{}\n}}\n", lines.collect::<Vec<_>>().join(",\n"))
}

fn members(motion: &PlannedMotion) -> Vec<(&'static str, Value)> {
    let robot = &motion.description;
    let names = |coordinates: &[Coordinate]| coordinates.iter().map(|c| c.name).collect::<Value>();
    let mut members = vec![
        ("robot", robot.name.into()),
        ("outputs", robot.outputs.iter().copied().collect()),
        ("output_unit", robot.output_unit.into()),
        ("position_coordinates", names(robot.position_coordinates())),
        ("shape_coordinates", names(robot.shape_coordinates())),
        ("shape_sets", robot.shape_sets.iter().map(|set| set.name).collect()),
        ("method", method(motion.method).into()),
        ("output_rmse", motion.output_rmse.into()),
        ("motion_rmse", motion.motion_rmse.into()),
        ("floor", motion.floor.ok().into()),
        ("output_max_error", motion.output_max_error.into()),
        ("output_end_error", motion.output_end_error.into()),
        ("peak_shape", list(&motion.peak_shape)),
        ("actuators", robot.actuators.iter().map(|actuator| actuator.name).collect()),
        ("peak_force", list(&motion.peak_force)),
        ("planning_seconds", motion.elapsed.as_secs_f64().into()),
    ];
    match motion.phases.as_slice() {
        [phase] => members.extend(phase_members(phase)),
        phases => {
            let phase = |phase: &Phase| -> Value {
                phase_members(phase)
                    .into_iter()
                    .map(|(key, value)| (key.to_owned(), value))
                    .collect()
            };
            members.push(("phases", phases.iter().map(phase).collect()));
        }
    }
    members
}

fn phase_members(phase: &Phase) -> Vec<(&'static str, Value)> {
    let matrix = |rows: &[Vec<f64>]| rows.iter().map(|row| list(row)).collect::<Value>();
    let mut members = vec![("contributions", phase.weights.as_deref().map(list).into())];
    match &phase.detail {
        Detail::Gain(gain) => members.extend([
            ("K", matrix(&phase.gain)),
            ("K0", matrix(&gain.initial_gain)),
            ("K_along", gain.along.as_deref().map(list).into()),
            ("cost", gain.cost.into()),
            ("cost_at_K0", gain.initial_cost.into()),
            ("iterations", gain.iterations.into()),
            ("evaluations", gain.evaluations.into()),
        ]),
        Detail::Refined(refined) => members.extend([
            ("K0", matrix(&phase.gain)),
            ("tau_squared", matrix(&refined.time_constant)),
            ("spans", refined.spans.into()),
            ("sweeps", refined.sweeps.into()),
            ("evaluations", refined.evaluations.into()),
        ]),
    }
    members.push(("termination", phase.detail.termination().into()));
    members
}

/// The word for a method.
pub(crate) const fn method(method: Method) -> &'static str {
    match method {
        Method::Gain => "gain",
        Method::Refined => "refined",
    }
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
