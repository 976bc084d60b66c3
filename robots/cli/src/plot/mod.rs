//! Plots as SVG, drawn here: lines over time in panels below each other.

mod axis;
mod figure;
mod motion;

pub(crate) use figure::{Figure, Panel, Series, Stroke};
pub(crate) use motion::figure as motion_figure;
