//! Runs of robots as one self-contained HTML file: tables, plots, equations, proofs and a 3D animation.
//!
//! A [`Report`] is plain data. [`Report::html`] makes the page, [`Report::write`] puts it into a file,
//! whole or not at all. The page needs no network and no server; the same data give the same bytes.
//!
//! [`Trace`] turns the signals of a run into panels with the names and units of the robot's
//! description; [`Recorder`] turns its states into the poses and paths of an animation.
#![forbid(unsafe_code)]

mod certificate;
mod control;
mod data;
mod error;
mod latex;
mod pack;
mod page;
mod recorder;
mod scene;
mod text;
mod trace;

#[cfg(test)]
mod tests;

pub use data::{
    Animation, Control, DesignFigure, Figure, Panel, Parameter, Path, Report, RobotPage, Row,
    RunPage, Series, Stroke, Table,
};
pub use error::Error;
pub use page::LIMIT;
pub use recorder::Recorder;
pub use scene::{Body, Pose, Shape, poses};
pub use trace::{Signals, Trace};
