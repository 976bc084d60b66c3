//! Desired motions in output space.

mod bezier;
mod examine;
mod legs;
mod line;
mod smooth_step;
mod stretched;
mod transfer;
mod waypoints;

pub use bezier::{Bezier, MAX_BEZIER_DEGREE};
pub use examine::{Jump, MotionPeaks, fastest, first_jump, minimum_duration, peaks};
pub use legs::Legs;
pub use line::Line;
pub use smooth_step::SmoothStep;
pub use stretched::Stretched;
pub use transfer::{Rest, Transfer};
pub use waypoints::{Knot, Waypoint, Waypoints};

pub use crate::refined::Sampled;

use crate::Error;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// A quantity and its first four time derivatives: `[r]` is dʳ/dtʳ.
///
/// The planned shape is linear in the desired acceleration (Eq. 31), its rate and acceleration in the
/// third and fourth derivative.
pub type Derivatives<T, const NX: usize> = [SVector<T, NX>; 5];

/// A desired motion x^d(t) of a robot's output, in the output's unit (metres).
///
/// It should be four times continuously differentiable (Sec. IV-E), from rest to rest if the plan is
/// to start and end upright; the planner itself only needs finite values.
pub trait DesiredMotion<T: Ordered, const NX: usize> {
    /// Duration, seconds. The motion runs over 0 ≤ t ≤ duration.
    fn duration(&self) -> T;

    /// The motion and its derivatives at time `t`, seconds. Before the start and after the end the
    /// motion stands still at its end points.
    fn derivatives(&self, t: T) -> Derivatives<T, NX>;

    /// The motion alone, where that takes less than its derivatives.
    fn position(&self, t: T) -> SVector<T, NX> {
        self.derivatives(t)[0]
    }
}

impl<T: Ordered, const NX: usize, M: DesiredMotion<T, NX> + ?Sized> DesiredMotion<T, NX> for &M {
    fn duration(&self) -> T {
        (**self).duration()
    }
    fn derivatives(&self, t: T) -> Derivatives<T, NX> {
        (**self).derivatives(t)
    }
    fn position(&self, t: T) -> SVector<T, NX> {
        (**self).position(t)
    }
}

/// Turns derivatives with respect to t / duration into time derivatives.
fn in_time<T: Ordered, const NX: usize>(
    mut derivatives: Derivatives<T, NX>,
    duration: T,
) -> Derivatives<T, NX> {
    let rate = T::one() / duration;
    let mut power = T::one();
    for derivative in &mut derivatives {
        *derivative *= power;
        power *= rate;
    }
    derivatives
}

/// Standing still at `position`.
fn at_rest<T: Ordered, const NX: usize>(position: SVector<T, NX>) -> Derivatives<T, NX> {
    let mut derivatives = [SVector::zeros(); 5];
    derivatives[0] = position;
    derivatives
}

pub(crate) fn check_duration<T: Ordered>(duration: T) -> Result<(), Error> {
    if duration.is_finite() && duration > T::zero() {
        return Ok(());
    }
    Err(Error::Invalid {
        field: "duration",
        value: duration.to_f64(),
        expected: "a positive, finite number of seconds",
    })
}

/// A factor of time.
fn check_factor<T: Ordered>(factor: T) -> Result<(), Error> {
    if factor.is_finite() && factor > T::zero() {
        return Ok(());
    }
    let expected = "a positive, finite number";
    Err(Error::Invalid { field: "factor of the duration", value: factor.to_f64(), expected })
}

fn check_point<T: Ordered, const NX: usize>(
    field: &'static str,
    point: &SVector<T, NX>,
) -> Result<(), Error> {
    match point.iter().enumerate().find(|(_, x)| !x.is_finite()) {
        None => Ok(()),
        Some((index, x)) => Err(Error::InvalidEntry {
            field,
            index,
            value: x.to_f64(),
            expected: "a finite number",
        }),
    }
}
