//! Nelder and Mead's simplex method: no derivatives, more evaluations.

use super::{Minimum, Termination};
use crate::linear_algebra::{is_finite, largest};
use nalgebra::SMatrix;
use shapebot_dynamics::Ordered;

/// The method's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NelderMead<T: Ordered> {
    /// Most steps of the simplex; 0 keeps the starting point.
    pub max_iterations: usize,
    /// J_thres: ends at a cost at or below it.
    pub cost_threshold: T,
    /// ΔK_thres: ends when the simplex is at most this fraction of the parameters in size.
    pub step_tolerance: T,
    /// Ends when the costs of the simplex differ by at most this fraction.
    pub reduction_tolerance: T,
    /// Edge of the first simplex, as a fraction of the largest parameter.
    pub initial_edge: T,
}

impl<T: Ordered> Default for NelderMead<T> {
    fn default() -> Self {
        Self {
            max_iterations: 400,
            cost_threshold: T::zero(),
            step_tolerance: T::epsilon().sqrt(),
            reduction_tolerance: T::epsilon() * T::from_f64(64.0),
            initial_edge: T::from_f64(0.05),
        }
    }
}

/// A corner of the simplex.
#[derive(Clone, Copy)]
struct Corner<T: Ordered, const R: usize, const C: usize> {
    point: SMatrix<T, R, C>,
    cost: T,
}

/// R × C corners, and one more.
struct Simplex<T: Ordered, const R: usize, const C: usize> {
    best: Corner<T, R, C>,
    others: [[Corner<T, R, C>; C]; R],
}

impl<T: Ordered, const R: usize, const C: usize> Simplex<T, R, C> {
    /// The worst corner's place, its cost, and the next worst cost of all corners.
    fn worst(&self) -> ((usize, usize), T, T) {
        let mut place = (0, 0);
        let (mut worst, mut next) = (self.others[0][0].cost, self.best.cost);
        for (i, row) in self.others.iter().enumerate() {
            for (j, corner) in row.iter().enumerate() {
                if (i, j) == (0, 0) {
                    continue;
                }
                if corner.cost > worst {
                    next = worst;
                    worst = corner.cost;
                    place = (i, j);
                } else if corner.cost > next {
                    next = corner.cost;
                }
            }
        }
        (place, worst, next)
    }

    /// Puts the corner of the lowest cost first.
    fn sort(&mut self) {
        for corner in self.others.iter_mut().flatten() {
            if corner.cost < self.best.cost {
                core::mem::swap(corner, &mut self.best);
            }
        }
    }

    /// The middle of all corners but one.
    fn middle(&self, without: (usize, usize)) -> SMatrix<T, R, C> {
        let corners = self.others.iter().flatten();
        let sum = corners.fold(self.best.point, |sum, corner| sum + corner.point);
        let without = self.others[without.0][without.1].point;
        (sum - without) / T::from_f64((R * C) as f64)
    }

    /// The largest distance of a coordinate from the best corner's.
    fn size(&self) -> T {
        largest(self.others.iter().flatten().flat_map(|corner| {
            let difference = corner.point - self.best.point;
            core::iter::once(largest(difference.iter().copied()))
        }))
    }
}

impl<T: Ordered> NelderMead<T> {
    /// Minimises a cost from `start`.
    ///
    /// # Errors
    ///
    /// That of `cost` at the start. Elsewhere an error or a cost that is not finite counts as infinite.
    pub fn minimise<const R: usize, const C: usize, E>(
        &self,
        start: SMatrix<T, R, C>,
        mut cost: impl FnMut(&SMatrix<T, R, C>) -> Result<T, E>,
    ) -> Result<Minimum<T, R, C>, E> {
        let start_cost = cost(&start)?;
        let infinity = T::from_f64(f64::INFINITY);
        let mut corner = |point: SMatrix<T, R, C>| {
            let found = if is_finite(&point) { cost(&point).ok() } else { None };
            Corner { point, cost: found.filter(|cost| cost.is_finite()).unwrap_or(infinity) }
        };
        let best = Corner { point: start, cost: start_cost };
        if R * C == 0 || self.max_iterations == 0 || start_cost <= self.cost_threshold {
            let termination = if start_cost <= self.cost_threshold {
                Termination::SmallCost
            } else {
                Termination::IterationLimit
            };
            return Ok(Minimum {
                point: start,
                cost: start_cost,
                start_cost,
                iterations: 0,
                termination,
            });
        }
        let edge = self.initial_edge * largest(start.iter().copied());
        let edge = if edge > T::zero() { edge } else { self.initial_edge };
        let others = core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let mut point = start;
                point[(i, j)] += edge;
                corner(point)
            })
        });
        let mut simplex = Simplex { best, others };
        simplex.sort();
        let mut iterations = 0;
        let termination = loop {
            if let Some(reason) = self.finished(&simplex) {
                break reason;
            }
            if iterations >= self.max_iterations {
                break Termination::IterationLimit;
            }
            iterations += 1;
            advance(&mut simplex, &mut corner);
            simplex.sort();
        };
        let Corner { point, cost } = simplex.best;
        Ok(Minimum { point, cost, start_cost, iterations, termination })
    }

    fn finished<const R: usize, const C: usize>(
        &self,
        simplex: &Simplex<T, R, C>,
    ) -> Option<Termination> {
        let (_, worst, _) = simplex.worst();
        let best = simplex.best.cost;
        let size = largest(simplex.best.point.iter().copied());
        if best <= self.cost_threshold {
            Some(Termination::SmallCost)
        } else if simplex.size() <= self.step_tolerance * (size + self.step_tolerance) {
            let stuck = !worst.is_finite();
            Some(if stuck { Termination::NonFinite } else { Termination::SmallStep })
        } else if worst - best <= self.reduction_tolerance * best {
            Some(Termination::SmallReduction)
        } else {
            None
        }
    }
}

/// Reflects, expands, contracts or shrinks.
fn advance<T: Ordered, const R: usize, const C: usize>(
    simplex: &mut Simplex<T, R, C>,
    corner: &mut impl FnMut(SMatrix<T, R, C>) -> Corner<T, R, C>,
) {
    let half = T::from_f64(0.5);
    let (place, worst_cost, next_cost) = simplex.worst();
    let worst = simplex.others[place.0][place.1];
    let middle = simplex.middle(place);
    let away = middle - worst.point;
    let reflected = corner(middle + away);
    let accepted = if reflected.cost < simplex.best.cost {
        let expanded = corner(middle + away + away);
        Some(if expanded.cost < reflected.cost { expanded } else { reflected })
    } else if reflected.cost < next_cost {
        Some(reflected)
    } else {
        let side = if reflected.cost < worst_cost { half } else { -half };
        let contracted = corner(middle + away * side);
        let bound = if reflected.cost < worst_cost { reflected.cost } else { worst_cost };
        (contracted.cost < bound).then_some(contracted)
    };
    match accepted {
        Some(accepted) => simplex.others[place.0][place.1] = accepted,
        None => {
            let best = simplex.best.point;
            for other in simplex.others.iter_mut().flatten() {
                *other = corner(best + (other.point - best) * half);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::convert::Infallible;
    use nalgebra::Matrix2x1;

    fn rosenbrock(p: &Matrix2x1<f64>) -> Result<f64, Infallible> {
        Ok(100.0 * (p[1] - p[0] * p[0]).powi(2) + (1.0 - p[0]).powi(2))
    }

    #[test]
    fn rosenbrock_is_minimised() {
        let found = NelderMead::default().minimise(Matrix2x1::new(-1.2, 1.0), rosenbrock).unwrap();
        assert!(found.termination.converged(), "{found:?}");
        assert!((found.point - Matrix2x1::new(1.0, 1.0)).abs().max() < 1e-6, "{found:?}");
    }

    #[test]
    fn each_end_has_its_reason() {
        let ends = |settings: NelderMead<f64>| {
            settings.minimise(Matrix2x1::new(-1.2, 1.0), rosenbrock).unwrap().termination
        };
        let settings = NelderMead::default();
        assert_eq!(ends(NelderMead { max_iterations: 0, ..settings }), Termination::IterationLimit);
        assert_eq!(ends(NelderMead { max_iterations: 3, ..settings }), Termination::IterationLimit);
        assert_eq!(ends(NelderMead { cost_threshold: 30.0, ..settings }), Termination::SmallCost);
        assert_eq!(ends(NelderMead { step_tolerance: 1.0, ..settings }), Termination::SmallStep);
        let island =
            |p: &Matrix2x1<f64>| if p[0] == -1.2 && p[1] == 1.0 { Ok(1.0) } else { Err(()) };
        let found = settings.minimise(Matrix2x1::new(-1.2, 1.0), island).unwrap();
        assert_eq!(found.termination, Termination::NonFinite);
    }
}
