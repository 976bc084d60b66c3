//! A sum of squares, linearised: J itself is never stored.

use crate::linear_algebra::{exceeds, is_finite, largest};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::Ordered;

/// A sum of squares ‖r‖² around a point of a parameter space of R × C matrices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalEquations<T: Ordered, const R: usize, const C: usize> {
    /// ‖r‖².
    pub cost: T,
    /// Jᵀr: half the gradient of the cost.
    pub gradient: SMatrix<T, R, C>,
    /// JᵀJ: `[i][j][(k, l)]` pairs parameter (i, j) with parameter (k, l).
    pub curvature: [[SMatrix<T, R, C>; C]; R],
}

impl<T: Ordered, const R: usize, const C: usize> Default for NormalEquations<T, R, C> {
    fn default() -> Self {
        Self { cost: T::zero(), gradient: SMatrix::zeros(), curvature: [[SMatrix::zeros(); C]; R] }
    }
}

impl<T: Ordered, const R: usize, const C: usize> NormalEquations<T, R, C> {
    /// Adds a residual vector with its derivative by each parameter.
    pub fn add<const M: usize>(
        &mut self,
        residual: &SVector<T, M>,
        jacobian: &[[SVector<T, M>; C]; R],
    ) {
        self.cost += residual.dot(residual);
        for (i, row) in jacobian.iter().enumerate() {
            for (j, derivative) in row.iter().enumerate() {
                self.gradient[(i, j)] += derivative.dot(residual);
                let others = SMatrix::from_fn(|k, l| derivative.dot(&jacobian[k][l]));
                self.curvature[i][j] += others;
            }
        }
    }

    /// Whether all of it is finite.
    pub fn is_finite(&self) -> bool {
        self.cost.is_finite()
            && is_finite(&self.gradient)
            && self.curvature.iter().flatten().all(is_finite)
    }

    /// Entry (p, q) of JᵀJ, parameters numbered row by row.
    fn entry(curvature: &[[SMatrix<T, R, C>; C]; R], p: usize, q: usize) -> T {
        curvature[p / C][p % C][(q / C, q % C)]
    }

    pub(super) fn largest_curvature(&self) -> T {
        largest((0..R * C).map(|p| Self::entry(&self.curvature, p, p)))
    }

    /// The largest cosine between the residual and a column of J; parameters that the residual does
    /// not feel do not count.
    pub(super) fn correlation(&self) -> T {
        let negligible = self.largest_curvature() * T::epsilon();
        largest((0..R * C).map(|p| {
            let curvature = Self::entry(&self.curvature, p, p);
            if !exceeds(curvature, negligible) {
                return T::zero();
            }
            self.gradient[(p / C, p % C)] / (curvature.sqrt() * self.cost.sqrt())
        }))
    }

    /// Solves (JᵀJ + damping) δ = −Jᵀr by Cholesky; `None` if that is not positive definite.
    pub(super) fn step(&self, damping: T) -> Option<SMatrix<T, R, C>> {
        let mut factor = self.curvature;
        for p in 0..R * C {
            for q in 0..=p {
                let mut sum = Self::entry(&factor, p, q);
                for k in 0..q {
                    sum -= Self::entry(&factor, p, k) * Self::entry(&factor, q, k);
                }
                factor[p / C][p % C][(q / C, q % C)] = if q < p {
                    sum / Self::entry(&factor, q, q)
                } else if exceeds(sum + damping, T::zero()) {
                    (sum + damping).sqrt()
                } else {
                    return None;
                };
            }
        }
        let mut step = -self.gradient;
        for p in 0..R * C {
            for k in 0..p {
                let known = Self::entry(&factor, p, k) * step[(k / C, k % C)];
                step[(p / C, p % C)] -= known;
            }
            step[(p / C, p % C)] /= Self::entry(&factor, p, p);
        }
        for p in (0..R * C).rev() {
            for k in p + 1..R * C {
                let known = Self::entry(&factor, k, p) * step[(k / C, k % C)];
                step[(p / C, p % C)] -= known;
            }
            step[(p / C, p % C)] /= Self::entry(&factor, p, p);
        }
        is_finite(&step).then_some(step)
    }
}
