//! Simulation of balancing robots.
//!
//! - [`Plant`]: the emitted forward dynamics of a robot with dissipation, friction at the drives and at
//!   the floor, limits of the actuators, slopes and uneven floors, pushes. It may have other parameters
//!   than the controller's model, or be a model with more terms.
//! - [`Scenario`] says what differs from the nominal case, [`Sensors`] what the controller is told.
//! - [`simulate`] closes the loop around a [`Tracker`]: the controller of `shapebot-control`, or the
//!   [`Lqr`] regulator that it is compared with. Control period and plant step are separate. A tracker
//!   is told states, or, as [`Estimated`], counts and readings of an inertial unit.
//! - [`draw`] makes random scenarios that fit the robot's size; draw i is reproducible by itself.
//!   [`onset`] finds where falls begin.
//!
//! Everything is deterministic: equal inputs and seeds give equal runs.
//!
//! # Example
//!
//! ```
//! use shapebot_control::{Controller, Gains};
//! use shapebot_generated::ballbot_planar::{BallbotPlanar, CONTROL};
//! use shapebot_planner::{Refinement, Task, Workspace, motion::Line, refine};
//! use shapebot_sim::{Friction, Scenario, Table, Timing, World, simulate};
//!
//! let robot = BallbotPlanar::<f64>::from_model();
//! // Two metres in five seconds.
//! let line = Line::new([0.0].into(), [2.0].into(), 5.0, 9)?;
//! let mut workspace = Workspace::<f64, 1, 64>::new();
//! let plan = refine(&robot, &Task::new(&line, 501), &Refinement::default(), &mut workspace)?;
//! let reference = Table::from_rows(&robot, plan.rows(&robot, 1)?)?;
//!
//! // A drive with friction that neither planner nor controller knows of.
//! let drive = Friction { viscous: 0.3, coulomb: 2.0 };
//! let scenario = Scenario { drive, ..Scenario::default() };
//! let timing = Timing::default();
//! let world = World { system: &robot, map: &robot, scenario: &scenario, timing };
//! let mut controller = Controller::new(&robot, &Gains::from_design(&robot, &CONTROL)?)?;
//! let run = simulate(&world, &reference, &mut controller)?;
//! assert!(run.fell.is_none());
//! assert!(run.errors.plan_rmse < 0.02); // metres
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

mod error;
mod estimated;
mod floor;
mod friction;
pub mod lqr;
mod onset;
mod plant;
mod random;
mod rate_filter;
mod raw;
mod record;
mod reference;
mod scale;
mod scenario;
mod sensed;
mod sensors;
mod simulate;

pub use error::Error;
pub use estimated::Estimated;
pub use floor::{Floor, Weights};
pub use friction::Friction;
pub use lqr::{Lqr, LqrWeights};
pub use onset::{Onset, onset};
pub use plant::Plant;
pub use random::{Draw, Ranges, draw};
pub use rate_filter::RateFilter;
pub use raw::Unit;
pub use record::{Errors, Fall, Run, Sample};
pub use reference::{Moment, Reference, Table};
pub use scale::Scale;
pub use scenario::{Push, Scenario, Sensors};
pub use simulate::{Timing, Tracker, World, simulate};
