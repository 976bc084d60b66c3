//! Shape trajectory planner for shape-accelerated balancing robots: Algorithm 1 of Nagarajan and
//! Hollis, "Shape Space Planner for Shape-Accelerated Balancing Mobile Robots".
//!
//! A balancing robot moves by leaning. Its shape q_s (lean, arms) determines the acceleration of its
//! position variables, q̈_x = Γ(q_s, q̇_s, q̈_s). The planner goes the other way, approximately: given
//! a desired motion of the robot's output it finds the constant gain K for which the shape
//! q_s = K q̈_x^d brings the robot closest to that motion.
//!
//! - [`motion`] has desired motions: straight lines along smooth steps, Bézier curves, or one's own.
//! - [`Weighting`] says how the shape sets share the work; it determines K⁰ (Eqs. 19 and 24).
//! - [`plan`] improves K = K⁰ S by Levenberg-Marquardt ([`LevenbergMarquardt`]) under an
//!   [`Objective`].
//! - [`Plan`] evaluates the planned shape at any time, and streams the motion that follows from it.
//! - [`Constrained`] lets shape sets follow trajectories of their own (Sec. IV-C).
//!
//! A constant gain cannot track exactly. [`refine`] goes further: the shape follows a spline of the
//! virtual acceleration, fitted in a few sweeps of Γ, from any [`Start`] to rest, with a
//! [`Workspace`] of the caller's. [`choose_shares`] divides the work by limits, [`TwoPhases`] by halves of
//! the motion, [`survey_forces`] gives the torques, and [`value`] writes a plan as bytes that a
//! controller evaluates in place.
//!
//! The planner works for every type that implements
//! [`ShapeAccelerated`](shapebot_dynamics::ShapeAccelerated), in single and double precision. It
//! needs neither the standard library nor a heap, and does not panic.
//!
//! # Example
//!
//! A cart-pole, written by hand: a pole of length l above a cart leans by φ. Its unactuated equation
//! cos φ ẍ + l φ̈ = g sin φ gives Γ.
//!
//! ```
//! use shapebot_dynamics::nalgebra::{Matrix1, Vector1};
//! use shapebot_dynamics::{Coordinate, Description, Response, Role, ShapeAccelerated, ShapeSet};
//! use shapebot_planner::{Task, motion::Line, plan};
//!
//! struct CartPole {
//!     length: f64,
//! }
//!
//! const GRAVITY: f64 = 9.81;
//!
//! static DESCRIPTION: Description = Description {
//!     name: "cartpole",
//!     summary: "A pole on a cart",
//!     coordinates: &[
//!         Coordinate {
//!             name: "x",
//!             unit: "m",
//!             role: Role::Position,
//!             actuated: true,
//!             lower: f64::NEG_INFINITY,
//!             upper: f64::INFINITY,
//!         },
//!         Coordinate {
//!             name: "phi",
//!             unit: "rad",
//!             role: Role::Shape,
//!             actuated: false,
//!             lower: -0.5,
//!             upper: 0.5,
//!         },
//!     ],
//!     position_count: 1,
//!     shape_sets: &[ShapeSet { name: "phi", first: 0, len: 1, actuated: false }],
//!     outputs: &["x"],
//!     output_unit: "m",
//!     actuators: &[],
//!     parameters: &[],
//!     frames: &[],
//!     points: &[],
//!     geometry: &[],
//!     friction: &[],
//! };
//!
//! impl ShapeAccelerated<f64, 1, 1> for CartPole {
//!     fn gamma(&self, q: &Vector1<f64>, _: &Vector1<f64>, qdd: &Vector1<f64>) -> Vector1<f64> {
//!         Vector1::new((GRAVITY * q[0].sin() - self.length * qdd[0]) / q[0].cos())
//!     }
//!     fn gamma_prime(&self, q: &Vector1<f64>) -> Vector1<f64> {
//!         Vector1::new(GRAVITY * q[0].tan())
//!     }
//!     fn gamma_prime_jacobian(&self, q: &Vector1<f64>) -> Matrix1<f64> {
//!         Matrix1::new(GRAVITY / q[0].cos().powi(2))
//!     }
//!     fn shape_gain(&self) -> Matrix1<f64> {
//!         Matrix1::new(GRAVITY)
//!     }
//!     fn response(
//!         &self,
//!         q: &Vector1<f64>,
//!         qd: &Vector1<f64>,
//!         qdd: &Vector1<f64>,
//!     ) -> Response<f64, 1, 1> {
//!         let gamma = self.gamma(q, qd, qdd);
//!         let d_qs = Matrix1::new(GRAVITY + gamma[0] * q[0].tan());
//!         let d_qsdd = Matrix1::new(-self.length / q[0].cos());
//!         Response { gamma, d_qs, d_qsd: Matrix1::new(0.0), d_qsdd }
//!     }
//!     fn output(&self, x: &Vector1<f64>, _: &Vector1<f64>) -> Vector1<f64> {
//!         *x
//!     }
//!     fn output_jacobian_position(&self) -> Matrix1<f64> {
//!         Matrix1::new(1.0)
//!     }
//!     fn output_jacobian_shape(&self, _: &Vector1<f64>, _: &Vector1<f64>) -> Matrix1<f64> {
//!         Matrix1::new(0.0)
//!     }
//!     fn shape_description(&self) -> &Description {
//!         &DESCRIPTION
//!     }
//! }
//!
//! let robot = CartPole { length: 0.5 };
//! // Two metres in five seconds, along the polynomial of ninth degree.
//! let line = Line::new([0.0].into(), [2.0].into(), 5.0, 9)?;
//! let plan = plan(&robot, &Task::new(&line, 501))?;
//!
//! let report = plan.report();
//! assert!(report.termination.converged());
//! assert!((report.output_rmse - 0.0211).abs() < 1e-4); // Table II, metres
//!
//! // What a controller tracks, at any time:
//! let point = plan.at(1.2);
//! assert!(point.shape[0] > 0.05 && point.shape[0] < 0.5);
//!
//! // The motion that follows from it, sample by sample:
//! let last = plan.rows(&robot).last().unwrap();
//! assert!((last.output[0] - 2.0).abs() < 0.02);
//! # Ok::<(), shapebot_planner::Error>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod bounds;
mod constraint;
mod error;
mod gain;
mod integrate;
mod linear_algebra;
pub mod motion;
mod objective;
pub mod optimise;
mod phases;
mod plan;
mod planner;
mod reference;
pub mod refined;
mod report;
mod torque;
pub mod value;

#[cfg(test)]
#[path = "../tests/it/common/mod.rs"]
mod common;

pub use bounds::{AccelerationBound, acceleration_bound, constant_acceleration};
pub use constraint::{Constrained, SetMotion, ShapeConstraint, Unconstrained};
pub use error::Error;
pub use gain::Weighting;
pub use integrate::MIN_SAMPLES;
pub use objective::Objective;
pub use optimise::{LevenbergMarquardt, NelderMead, Optimiser, Termination};
pub use phases::TwoPhases;
pub use plan::{Plan, PlanPoint, Row};
pub use planner::{Parametrisation, Task, plan};
pub use reference::Desired;
pub use refined::{
    RefinedPlan, RefinedReport, Refinement, Spare, Start, Workspace, choose_shares, refine,
    refine_surveyed, refine_with_forces,
};
pub use report::{Report, Warning};
pub use torque::{ForceReport, actuator_force, generalised_force, survey_forces, survey_within};
