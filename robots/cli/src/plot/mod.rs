//! Plots as SVG, drawn here: lines over time in panels below each other.

mod axis;
mod figure;
mod motion;
mod run;

pub(crate) use figure::{Figure, Panel, Series, Stroke};
pub(crate) use motion::figure as motion_figure;
pub(crate) use run::figure as run_figure;
