//! Motions in two phases, each with shape sets of its own (Sec. V: the lateral move with the arms).

use crate::Error;
use crate::motion::{Derivatives, DesiredMotion, Transfer};
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// A straight line in two halves of equal duration that meet at cruise speed, without acceleration,
/// jerk and snap: one set of arms accelerates the robot, another brakes it.
///
/// Each half is planned on its own, with its own weighting. Where they meet the planned shape, its
/// rate and its acceleration are zero in both. The speed rises along the smooth step of degree seven
/// and falls the same way, so that the acceleration has one sign in each half: no arm crosses zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoPhases<T: Ordered, const NX: usize> {
    /// Accelerates, and brakes.
    pub halves: [Transfer<T, NX>; 2],
}

impl<T: Ordered, const NX: usize> TwoPhases<T, NX> {
    /// From rest to rest in `duration` seconds.
    ///
    /// # Errors
    ///
    /// A point that is not finite, a duration that is not positive and finite.
    pub fn new(from: SVector<T, NX>, to: SVector<T, NX>, duration: T) -> Result<Self, Error> {
        let half = duration * T::from_f64(0.5);
        let (middle, zero) = ((from + to) * T::from_f64(0.5), SVector::zeros());
        // Half of the way at half of the final speed.
        let cruise = (to - from) / half;
        Ok(Self {
            halves: [
                Transfer::between([from, zero], [middle, cruise], half)?,
                Transfer::between([middle, cruise], [to, zero], half)?,
            ],
        })
    }
}

impl<T: Ordered, const NX: usize> DesiredMotion<T, NX> for TwoPhases<T, NX> {
    fn duration(&self) -> T {
        self.halves[0].duration() + self.halves[1].duration()
    }

    fn derivatives(&self, t: T) -> Derivatives<T, NX> {
        let half = self.halves[0].duration();
        if t < half { self.halves[0].derivatives(t) } else { self.halves[1].derivatives(t - half) }
    }
}
