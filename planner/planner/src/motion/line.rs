//! A straight line in output space.

use super::{
    Derivatives, DesiredMotion, SmoothStep, at_rest, check_duration, check_point, in_time,
};
use crate::Error;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// From one point to another along a straight line, timed by a [`SmoothStep`].
///
/// ```
/// use shapebot_planner::motion::{DesiredMotion, Line};
///
/// let line = Line::new([0.0].into(), [2.0].into(), 5.0, 9)?;
/// let middle = line.derivatives(2.5);
/// assert_eq!(middle[0][0], 1.0);
/// assert_eq!(middle[1][0], 2.0 / 5.0 * 315.0 / 128.0);
/// # Ok::<(), shapebot_planner::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<T: Ordered, const NX: usize> {
    from: SVector<T, NX>,
    to: SVector<T, NX>,
    duration: T,
    step: SmoothStep,
}

impl<T: Ordered, const NX: usize> Line<T, NX> {
    /// A line between two points of output space (metres) in `duration` seconds, with the smooth step
    /// of an odd `degree` from 7 to 17.
    ///
    /// # Errors
    ///
    /// A point or duration that is not finite, a duration that is not positive, another degree.
    pub fn new(
        from: SVector<T, NX>,
        to: SVector<T, NX>,
        duration: T,
        degree: usize,
    ) -> Result<Self, Error> {
        check_point("start", &from)?;
        check_point("goal", &to)?;
        check_duration(duration)?;
        Ok(Self { from, to, duration, step: SmoothStep::new(degree)? })
    }
}

impl<T: Ordered, const NX: usize> DesiredMotion<T, NX> for Line<T, NX> {
    fn duration(&self) -> T {
        self.duration
    }

    fn derivatives(&self, t: T) -> Derivatives<T, NX> {
        if t < T::zero() {
            return at_rest(self.from);
        }
        if t > self.duration {
            return at_rest(self.to);
        }
        let way = self.to - self.from;
        let mut x = self.step.derivatives(t / self.duration).map(|s| way * s);
        x[0] += self.from;
        in_time(x, self.duration)
    }

    fn position(&self, t: T) -> SVector<T, NX> {
        self.from + (self.to - self.from) * self.step.value(t / self.duration)
    }
}
