//! The robot of an experiment.

use shapebot_dynamics::LagrangianSystem;
use shapebot_dynamics::control::ControlDesign;
use shapebot_planning::Refusal;

/// Parameters by name, SI units.
pub type Settings = [(String, f64)];

/// A Lagrangian system that threads may share.
pub type System<const N: usize> = dyn LagrangianSystem<f64, N> + Sync;

/// Makes plants, which differ from the controller's model.
pub trait Plants<const N: usize>: Sync {
    /// A model with some parameters set: the robot's own, or that of a name.
    ///
    /// # Errors
    ///
    /// Unknown names, values out of range, a model of other sizes.
    fn plant(&self, model: Option<&str>, set: &Settings) -> Result<Box<System<N>>, Refusal>;
}

/// The robot of an experiment: what its controller knows, and where its plants come from.
pub struct Subject<'a, R, const N: usize> {
    /// The controller's model.
    pub model: &'a R,
    /// The controller's gains.
    pub design: &'a ControlDesign,
    /// Plants.
    pub plants: &'a dyn Plants<N>,
}

impl<R, const N: usize> Clone for Subject<'_, R, N> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<R, const N: usize> Copy for Subject<'_, R, N> {}
