//! What a robot is to do over time.

use crate::Error;
use nalgebra::SVector;
use shapebot_control::Target;
use shapebot_dynamics::Robot;
use shapebot_planner::Row;

/// What is to happen at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment<const N: usize, const NX: usize, const NS: usize> {
    /// The plan, with its feedforward.
    pub target: Target<f64, N, NX, NS>,
    /// Where the plan has the output.
    pub planned: SVector<f64, NX>,
    /// Where the output is desired, and its velocity.
    pub desired: [SVector<f64, NX>; 2],
}

/// A plan over time, seconds from the start of the run.
pub trait Reference<const N: usize, const NX: usize, const NS: usize> {
    /// When it ends and stands still, s.
    fn duration(&self) -> f64;
    /// At a time; before the start and after the end as there.
    fn at(&self, time: f64) -> Moment<N, NX, NS>;
}

impl<const N: usize, const NX: usize, const NS: usize, R> Reference<N, NX, NS> for &R
where
    R: Reference<N, NX, NS> + ?Sized,
{
    fn duration(&self) -> f64 {
        (**self).duration()
    }
    fn at(&self, time: f64) -> Moment<N, NX, NS> {
        (**self).at(time)
    }
}

/// A motion in equal steps of time. Between them coordinates are quintic polynomials through value,
/// rate and acceleration, forces and outputs straight lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Table<const N: usize, const NX: usize, const NS: usize> {
    step: f64,
    moments: Vec<Moment<N, NX, NS>>,
}

impl<const N: usize, const NX: usize, const NS: usize> Table<N, NX, NS> {
    /// From moments `step` seconds apart.
    ///
    /// # Errors
    ///
    /// [`Error::Table`] for fewer than two moments or a step that is not positive.
    pub fn new(step: f64, moments: Vec<Moment<N, NX, NS>>) -> Result<Self, Error> {
        if moments.len() < 2 {
            return Err(Error::Table { reason: "fewer than two samples" });
        }
        if !(step.is_finite() && step > 0.0) {
            return Err(Error::Table { reason: "times do not grow" });
        }
        Ok(Self { step, moments })
    }

    /// From the equidistant rows of a plan for `robot`, which also gives the feedforward. Time zero is
    /// the first row's. Rows of a second plan may follow: [`Table::then`].
    ///
    /// # Errors
    ///
    /// [`Error::Table`] for fewer than two rows or uneven times.
    pub fn from_rows<R>(
        robot: &R,
        rows: impl IntoIterator<Item = Row<f64, NX, NS>>,
    ) -> Result<Self, Error>
    where
        R: Robot<f64, N, NX, NS>,
    {
        let (mut times, mut moments) = (Vec::new(), Vec::new());
        for row in rows {
            times.push(row.plan.time);
            moments.push(moment(robot, &row));
        }
        let step = match times.as_slice() {
            [first, .., last] => (last - first) / (times.len() - 1) as f64,
            _ => f64::NAN,
        };
        if times.windows(2).any(|pair| ((pair[1] - pair[0]) - step).abs() > 1e-6 * step.abs()) {
            return Err(Error::Table { reason: "times do not grow evenly" });
        }
        Self::new(step, moments)
    }

    /// Goes on with another table, whose first moment is this one's last.
    ///
    /// # Errors
    ///
    /// [`Error::Table`] if their steps differ.
    pub fn then(mut self, next: &Self) -> Result<Self, Error> {
        if (self.step - next.step).abs() > 1e-9 * self.step {
            return Err(Error::Table { reason: "steps of joined motions differ" });
        }
        self.moments.extend_from_slice(&next.moments[1..]);
        Ok(self)
    }

    /// Seconds between moments.
    #[must_use]
    pub const fn step(&self) -> f64 {
        self.step
    }

    /// The moments.
    #[must_use]
    pub fn moments(&self) -> &[Moment<N, NX, NS>] {
        &self.moments
    }
}

fn moment<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    row: &Row<f64, NX, NS>,
) -> Moment<N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    let plan = &row.plan;
    let target = Target {
        position: [row.position, row.velocity, row.acceleration],
        shape: [plan.shape, plan.shape_velocity, plan.shape_acceleration],
        force: SVector::zeros(),
    };
    Moment {
        target: target.with_feedforward(robot),
        planned: row.output,
        desired: [plan.desired.output[0], plan.desired.output[1]],
    }
}

impl<const N: usize, const NX: usize, const NS: usize> Reference<N, NX, NS> for Table<N, NX, NS> {
    fn duration(&self) -> f64 {
        self.step * (self.moments.len() - 1) as f64
    }

    fn at(&self, time: f64) -> Moment<N, NX, NS> {
        let last = self.moments.len() - 1;
        let place = (time / self.step).max(0.0);
        // Times that are meant to be a sample's own are that sample.
        let nearest = place.round();
        if nearest as usize >= last {
            return standing(&self.moments[last], nearest as usize > last);
        }
        if (place - nearest).abs() < 1e-9 {
            return self.moments[nearest as usize];
        }
        let index = (place.floor() as usize).min(last - 1);
        between(&self.moments[index], &self.moments[index + 1], place - index as f64, self.step)
    }
}

/// The last moment, and what follows: rest in its place.
fn standing<const N: usize, const NX: usize, const NS: usize>(
    last: &Moment<N, NX, NS>,
    past: bool,
) -> Moment<N, NX, NS> {
    let mut moment = *last;
    if past {
        moment.target.position[1..].fill(SVector::zeros());
        moment.target.shape[1..].fill(SVector::zeros());
        moment.desired[1] = SVector::zeros();
    }
    moment
}

fn between<const N: usize, const NX: usize, const NS: usize>(
    a: &Moment<N, NX, NS>,
    b: &Moment<N, NX, NS>,
    part: f64,
    step: f64,
) -> Moment<N, NX, NS> {
    let line = |a: SVector<f64, NX>, b: SVector<f64, NX>| a + (b - a) * part;
    Moment {
        target: Target {
            position: quintic(&a.target.position, &b.target.position, part, step),
            shape: quintic(&a.target.shape, &b.target.shape, part, step),
            force: a.target.force + (b.target.force - a.target.force) * part,
        },
        planned: line(a.planned, b.planned),
        desired: [line(a.desired[0], b.desired[0]), line(a.desired[1], b.desired[1])],
    }
}

/// Quintic Hermite interpolation with its first two derivatives at s ∈ [0, 1] of a step of h seconds.
fn quintic<const L: usize>(
    a: &[SVector<f64, L>; 3],
    b: &[SVector<f64, L>; 3],
    s: f64,
    h: f64,
) -> [SVector<f64, L>; 3] {
    // Powers of s from both ends' derivatives: the first three are the start's.
    let (c0, c1, c2) = (a[0], a[1] * h, a[2] * (0.5 * h * h));
    let gap = b[0] - c0 - c1 - c2;
    let slope = b[1] * h - c1 - c2 * 2.0;
    let bend = b[2] * (h * h) - c2 * 2.0;
    let c3 = gap * 10.0 - slope * 4.0 + bend * 0.5;
    let c4 = gap * -15.0 + slope * 7.0 - bend;
    let c5 = gap * 6.0 - slope * 3.0 + bend * 0.5;
    [
        c0 + (c1 + (c2 + (c3 + (c4 + c5 * s) * s) * s) * s) * s,
        (c1 + (c2 * 2.0 + (c3 * 3.0 + (c4 * 4.0 + c5 * (5.0 * s)) * s) * s) * s) / h,
        (c2 * 2.0 + (c3 * 6.0 + (c4 * 12.0 + c5 * (20.0 * s)) * s) * s) / (h * h),
    ]
}

#[cfg(test)]
mod tests {
    use super::quintic;
    use nalgebra::Vector1;

    #[test]
    fn interpolation_is_exact_for_a_quintic() {
        let value = |t: f64| {
            [
                1.0 + t - 2.0 * t.powi(3) + t.powi(5),
                1.0 - 6.0 * t * t + 5.0 * t.powi(4),
                -12.0 * t + 20.0 * t.powi(3),
            ]
            .map(Vector1::new)
        };
        let (t0, h) = (0.3, 0.7);
        for s in [0.0, 0.2, 0.9, 1.0] {
            let found = quintic(&value(t0), &value(t0 + h), s, h);
            for (found, expected) in found.iter().zip(value(t0 + s * h)) {
                assert!((found - expected).norm() < 1e-12, "{s}: {found} {expected}");
            }
        }
    }
}
