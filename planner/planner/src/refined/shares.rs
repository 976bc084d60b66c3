//! Shares of the shape sets, chosen from limits: what the paper leaves to future work.

use super::solve::refine;
use super::task::Refinement;
use super::workspace::Workspace;
use crate::Error;
use crate::constraint::ShapeConstraint;
use crate::gain::Weighting;
use crate::linear_algebra::{inverse, largest};
use crate::motion::DesiredMotion;
use crate::planner::Task;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Ordered, ShapeAccelerated, ShapeSet};

/// Which shape sets are to move least; the others go to their limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spare {
    /// The smallest lean: actuated sets (arms) do as much as their limits allow.
    Unactuated,
    /// The smallest movement of the actuated sets: the lean does as much as its limits allow.
    Actuated,
}

/// How closely the limits are approached, and the most plans made.
const APPROACH: f64 = 0.005;
const ATTEMPTS: usize = 16;

/// Chooses the contribution ratios of [`Weighting::Contributions`], one per shape set: the sets that
/// are not spared go to the limits of the refinement and the declared ranges, or do all the work
/// within them; the spared ones do the rest. Constrained sets get nothing.
///
/// Plans are made until the largest of the filled sets' peaks is within half a percent of its limit;
/// the task's own weighting does not matter. The workspace holds no plan afterwards.
///
/// # Errors
///
/// Those of [`refine`]: [`Error::LimitExceeded`] if there are no shares with which all limits hold;
/// [`Error::Length`] if `shares` is not one per shape set; [`Error::Invalid`] without a set to spare.
pub fn choose_shares<R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
    robot: &R,
    task: &Task<'_, M, T, NS, C>,
    refinement: &Refinement<T, NX, NS>,
    spare: Spare,
    shares: &mut [T],
    workspace: &mut Workspace<T, NX, POINTS>,
) -> Result<(), Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let sets = robot.shape_description().shape_sets;
    if shares.len() != sets.len() {
        let (field, found) = ("shares", shares.len());
        return Err(Error::Length { field, found, expected: sets.len() });
    }
    let chooser = Chooser { robot, constraint: task.constraint, sets, spare, refinement };
    chooser.spread(T::zero(), shares)?;
    // The spared sets alone; where their own limits stop them, half of the work.
    let mut filled = chooser.first_guess(task, shares, workspace)?;
    let mut bracket = (T::zero(), T::one());
    let mut last = None;
    for _ in 0..ATTEMPTS {
        chooser.spread(filled, shares)?;
        let trial = with_shares(task, shares);
        let utilisation = match refine(robot, &trial, refinement, workspace) {
            Ok(plan) => {
                let utilisation = chooser.utilisation(&plan.report().peak_shape);
                last = None;
                if filled >= T::one() || utilisation >= T::from_f64(1.0 - 2.0 * APPROACH) {
                    return Ok(());
                }
                bracket.0 = filled;
                utilisation
            }
            Err(error @ Error::LimitExceeded { coordinate, value, lower, upper, .. }) => {
                last = Some(error);
                let excess = if value > upper { value / upper } else { value / lower };
                if chooser.is_filled(coordinate) {
                    bracket.1 = filled;
                    T::from_f64(excess)
                } else {
                    // The spared sets exceed their limits: the others have to do more.
                    bracket.0 = filled;
                    T::from_f64(0.5)
                }
            }
            Err(error) => return Err(error),
        };
        filled = next(filled, utilisation, bracket);
    }
    match last {
        Some(error) => Err(error),
        None => Ok(()),
    }
}

/// The peaks are nearly proportional to the shares; else the bracket is halved.
fn next<T: Ordered>(filled: T, utilisation: T, (low, high): (T, T)) -> T {
    let aim = filled * T::from_f64(1.0 - APPROACH) / utilisation;
    if aim >= T::one() && high >= T::one() {
        return T::one();
    }
    if aim > low && aim < high { aim } else { (low + high) * T::from_f64(0.5) }
}

fn with_shares<'t, M: ?Sized, C: Copy, T: Ordered, const NS: usize>(
    task: &Task<'t, M, T, NS, C>,
    shares: &'t [T],
) -> Task<'t, M, T, NS, C> {
    task.weighting(Weighting::Contributions(shares))
}

struct Chooser<'r, R: ?Sized, C, T: Ordered, const NX: usize, const NS: usize> {
    robot: &'r R,
    constraint: C,
    sets: &'r [ShapeSet],
    spare: Spare,
    refinement: &'r Refinement<T, NX, NS>,
}

impl<R, C, T, const NX: usize, const NS: usize> Chooser<'_, R, C, T, NX, NS>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    fn is_free(&self, set: &ShapeSet) -> bool {
        !self.constraint.holds(set.first)
    }

    fn is_spared(&self, set: &ShapeSet) -> bool {
        set.actuated == (self.spare == Spare::Actuated)
    }

    /// Whether a coordinate belongs to a set that is to be filled.
    fn is_filled(&self, coordinate: &str) -> bool {
        let coordinates = self.robot.shape_description().shape_coordinates();
        let index = coordinates.iter().position(|c| c.name == coordinate).unwrap_or(NS);
        let within =
            |set: &&ShapeSet| (set.first..set.first.saturating_add(set.len)).contains(&index);
        self.sets.iter().find(within).is_some_and(|set| !self.is_spared(set))
    }

    /// Limit of a shape coordinate.
    fn limit(&self, index: usize) -> T {
        let coordinate = self.robot.shape_description().shape_coordinates().get(index);
        let range = coordinate.map_or(f64::INFINITY, |c| c.upper.abs().min(c.lower.abs()));
        let limit = self.refinement.limits.and_then(|limits| limits.get(index).copied());
        T::from_f64(range.min(limit.map_or(f64::INFINITY, |limit| limit.to_f64())))
    }

    /// Divides `filled` among the filled sets and the rest among the spared, by what a set can do: its
    /// limits through its block of K⁰_qs.
    fn spread(&self, filled: T, shares: &mut [T]) -> Result<(), Error> {
        let shape_gain = self.robot.shape_gain();
        let mut sums = [T::zero(); 2];
        for (share, set) in shares.iter_mut().zip(self.sets) {
            *share = T::zero();
            let block = SMatrix::<T, NX, NX>::from_fn(|i, j| {
                shape_gain.get((i, set.first + j)).copied().unwrap_or_else(T::zero)
            });
            let Some(inverse) = inverse(block).filter(|_| self.is_free(set)) else {
                continue;
            };
            let needed = largest(inverse.iter().copied());
            let limit = (0..NX).map(|k| self.limit(set.first + k)).fold(
                T::from_f64(f64::INFINITY),
                |least, limit| if limit < least { limit } else { least },
            );
            let able = if limit.is_finite() { limit / needed } else { T::one() };
            *share = able;
            sums[usize::from(self.is_spared(set))] += able;
        }
        if !(sums[0] > T::zero() && sums[1] > T::zero()) {
            return Err(Error::Invalid {
                field: "number of kinds of free shape sets",
                value: if sums[0] + sums[1] > T::zero() { 1.0 } else { 0.0 },
                expected: "2: one to move, one to spare",
            });
        }
        let rest = T::one() - filled;
        for (share, set) in shares.iter_mut().zip(self.sets) {
            let spared = usize::from(self.is_spared(set));
            *share *= if spared == 1 { rest } else { filled } / sums[spared];
        }
        Ok(())
    }

    /// A first share of the filled sets, from what the spared ones do alone.
    fn first_guess<M, const POINTS: usize>(
        &self,
        task: &Task<'_, M, T, NS, C>,
        shares: &[T],
        workspace: &mut Workspace<T, NX, POINTS>,
    ) -> Result<T, Error>
    where
        M: DesiredMotion<T, NX> + ?Sized,
    {
        let trial = with_shares(task, shares);
        let plan = match refine(self.robot, &trial, self.refinement, workspace) {
            Ok(plan) => plan,
            Err(Error::LimitExceeded { .. }) => return Ok(T::from_f64(0.5)),
            Err(error) => return Err(error),
        };
        // What the filled sets would do in place of the spared ones, at the same accelerations.
        let mut able = T::zero();
        let acceleration = self.robot.shape_gain() * plan.report().peak_shape;
        let size = largest(acceleration.iter().copied());
        for set in self.sets.iter().filter(|set| self.is_free(set) && !self.is_spared(set)) {
            let shape_gain = self.robot.shape_gain();
            let block = SMatrix::<T, NX, NX>::from_fn(|i, j| shape_gain[(i, set.first + j)]);
            if let Some(inverse) = inverse(block) {
                able += self.limit(set.first) / largest(inverse.iter().copied());
            }
        }
        let guess = able / size;
        let (low, high) = (T::from_f64(0.01), T::one());
        Ok(if guess > high || !guess.is_finite() {
            high
        } else if guess < low {
            low
        } else {
            guess
        })
    }

    /// The largest fraction of its limit that a coordinate of the filled sets reaches.
    fn utilisation(&self, peaks: &SVector<T, NS>) -> T {
        let mut most = T::zero();
        for set in self.sets.iter().filter(|set| self.is_free(set) && !self.is_spared(set)) {
            for index in set.first..(set.first + set.len).min(NS) {
                let used = peaks[index] / self.limit(index);
                if used > most {
                    most = used;
                }
            }
        }
        most
    }
}
