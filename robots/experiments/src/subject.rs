//! The robot of an experiment.

use shapebot_dynamics::control::ControlDesign;
use shapebot_dynamics::{LagrangianSystem, Robot};
use shapebot_planning::Refusal;
use std::any::Any;

/// Parameters by name, SI units.
pub type Settings = [(String, f64)];

/// A robot of some sizes that threads may share. Experiments are compiled for sizes, not for robots.
pub type SizedRobot<const N: usize, const NX: usize, const NS: usize> =
    dyn Robot<f64, N, NX, NS> + Sync;

/// A Lagrangian system of N coordinates that threads may share.
pub type System<const N: usize> = dyn LagrangianSystem<f64, N> + Sync;

/// A [`System`] of any size.
pub struct AnySystem(Box<dyn Any>);

impl AnySystem {
    /// Hides the number of coordinates.
    #[must_use]
    pub fn new<const N: usize>(system: Box<System<N>>) -> Self {
        Self(Box::new(system))
    }

    /// The system, if it has N coordinates.
    ///
    /// # Errors
    ///
    /// Another number of coordinates.
    pub fn of<const N: usize>(self) -> Result<Box<System<N>>, Refusal> {
        let system = self.0.downcast::<Box<System<N>>>();
        let other = |_| Refusal::task(format!("the plant's model does not have {N} coordinates"));
        system.map(|system| *system).map_err(other)
    }
}

/// Makes plants, which differ from the controller's model.
pub trait Plants: Sync {
    /// A model with some parameters set: the robot's own, or that of a name.
    ///
    /// # Errors
    ///
    /// Unknown names, values out of range.
    fn plant(&self, model: Option<&str>, set: &Settings) -> Result<AnySystem, Refusal>;
}

/// What an experiment needs to know beside its task.
#[derive(Clone, Copy)]
pub struct Subject<'a, const N: usize, const NX: usize, const NS: usize> {
    /// The controller's model.
    pub model: &'a SizedRobot<N, NX, NS>,
    /// The controller's gains.
    pub design: &'a ControlDesign,
    /// Plants.
    pub plants: &'a dyn Plants,
}
