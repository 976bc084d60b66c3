//! The figure of a planned motion: output, error, shape.

use super::{Figure, Panel, Series, Stroke};
use crate::output::number;
use shapebot_dynamics::Coordinate;
use shapebot_planning::{PlannedMotion, Row};

/// Desired and planned output, their difference, and the shape.
pub(crate) fn figure(motion: &PlannedMotion, title: &str) -> Figure {
    let mut panels = vec![output_panel(motion), error_panel(motion)];
    panels.extend(shape_panels(motion));
    Figure {
        title: title.to_owned(),
        subtitle: format!(
            "RMSE {} {}, at the end {} {}",
            number::metres(motion.output_rmse),
            motion.description.output_unit,
            number::metres(motion.output_end_error),
            motion.description.output_unit,
        ),
        times: motion.rows.iter().map(|row| row.time).collect(),
        panels,
    }
}

fn series(
    rows: &[Row],
    name: String,
    color: usize,
    stroke: Stroke,
    value: impl Fn(&Row) -> f64,
) -> Series {
    Series { name, color, stroke, values: rows.iter().map(value).collect() }
}

fn output_panel(motion: &PlannedMotion) -> Panel {
    // The desired line is drawn first, so that the planned one lies upon it.
    let lines = motion.description.outputs.iter().enumerate().flat_map(|(i, name)| {
        let desired = move |row: &Row| row.desired[i];
        let planned = move |row: &Row| row.output[i];
        [
            series(&motion.rows, format!("{name} desired"), i, Stroke::Band, desired),
            series(&motion.rows, format!("{name} planned"), i, Stroke::Line, planned),
        ]
    });
    Panel { label: format!("output [{}]", motion.description.output_unit), series: lines.collect() }
}

/// Planned − desired, in millimetres if the output is in metres.
fn error_panel(motion: &PlannedMotion) -> Panel {
    let (unit, scale) = match motion.description.output_unit {
        "m" => ("mm", 1e3),
        other => (other, 1.0),
    };
    let lines = motion.description.outputs.iter().enumerate().map(|(i, name)| {
        let error = move |row: &Row| scale * (row.output[i] - row.desired[i]);
        series(&motion.rows, format!("{name} error"), i, Stroke::Line, error)
    });
    Panel { label: format!("error [{unit}]"), series: lines.collect() }
}

/// One panel for the shape coordinates of each unit; angles in degrees. Coordinates that rest
/// throughout are left out, unless all do.
fn shape_panels(motion: &PlannedMotion) -> Vec<Panel> {
    let coordinates = motion.description.shape_coordinates();
    let largest = motion.peak_shape.iter().copied().fold(0.0, f64::max);
    let moves = |i: usize| largest == 0.0 || motion.peak_shape[i] > 1e-9 * largest;
    let mut panels: Vec<Panel> = Vec::new();
    let moving = coordinates.iter().enumerate().filter(|(i, _)| moves(*i));
    for (color, (i, coordinate)) in moving.enumerate() {
        let (unit, scale) = shown(coordinate);
        let label = format!("shape [{unit}]");
        let line = series(&motion.rows, coordinate.name.to_owned(), color, Stroke::Line, |row| {
            scale * row.shape[0][i]
        });
        match panels.iter_mut().find(|panel| panel.label == label) {
            Some(panel) => panel.series.push(line),
            None => panels.push(Panel { label, series: vec![line] }),
        }
    }
    panels
}

fn shown(coordinate: &Coordinate) -> (&'static str, f64) {
    if coordinate.unit == "rad" {
        ("deg", 180.0 / std::f64::consts::PI)
    } else {
        (coordinate.unit, 1.0)
    }
}
