//! The figure of a run: the same panels as in the report.

use super::{Figure, Panel, Series, Stroke};
use crate::output::number;
use shapebot_experiments::{Experiment, trace};

/// Output, errors, shape, compensation and forces over time.
pub(crate) fn figure(experiment: &Experiment) -> Figure {
    let (times, trace) = trace(experiment, 1);
    let description = &experiment.description;
    let panels = trace.panels(description).into_iter().map(|panel| Panel {
        label: format!("{} [{}]", panel.title, panel.unit),
        series: panel.series.into_iter().map(series).collect(),
    });
    let (unit, errors) = (description.output_unit, &experiment.errors);
    Figure {
        title: match experiment.title.as_str() {
            "" => description.name.to_owned(),
            title => title.to_owned(),
        },
        subtitle: format!(
            "RMSE {} {unit} against the plan, {} {unit} against the desired motion",
            number::metres(errors.plan_rmse),
            number::metres(errors.desired_rmse),
        ),
        times,
        panels: panels.collect(),
    }
}

fn series(series: shapebot_report::Series) -> Series {
    // Planned and actual lines of a coordinate lie beside each other in brightness, not in colour.
    let stroke = match series.stroke {
        shapebot_report::Stroke::Actual => Stroke::Line,
        shapebot_report::Stroke::Desired | shapebot_report::Stroke::Planned => Stroke::Band,
    };
    Series { name: series.label, color: series.color, stroke, values: series.values }
}
