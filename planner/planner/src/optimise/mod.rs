//! Least squares with few parameters and many residuals. The residuals stream by: each is added to the
//! normal equations and forgotten, so that memory does not grow with the samples of a motion.

mod levenberg_marquardt;
mod nelder_mead;
mod normal_equations;

pub use levenberg_marquardt::{LevenbergMarquardt, Minimum, Termination};
pub use nelder_mead::NelderMead;
pub use normal_equations::NormalEquations;

use shapebot_dynamics::Ordered;

/// A method with its settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Optimiser<T: Ordered> {
    /// With derivatives: a few steps.
    LevenbergMarquardt(LevenbergMarquardt<T>),
    /// Without: many steps, and a check on the derivatives.
    NelderMead(NelderMead<T>),
}

impl<T: Ordered> Default for Optimiser<T> {
    fn default() -> Self {
        Self::LevenbergMarquardt(LevenbergMarquardt::default())
    }
}

impl<T: Ordered> From<LevenbergMarquardt<T>> for Optimiser<T> {
    fn from(settings: LevenbergMarquardt<T>) -> Self {
        Self::LevenbergMarquardt(settings)
    }
}

impl<T: Ordered> From<NelderMead<T>> for Optimiser<T> {
    fn from(settings: NelderMead<T>) -> Self {
        Self::NelderMead(settings)
    }
}
