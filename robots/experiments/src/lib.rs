//! Closed-loop experiments: a task's plan, read from the bytes of its file as a robot would read it, is
//! followed by the controller of `shapebot-control` on the simulated robot of `shapebot-sim`.
//!
//! [`run`] makes one [`Experiment`], plain data for tables, CSV, plots and reports. [`Trials`] makes many
//! at random, [`Runs::onsets`] finds where falls begin. [`AnyRobot`] hides a robot's sizes, so that callers need not
//! be compiled for each; which robots there are is their knowledge.
#![forbid(unsafe_code)]

mod any_robot;
mod error;
mod experiment;
mod gains;
mod loops;
mod onsets;
mod reference;
mod report;
mod rows;
mod scenario;
mod subject;
mod summary;
mod trials;

pub use any_robot::{AnyRobot, Driven, Planned, Supported};
pub use error::Error;
pub use experiment::{Errors, Experiment, Fall, Sample};
pub use loops::{circumstances, run};
pub use onsets::OnsetOf;
pub use report::{run_page, trace};
pub use rows::{HEAD, MergeError, Row, merge};
pub use subject::{AnySystem, Plants, Settings, SizedRobot, Subject, System};
pub use summary::{Percentiles, Summary};
pub use trials::{Runs, Shard, Trials};
