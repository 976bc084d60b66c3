//! Plans beyond a constant gain: the virtual acceleration as a spline.
//!
//! A constant gain cannot track: with q_s = K⁰u every robot of the class behaves near the origin as
//! ẍ = u − τ²ü, and the u that makes ẍ the desired acceleration is no multiple of it. Here u is a
//! spline, fitted so that x follows the desired motion as closely as the ends allow.

mod banded;
mod basis;
mod ends;
mod floor;
mod forces;
mod gram;
mod limits;
mod plan;
mod problem;
mod sampled;
mod secant;
mod shares;
mod solve;
mod spans;
mod sweeps;
mod task;
mod window;
mod workspace;

pub use forces::{PlanWithForces, refine_surveyed, refine_with_forces};
pub use plan::{RefinedPlan, RefinedReport};
pub use sampled::Sampled;
pub use shares::{Spare, choose_shares};
pub use solve::refine;
pub use task::{Refinement, Start};
pub use window::MIN_REFINED_SAMPLES;
pub use workspace::Workspace;
