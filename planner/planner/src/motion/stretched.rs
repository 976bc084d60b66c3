//! Time scaling.

use super::{Derivatives, DesiredMotion, check_factor, in_time};
use crate::Error;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// The same path in another time: a factor above one slows the motion down. The r-th derivative is
/// divided by the factor's r-th power.
#[derive(Clone, Copy, Debug)]
pub struct Stretched<M, T> {
    motion: M,
    factor: T,
}

impl<M, T: Ordered> Stretched<M, T> {
    /// # Errors
    ///
    /// A factor that is not positive and finite.
    pub fn new(motion: M, factor: T) -> Result<Self, Error> {
        check_factor(factor)?;
        Ok(Self { motion, factor })
    }
}

impl<T: Ordered, const NX: usize, M: DesiredMotion<T, NX>> DesiredMotion<T, NX>
    for Stretched<M, T>
{
    fn duration(&self) -> T {
        self.motion.duration() * self.factor
    }

    fn derivatives(&self, t: T) -> Derivatives<T, NX> {
        in_time(self.motion.derivatives(t / self.factor), self.factor)
    }

    fn position(&self, t: T) -> SVector<T, NX> {
        self.motion.position(t / self.factor)
    }
}
