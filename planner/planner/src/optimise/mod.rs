//! Least squares with few parameters and many residuals. The residuals stream by: each is added to the
//! normal equations and forgotten, so that memory does not grow with the samples of a motion.

mod levenberg_marquardt;
mod normal_equations;

pub use levenberg_marquardt::{LevenbergMarquardt, Minimum, Termination};
pub use normal_equations::NormalEquations;
