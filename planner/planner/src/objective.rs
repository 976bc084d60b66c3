//! What the gain is chosen to minimise, and its linearisation.

use crate::Error;
use crate::constraint::ShapeConstraint;
use crate::integrate::{Accelerated, DoubleIntegral, Integrated, Linear};
use crate::linear_algebra::{column, largest, solve};
use crate::motion::DesiredMotion;
use crate::optimise::NormalEquations;
use crate::plan::{self, PlanPoint};
use crate::reference::{Desired, Grid, OutputMap};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// The sum of squares that a plan's gain minimises, over all samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Objective {
    /// Σ ‖h(q_x^p, q_s^p) − x^d‖²: the output's distance from its desired position, m². This is what
    /// Sec. IV-F says was minimised, taken where the task is.
    #[default]
    Output,
    /// Σ ‖∂h/∂q_x (q_x^p − q_x^d)‖²: the same for the position coordinates alone, scaled to the
    /// output's unit (for a ballbot the ball's angle instead of its centre), m².
    Position,
    /// Σ ‖q̈_x^p − q̈_x^d‖²: Eq. 33 to the letter, in units of q̈_x. Small errors of the acceleration add
    /// up: it tracks the desired position worse than K⁰ does.
    Acceleration,
}

/// The choice of X in K = D X that minimises the objective.
///
/// With D = K⁰ and X = S square of size n_x the shape sets keep the proportions that K⁰ gives them,
/// however many there are; with D the identity on the rows that K⁰ uses, X is K itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GainProblem<
    'a,
    R: ?Sized,
    M: ?Sized,
    C,
    T: Ordered,
    const NX: usize,
    const NS: usize,
    const P: usize,
> {
    pub(crate) robot: &'a R,
    pub(crate) motion: &'a M,
    pub(crate) constraint: C,
    pub(crate) map: OutputMap<T, NX>,
    pub(crate) grid: Grid<T>,
    /// D.
    pub(crate) directions: SMatrix<T, NS, P>,
    pub(crate) objective: Objective,
}

/// A vector with its derivatives by the entries of X: `by_factor[i][j]` is ∂/∂X_ij.
#[derive(Clone, Copy, Debug)]
struct Sensitive<T: Ordered, const NX: usize, const P: usize> {
    value: SVector<T, NX>,
    by_factor: ByFactor<T, NX, P>,
}

type ByFactor<T, const NX: usize, const P: usize> = [[SVector<T, NX>; NX]; P];

impl<T: Ordered, const NX: usize, const P: usize> Sensitive<T, NX, P> {
    /// A vector that does not depend on X.
    fn constant(value: SVector<T, NX>) -> Self {
        Self { value, by_factor: [[SVector::zeros(); NX]; P] }
    }
}

impl<T: Ordered, const NX: usize, const P: usize> Linear<T> for Sensitive<T, NX, P> {
    fn plus(mut self, factor: T, other: &Self) -> Self {
        self.value += other.value * factor;
        for (row, others) in self.by_factor.iter_mut().zip(&other.by_factor) {
            for (entry, other) in row.iter_mut().zip(others) {
                *entry += other * factor;
            }
        }
        self
    }
}

/// One sample of the plan under trial.
#[derive(Clone, Copy, Debug)]
struct Sample<T: Ordered, const NX: usize, const NS: usize, const P: usize> {
    plan: PlanPoint<T, NX, NS>,
    acceleration: Sensitive<T, NX, P>,
}

impl<T: Ordered, const NX: usize, const NS: usize, const P: usize> Accelerated<T>
    for Sample<T, NX, NS, P>
{
    type Acceleration = Sensitive<T, NX, P>;
    fn acceleration(&self) -> &Self::Acceleration {
        &self.acceleration
    }
}

impl<T, R, M, C, const NX: usize, const NS: usize, const P: usize>
    GainProblem<'_, R, M, C, T, NX, NS, P>
where
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
{
    /// The objective at X alone.
    ///
    /// # Errors
    ///
    /// As [`linearise`](Self::linearise).
    pub(crate) fn cost(&self, factor: &SMatrix<T, P, NX>) -> Result<T, Error> {
        let gain = self.directions * factor;
        let start = self.desired(0).position;
        let plain = |index: usize| {
            let time = self.grid.time(index);
            let plan = PlanPoint::new(time, self.desired(index), &self.constraint, &gain);
            let acceleration =
                self.robot.gamma(&plan.shape, &plan.shape_velocity, &plan.shape_acceleration);
            plan::Sample { plan, acceleration }
        };
        let (count, step) = (self.grid.count, self.grid.step());
        let mut cost = T::zero();
        for node in DoubleIntegral::new(count, step, start[1], start[0], plain) {
            let desired = &node.sample.plan.desired;
            let residual = match self.objective {
                Objective::Acceleration => node.sample.acceleration - desired.position[2],
                Objective::Position => self.map.jacobian * (node.position - desired.position[0]),
                Objective::Output => {
                    self.robot.output(&node.position, &node.sample.plan.shape) - desired.output[0]
                }
            };
            cost += residual.dot(&residual);
            if !cost.is_finite() {
                return Err(self.first_not_finite(&gain));
            }
        }
        Ok(cost)
    }

    /// The objective linearised at X, in one pass over the samples.
    ///
    /// # Errors
    ///
    /// [`Error::NonFinite`] with the first sample that is not finite.
    pub(crate) fn linearise(
        &self,
        factor: &SMatrix<T, P, NX>,
    ) -> Result<NormalEquations<T, P, NX>, Error> {
        let gain = self.directions * factor;
        let start = self.desired(0).position;
        let trajectory = DoubleIntegral::new(
            self.grid.count,
            self.grid.step(),
            Sensitive::constant(start[1]),
            Sensitive::constant(start[0]),
            |index| self.sample(&gain, index),
        );
        let mut equations = NormalEquations::default();
        for node in trajectory {
            let (residual, by_factor) = self.residual(&node);
            equations.add(&residual, &by_factor);
            if !equations.is_finite() {
                return Err(self.first_not_finite(&gain));
            }
        }
        Ok(equations)
    }

    fn desired(&self, index: usize) -> Desired<T, NX> {
        self.map.desired(self.motion.derivatives(self.grid.time(index)))
    }

    /// Γ along q_s = K a with its derivatives by X: ∂q_s/∂X_ij is column i of D times a_j, and so
    /// for the rates with a's derivatives (Eqs. 31 and 32).
    fn sample(&self, gain: &SMatrix<T, NS, NX>, index: usize) -> Sample<T, NX, NS, P> {
        let time = self.grid.time(index);
        let plan = PlanPoint::new(time, self.desired(index), &self.constraint, gain);
        let response =
            self.robot.response(&plan.shape, &plan.shape_velocity, &plan.shape_acceleration);
        let by_shape = response.d_qs * self.directions;
        let by_rate = response.d_qsd * self.directions;
        let by_acceleration = response.d_qsdd * self.directions;
        let [a, da, dda] = &plan.net_acceleration;
        let by_factor = core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                column(&by_shape, i) * a[j]
                    + column(&by_rate, i) * da[j]
                    + column(&by_acceleration, i) * dda[j]
            })
        });
        Sample { plan, acceleration: Sensitive { value: response.gamma, by_factor } }
    }

    /// The residual of one sample and its derivatives by X.
    fn residual(
        &self,
        node: &Integrated<Sample<T, NX, NS, P>, Sensitive<T, NX, P>>,
    ) -> (SVector<T, NX>, ByFactor<T, NX, P>) {
        let PlanPoint { shape, desired, net_acceleration, .. } = &node.sample.plan;
        let position = &node.position;
        let scaled = || position.by_factor.map(|row| row.map(|x| self.map.jacobian * x));
        match self.objective {
            Objective::Acceleration => {
                let acceleration = &node.sample.acceleration;
                (acceleration.value - desired.position[2], acceleration.by_factor)
            }
            Objective::Position => {
                (self.map.jacobian * (position.value - desired.position[0]), scaled())
            }
            Objective::Output => {
                let through_shape =
                    self.robot.output_jacobian_shape(&position.value, shape) * self.directions;
                let mut by_factor = scaled();
                for (i, row) in by_factor.iter_mut().enumerate() {
                    for (j, entry) in row.iter_mut().enumerate() {
                        *entry += column(&through_shape, i) * net_acceleration[0][j];
                    }
                }
                (self.robot.output(&position.value, shape) - desired.output[0], by_factor)
            }
        }
    }

    /// The projection on the directions that the net acceleration takes along the motion.
    pub(crate) fn excited(&self) -> SMatrix<T, NX, NX> {
        let mut moments = SMatrix::<T, NX, NX>::zeros();
        let none = SMatrix::<T, NS, NX>::zeros();
        for index in 0..self.grid.count {
            let time = self.grid.time(index);
            let plan = PlanPoint::new(time, self.desired(index), &self.constraint, &none);
            for derivative in plan.net_acceleration {
                moments += derivative * derivative.transpose();
            }
        }
        // Moments (moments + ε)⁻¹: 1 along what is excited, 0 across.
        let size = largest(moments.iter().copied());
        let shift = SMatrix::<T, NX, NX>::from_diagonal_element(size * T::epsilon().sqrt());
        solve(moments + shift, moments).unwrap_or_else(SMatrix::identity)
    }

    /// What went wrong, and when. The samples are gone through again: an integrated position is
    /// infected by the samples ahead of it.
    fn first_not_finite(&self, gain: &SMatrix<T, NS, NX>) -> Error {
        let finite = |v: &SVector<T, NX>| v.iter().all(|x| x.is_finite());
        for index in 0..self.grid.count {
            let Sample { plan, acceleration } = self.sample(gain, index);
            let quantity = if !plan.desired.output.iter().all(finite) {
                "desired motion"
            } else if !finite(&acceleration.value) {
                "acceleration response"
            } else if !acceleration.by_factor.iter().flatten().all(finite) {
                "Jacobian of the acceleration response"
            } else {
                continue;
            };
            return Error::NonFinite { quantity, time: plan.time.to_f64() };
        }
        // Each sample is finite, their sums are not.
        let time = self.grid.time(self.grid.count.saturating_sub(1)).to_f64();
        Error::NonFinite { quantity: "objective", time }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::robots::{LinearArms, Robot, Spatial, TABLE_I};
    use crate::motion::Bezier;
    use crate::{Weighting, reference};
    use nalgebra::{Matrix2, Matrix2x6, Vector2};

    const OBJECTIVES: [Objective; 3] =
        [Objective::Output, Objective::Position, Objective::Acceleration];

    /// A curve that excites all of S, with a start that is not at rest.
    const POINTS: [[f64; 2]; 6] =
        [[0.0, 0.0], [0.1, -0.05], [0.2, 0.3], [0.9, 0.4], [1.0, 1.1], [1.2, 1.0]];

    fn check_all<R, const NS: usize>(
        robot: &R,
        check: impl Fn(&dyn Fn(&Matrix2<f64>) -> NormalEquations<f64, 2, 2>),
    ) where
        R: ShapeAccelerated<f64, 2, NS>,
    {
        let points = POINTS.map(Vector2::from);
        let motion = Bezier::new(&points, 4.0).unwrap();
        for objective in OBJECTIVES {
            let problem = GainProblem {
                robot,
                motion: &motion,
                constraint: crate::Unconstrained,
                map: reference::OutputMap::new(robot).unwrap(),
                grid: Grid::new(&motion, 81).unwrap(),
                directions: Weighting::MinimumNorm.gain(robot).unwrap(),
                objective,
            };
            check(&|factor| problem.linearise(factor).unwrap());
        }
    }

    fn unit(i: usize, j: usize) -> Matrix2<f64> {
        let mut unit = Matrix2::zeros();
        unit[(i, j)] = 1.0;
        unit
    }

    #[test]
    fn gradient_is_half_the_derivative_of_the_cost() {
        let factor = Matrix2::new(0.9, 0.05, -0.1, 1.1);
        check_all(&Robot(Spatial(TABLE_I)), |equations| {
            let gradient = equations(&factor).gradient;
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let cost = |h: f64| equations(&(factor + unit(i, j) * h)).cost;
                let h = 1e-4;
                let slope =
                    (8.0 * (cost(h) - cost(-h)) - (cost(2.0 * h) - cost(-2.0 * h))) / (12.0 * h);
                let error = (2.0 * gradient[(i, j)] - slope).abs();
                assert!(
                    error < 1e-8 * gradient.abs().max(),
                    "S_{i}{j}: {} {slope}",
                    gradient[(i, j)]
                );
            }
        });
    }

    #[test]
    fn the_model_of_a_linear_robot_is_exact() {
        let shape_gain = Matrix2x6::new(
            0.0, -0.7, 0.0, -0.7, 0.0, 82.0, //
            0.7, 0.0, 0.7, 0.0, -82.0, 0.0,
        );
        let (from, step) = (Matrix2::new(1.0, 0.2, -0.1, 0.8), Matrix2::new(0.3, -0.2, 0.1, 0.5));
        check_all(&Robot(LinearArms { shape_gain, tau_squared: 0.1 }), |equations| {
            let here = equations(&from);
            // The parameters' order is row by row, nalgebra's column by column.
            let parameters = step.transpose();
            let bend = here.curvature.iter().flatten().zip(parameters.iter());
            let bend: f64 = bend.map(|(row, s)| row.dot(&step) * s).sum();
            let predicted = here.cost + 2.0 * here.gradient.dot(&step) + bend;
            let there = equations(&(from + step)).cost;
            assert!((there - predicted).abs() < 1e-12 * there, "{there} {predicted}");
        });
    }
}
