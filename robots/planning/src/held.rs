//! Constrained shape sets, or none: one type for both, so that the planner is compiled once.

use nalgebra::SVector;
use shapebot_dynamics::ShapeAccelerated;
use shapebot_planner::{Constrained, ShapeConstraint, Unconstrained};

type Robot<'a, const NX: usize, const NS: usize> = dyn ShapeAccelerated<f64, NX, NS> + 'a;

/// Constrained shape sets, or none.
#[derive(Clone, Copy)]
pub(crate) struct Held<'a, const NX: usize, const NS: usize>(
    pub(crate) Option<Constrained<'a, Robot<'a, NX, NS>, f64, NX, NS>>,
);

impl<const NX: usize, const NS: usize> ShapeConstraint<f64, NX, NS> for Held<'_, NX, NS> {
    fn holds(&self, index: usize) -> bool {
        self.0.is_some_and(|constrained| constrained.holds(index))
    }

    fn shape(&self, t: f64) -> [SVector<f64, NS>; 5] {
        match &self.0 {
            Some(constrained) => constrained.shape(t),
            None => ShapeConstraint::<f64, NX, NS>::shape(&Unconstrained, t),
        }
    }

    fn acceleration(&self, t: f64) -> [SVector<f64, NX>; 3] {
        match &self.0 {
            Some(constrained) => constrained.acceleration(t),
            None => ShapeConstraint::<f64, NX, NS>::acceleration(&Unconstrained, t),
        }
    }
}
