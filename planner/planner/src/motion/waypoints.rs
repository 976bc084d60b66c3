//! Splines through waypoints.

use super::transfer::control_points;
use super::{Bezier, Derivatives, DesiredMotion, at_rest, check_point};
use crate::Error;
use crate::linear_algebra::solve;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::Ordered;

/// A point to pass, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint<T: Ordered, const NX: usize> {
    /// Seconds since the motion's start; the first is at 0.
    pub time: T,
    /// In the output's unit (metres).
    pub position: SVector<T, NX>,
}

/// What a [`Waypoints`] spline stores at a point; the caller owns it.
#[derive(Clone, Copy, Debug)]
pub struct Knot<T: Ordered, const NX: usize> {
    time: T,
    derivatives: Derivatives<T, NX>,
    /// Of the elimination: what the next knot's derivatives are multiplied with.
    upper: SMatrix<T, 4, 4>,
}

impl<T: Ordered, const NX: usize> Default for Knot<T, NX> {
    fn default() -> Self {
        Self { time: T::zero(), derivatives: [SVector::zeros(); 5], upper: SMatrix::zeros() }
    }
}

/// The smoothest curve through waypoints: of all it has the least ∫‖x⁽⁵⁾‖² dt. Its pieces are
/// polynomials of ninth degree that meet with eight continuous derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Waypoints<'a, T: Ordered, const NX: usize> {
    knots: &'a [Knot<T, NX>],
}

impl<'a, T: Ordered, const NX: usize> Waypoints<'a, T, NX> {
    /// From rest to rest.
    ///
    /// # Errors
    ///
    /// As [`with_ends`](Self::with_ends).
    pub fn new(waypoints: &[Waypoint<T, NX>], knots: &'a mut [Knot<T, NX>]) -> Result<Self, Error> {
        Self::with_ends(waypoints, [[SVector::zeros(); 4]; 2], knots)
    }

    /// With given velocity, acceleration, jerk and snap at the start and at the end.
    ///
    /// # Errors
    ///
    /// Fewer than two waypoints, less storage than waypoints, times that do not start at 0 or do not
    /// rise, a number that is not finite.
    pub fn with_ends(
        waypoints: &[Waypoint<T, NX>],
        ends: [[SVector<T, NX>; 4]; 2],
        knots: &'a mut [Knot<T, NX>],
    ) -> Result<Self, Error> {
        check(waypoints, knots.len())?;
        for derivative in ends.iter().flatten() {
            check_point("derivatives at the ends", derivative)?;
        }
        let knots = &mut knots[..waypoints.len()];
        for (knot, waypoint) in knots.iter_mut().zip(waypoints) {
            *knot = Knot {
                time: waypoint.time,
                derivatives: at_rest(waypoint.position),
                upper: SMatrix::zeros(),
            };
        }
        let last = knots.len() - 1;
        for (knot, end) in [(0, &ends[0]), (last, &ends[1])] {
            knots[knot].derivatives[1..].copy_from_slice(end);
        }
        eliminate(knots).ok_or(Error::Singular { matrix: "waypoint spline" })?;
        Ok(Self { knots })
    }

    /// The knots around a time.
    fn piece(&self, t: T) -> Option<(&'a Knot<T, NX>, &'a Knot<T, NX>)> {
        let pairs = self.knots.iter().zip(self.knots.iter().skip(1));
        let mut found = None;
        for pair in pairs {
            if found.is_some() && t < pair.0.time {
                break;
            }
            found = Some(pair);
        }
        found
    }
}

fn check<T: Ordered, const NX: usize>(
    waypoints: &[Waypoint<T, NX>],
    storage: usize,
) -> Result<(), Error> {
    if waypoints.len() < 2 {
        return Err(Error::Length { field: "waypoints", found: waypoints.len(), expected: 2 });
    }
    if storage < waypoints.len() {
        let expected = waypoints.len();
        return Err(Error::Length { field: "knots for the waypoints", found: storage, expected });
    }
    let mut previous = None;
    for (index, waypoint) in waypoints.iter().enumerate() {
        check_point("coordinates of a waypoint", &waypoint.position)?;
        let time = waypoint.time;
        let fits = match previous {
            None => time == T::zero(),
            Some(previous) => time.is_finite() && time > previous,
        };
        if !fits {
            return Err(Error::InvalidEntry {
                field: "times of the waypoints",
                index,
                value: time.to_f64(),
                expected: "0 first, then rising",
            });
        }
        previous = Some(time);
    }
    Ok(())
}

/// Derivatives 5 to 8 at both ends of a piece, by the four free derivatives at its start and its goal,
/// and by the positions.
struct PieceResponse<T: Ordered> {
    /// `[end][of]`: at end `end` by the derivatives of end `of`.
    free: [[SMatrix<T, 4, 4>; 2]; 2],
    /// `[end]`: by the goal's position less the start's.
    way: [SVector<T, 4>; 2],
}

impl<T: Ordered> PieceResponse<T> {
    fn new(duration: T) -> Self {
        let mut response = Self { free: [[SMatrix::zeros(); 2]; 2], way: [SVector::zeros(); 2] };
        for of in 0..2 {
            for order in 0..5 {
                let mut ends = [[SVector::<T, 1>::zeros(); 5]; 2];
                ends[of][order][0] = T::one();
                let points = control_points(&ends[0], &ends[1], duration);
                for end in 0..2 {
                    let derivatives = high_derivatives(&points, duration, end == 1);
                    if order > 0 {
                        response.free[end][of].set_column(order - 1, &derivatives);
                    } else if of == 1 {
                        response.way[end] = derivatives;
                    }
                }
            }
        }
        response
    }
}

/// Derivatives 5 to 8 of a Bézier curve of ninth degree at an end: n!/(n−r)! h⁻ʳ Δʳb.
fn high_derivatives<T: Ordered>(
    points: &[SVector<T, 1>; 10],
    duration: T,
    at_end: bool,
) -> SVector<T, 4> {
    let mut table = points.map(|point| point[0]);
    let mut derivatives = SVector::zeros();
    let mut factor = T::one();
    for order in 1..=8 {
        for k in 0..10 - order {
            table[k] = table[k + 1] - table[k];
        }
        factor *= T::from_f64((10 - order) as f64) / duration;
        if order >= 5 {
            let k = if at_end { 9 - order } else { 0 };
            derivatives[order - 5] = table[k] * factor;
        }
    }
    derivatives
}

/// Block elimination: derivatives 5 to 8 are continuous at every inner knot.
fn eliminate<T: Ordered, const NX: usize>(knots: &mut [Knot<T, NX>]) -> Option<()> {
    let free = |knot: &Knot<T, NX>| SMatrix::<T, 4, NX>::from_fn(|i, j| knot.derivatives[i + 1][j]);
    for index in 1..knots.len().saturating_sub(1) {
        let [before, here, after] = [knots[index - 1], knots[index], knots[index + 1]];
        let left = PieceResponse::new(here.time - before.time);
        let right = PieceResponse::new(after.time - here.time);
        let mut diagonal = left.free[1][1] - right.free[0][0];
        let upper = -right.free[0][1];
        let ways = [
            here.derivatives[0] - before.derivatives[0],
            after.derivatives[0] - here.derivatives[0],
        ];
        let mut known = right.way[0] * ways[1].transpose() - left.way[1] * ways[0].transpose();
        // The knot before is known (the first) or eliminated: d = known − upper · next.
        known -= left.free[1][0] * free(&before);
        diagonal -= left.free[1][0] * before.upper;
        let next_is_last = index + 2 == knots.len();
        if next_is_last {
            known -= upper * free(&after);
        } else {
            knots[index].upper = solve(diagonal, upper)?;
        }
        set_free(&mut knots[index], &solve(diagonal, known)?);
    }
    for index in (1..knots.len().saturating_sub(2)).rev() {
        let next = free(&knots[index + 1]);
        let found = free(&knots[index]) - knots[index].upper * next;
        set_free(&mut knots[index], &found);
    }
    Some(())
}

fn set_free<T: Ordered, const NX: usize>(knot: &mut Knot<T, NX>, free: &SMatrix<T, 4, NX>) {
    for (i, derivative) in knot.derivatives.iter_mut().skip(1).enumerate() {
        for (j, entry) in derivative.iter_mut().enumerate() {
            *entry = free[(i, j)];
        }
    }
}

impl<T: Ordered, const NX: usize> DesiredMotion<T, NX> for Waypoints<'_, T, NX> {
    fn duration(&self) -> T {
        self.knots.last().map_or_else(T::zero, |knot| knot.time)
    }

    fn derivatives(&self, t: T) -> Derivatives<T, NX> {
        let Some((from, to)) = self.piece(t) else {
            return [SVector::zeros(); 5];
        };
        let duration = to.time - from.time;
        let points = control_points(&from.derivatives, &to.derivatives, duration);
        Bezier::unchecked(&points, duration).derivatives(t - from.time)
    }
}
