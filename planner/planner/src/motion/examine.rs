//! Properties of any desired motion: its class, its peaks, the time it needs.

use super::{Derivatives, DesiredMotion, Stretched};
use crate::Error;
use crate::linear_algebra::{exceeds, norm};
use shapebot_dynamics::Ordered;

/// A derivative that is not continuous.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump<T> {
    /// 0 is the position, 1 the velocity, up to 4.
    pub derivative: usize,
    /// When, seconds.
    pub time: T,
    /// Norm of the jump, in the output's unit per secondʳ.
    pub size: T,
}

/// Intervals in which jumps and peaks are looked for.
const INTERVALS: usize = 512;

/// The lowest derivative up to the fourth that jumps, where it does so first: `None` for a motion of
/// class C⁴. The joints with the rest before and after the motion count.
///
/// Every interval in which a derivative changes noticeably is halved until the change vanishes or the
/// numbers' resolution is reached. Jumps below 1e-3 of a derivative's own size pass.
pub fn first_jump<T: Ordered, M, const NX: usize>(motion: &M) -> Option<Jump<T>>
where
    M: DesiredMotion<T, NX> + ?Sized,
{
    let sizes = sizes(motion);
    (0..5).find_map(|derivative| {
        let smallest = sizes[derivative] * T::from_f64(1e-3);
        let margin = motion.duration() / T::from_f64(INTERVALS as f64);
        let time = |i: usize| T::from_f64(i as f64 - 1.0) * margin;
        (0..INTERVALS + 2).find_map(|i| {
            let jump = close_in(motion, derivative, [time(i), time(i + 1)], smallest)?;
            Some(Jump { derivative, ..jump })
        })
    })
}

/// Halves an interval around the larger change.
fn close_in<T: Ordered, M, const NX: usize>(
    motion: &M,
    derivative: usize,
    [mut low, mut high]: [T; 2],
    smallest: T,
) -> Option<Jump<T>>
where
    M: DesiredMotion<T, NX> + ?Sized,
{
    let value = |time: T| motion.derivatives(time)[derivative];
    let (mut below, mut above) = (value(low), value(high));
    let half = T::from_f64(0.5);
    loop {
        let size = norm(&(above - below));
        if !exceeds(size, smallest) {
            return None;
        }
        let middle = low + (high - low) * half;
        if !(middle > low && middle < high) {
            return Some(Jump { derivative, time: high, size });
        }
        let between = value(middle);
        if norm(&(between - below)) > norm(&(above - between)) {
            (high, above) = (middle, between);
        } else {
            (low, below) = (middle, between);
        }
    }
}

/// Largest norm of each derivative on the grid; of the position the way.
fn sizes<T: Ordered, M, const NX: usize>(motion: &M) -> [T; 5]
where
    M: DesiredMotion<T, NX> + ?Sized,
{
    let start = motion.position(T::zero());
    let mut sizes = [T::zero(); 5];
    for i in 0..=INTERVALS {
        let time = motion.duration() * T::from_f64(i as f64 / INTERVALS as f64);
        let mut derivatives: Derivatives<T, NX> = motion.derivatives(time);
        derivatives[0] -= start;
        for (size, derivative) in sizes.iter_mut().zip(&derivatives) {
            let norm = norm(derivative);
            if norm > *size {
                *size = norm;
            }
        }
    }
    sizes
}

/// The largest speed and acceleration of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionPeaks<T> {
    /// ‖ẋ^d‖, metres per second.
    pub speed: T,
    /// ‖ẍ^d‖, metres per second squared.
    pub acceleration: T,
}

/// The largest speed and acceleration of a motion, on a grid that is refined around the largest.
pub fn peaks<T: Ordered, M, const NX: usize>(motion: &M) -> MotionPeaks<T>
where
    M: DesiredMotion<T, NX> + ?Sized,
{
    MotionPeaks { speed: peak(motion, 1), acceleration: peak(motion, 2) }
}

fn peak<T: Ordered, M, const NX: usize>(motion: &M, derivative: usize) -> T
where
    M: DesiredMotion<T, NX> + ?Sized,
{
    let value = |time: T| norm(&motion.derivatives(time)[derivative]);
    let number = |x: f64| T::from_f64(x);
    let mut step = motion.duration() / number(INTERVALS as f64);
    let mut best = (T::zero(), value(T::zero()));
    for i in 1..=INTERVALS {
        let time = step * number(i as f64);
        let found = value(time);
        if found > best.1 {
            best = (time, found);
        }
    }
    // Around the best sample the motion is smooth: the step shrinks with every round.
    for _ in 0..24 {
        step *= number(0.5);
        for time in [best.0 - step, best.0 + step] {
            if time >= T::zero() && time <= motion.duration() {
                let found = value(time);
                if found > best.1 {
                    best = (time, found);
                }
            }
        }
    }
    best.1
}

/// The shortest duration in which a motion keeps to a speed and an acceleration: along the same path
/// the speed goes with the inverse of the duration, the acceleration with its inverse square.
///
/// # Errors
///
/// A bound that is not positive (infinity is no bound), a motion with peaks that are not finite.
pub fn minimum_duration<T: Ordered, M, const NX: usize>(
    motion: &M,
    bounds: MotionPeaks<T>,
) -> Result<T, Error>
where
    M: DesiredMotion<T, NX> + ?Sized,
{
    let peaks = peaks(motion);
    for (field, value) in
        [("speed bound", bounds.speed), ("acceleration bound", bounds.acceleration)]
    {
        if !exceeds(value, T::zero()) {
            return Err(Error::Invalid { field, value: value.to_f64(), expected: "above 0" });
        }
    }
    for (quantity, value) in
        [("desired speed", peaks.speed), ("desired acceleration", peaks.acceleration)]
    {
        if !value.is_finite() {
            return Err(Error::NonFinite { quantity, time: motion.duration().to_f64() });
        }
    }
    let (by_speed, by_acceleration) =
        (peaks.speed / bounds.speed, (peaks.acceleration / bounds.acceleration).sqrt());
    let factor = if by_speed > by_acceleration { by_speed } else { by_acceleration };
    Ok(motion.duration() * factor)
}

/// The motion in the shortest time that its bounds allow, see [`minimum_duration`].
///
/// # Errors
///
/// Those of [`minimum_duration`]; a motion that stands still has no shortest time.
pub fn fastest<T: Ordered, M, const NX: usize>(
    motion: M,
    bounds: MotionPeaks<T>,
) -> Result<Stretched<M, T>, Error>
where
    M: DesiredMotion<T, NX>,
{
    let factor = minimum_duration(&motion, bounds)? / motion.duration();
    Stretched::new(motion, factor)
}
