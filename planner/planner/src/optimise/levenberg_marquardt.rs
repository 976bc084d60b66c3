//! Levenberg-Marquardt on normal equations.

use super::NormalEquations;
use nalgebra::SMatrix;
use shapebot_dynamics::Ordered;

/// Why a minimisation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// The cost is at or below its threshold: J < J_thres of Algorithm 1, line 11.
    SmallCost,
    /// The residual is orthogonal to what the parameters can do: a minimum.
    SmallGradient,
    /// The next step would be negligible beside the parameters: ΔK < ΔK_thres of Algorithm 1.
    SmallStep,
    /// The next step would lower the cost by a negligible fraction, or by less than its rounding
    /// errors.
    SmallReduction,
    /// As many steps as allowed were tried.
    IterationLimit,
    /// No step lowers the cost, however short.
    NoProgress,
    /// Every step, however short, leads to where the cost is not finite.
    NonFinite,
}

impl Termination {
    /// Whether the end point is a minimum to within the tolerances.
    pub const fn converged(self) -> bool {
        matches!(
            self,
            Self::SmallCost | Self::SmallGradient | Self::SmallStep | Self::SmallReduction
        )
    }
}

/// The method's settings.
///
/// The damping is a multiple of the identity, scaled by the largest diagonal entry of JᵀJ, not
/// Marquardt's diagonal matrix: parameters here are commensurate, and every step then lies in the row
/// space of J, so that directions of the parameter space which the residuals do not feel keep their
/// starting values. A floor on the damping keeps rounding errors out of these directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevenbergMarquardt<T: Ordered> {
    /// Most steps tried; 0 keeps the starting point.
    pub max_iterations: usize,
    /// J_thres: ends at a cost at or below it.
    pub cost_threshold: T,
    /// Ends when the cosine between the residual and every column of J is at most this.
    pub gradient_tolerance: T,
    /// ΔK_thres: ends when the step's norm is at most this fraction of the parameters' norm.
    pub step_tolerance: T,
    /// Ends when the predicted reduction of the cost is at most this fraction of it.
    pub reduction_tolerance: T,
    /// Damping of the first step, as a fraction of the largest diagonal entry of JᵀJ.
    pub initial_damping: T,
}

impl<T: Ordered> Default for LevenbergMarquardt<T> {
    /// Tolerances near the scalar's resolution, at most 50 steps.
    fn default() -> Self {
        // ε^(2/3): 3.7e-11 for doubles, 2.4e-5 for singles.
        let fine = (T::epsilon().ln() * T::from_f64(2.0 / 3.0)).exp();
        Self {
            max_iterations: 50,
            cost_threshold: T::zero(),
            gradient_tolerance: fine,
            step_tolerance: fine,
            reduction_tolerance: T::epsilon() * T::from_f64(16.0),
            initial_damping: T::from_f64(1e-3),
        }
    }
}

/// Where a minimisation ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum<T: Ordered, const R: usize, const C: usize> {
    /// The best parameters found.
    pub point: SMatrix<T, R, C>,
    /// The cost there.
    pub cost: T,
    /// The cost at the start.
    pub start_cost: T,
    /// Steps tried.
    pub iterations: usize,
    /// Why it ended.
    pub termination: Termination,
}

/// Damping of a run: Nielsen's update.
struct Damping<T> {
    value: T,
    growth: T,
    floor: T,
    /// Why the last step was rejected: the reason to end if no shorter one helps.
    failure: Option<Termination>,
}

impl<T: Ordered> Damping<T> {
    fn new(value: T) -> Self {
        let floor = T::epsilon().sqrt();
        let value = if value > floor { value } else { floor };
        Self { value, growth: T::from_f64(2.0), floor, failure: None }
    }

    /// After a step that lowered the cost by `gain` times what was predicted.
    fn relax(&mut self, gain: T) {
        let two = T::from_f64(2.0);
        let excess = two * gain - T::one();
        let (third, factor) = (T::from_f64(1.0 / 3.0), T::one() - excess * excess * excess);
        self.value *= if factor > third { factor } else { third };
        if self.value < self.floor {
            self.value = self.floor;
        }
        self.growth = two;
        self.failure = None;
    }

    /// After a step that did not. The reason to end, if there is nothing left to try.
    fn tighten(&mut self, failure: Termination) -> Option<Termination> {
        self.value *= self.growth;
        self.growth *= T::from_f64(2.0);
        self.failure = Some(failure);
        if self.value < T::from_f64(1e12) { None } else { self.failure }
    }
}

/// A minimisation under way.
struct Run<T: Ordered, const R: usize, const C: usize> {
    point: SMatrix<T, R, C>,
    here: NormalEquations<T, R, C>,
    damping: Damping<T>,
    iterations: usize,
}

impl<T: Ordered> LevenbergMarquardt<T> {
    /// Minimises a sum of squares from `start`; `problem` linearises it at a point.
    ///
    /// # Errors
    ///
    /// That of `problem` at the start. An error at a trial step rejects the step.
    pub fn minimise<const R: usize, const C: usize, E>(
        &self,
        start: SMatrix<T, R, C>,
        mut problem: impl FnMut(&SMatrix<T, R, C>) -> Result<NormalEquations<T, R, C>, E>,
    ) -> Result<Minimum<T, R, C>, E> {
        let here = problem(&start)?;
        let start_cost = here.cost;
        let damping = Damping::new(self.initial_damping);
        let mut run = Run { point: start, here, damping, iterations: 0 };
        let termination = loop {
            let end = self.at_minimum(&run.here).or_else(|| self.attempt(&mut run, &mut problem));
            if let Some(reason) = end {
                break reason;
            }
        };
        let Run { point, here, iterations, .. } = run;
        Ok(Minimum { point, cost: here.cost, start_cost, iterations, termination })
    }

    /// Tries one step; the reason to end, if there is one.
    fn attempt<const R: usize, const C: usize, E>(
        &self,
        run: &mut Run<T, R, C>,
        problem: &mut impl FnMut(&SMatrix<T, R, C>) -> Result<NormalEquations<T, R, C>, E>,
    ) -> Option<Termination> {
        if run.iterations >= self.max_iterations {
            return Some(Termination::IterationLimit);
        }
        let shift = run.damping.value * run.here.largest_curvature();
        let Some(step) = run.here.step(shift) else {
            return run.damping.tighten(Termination::NoProgress);
        };
        let predicted = predicted_reduction(&run.here, &step, shift);
        if let Some(reason) = self.negligible(&run.point, &run.here, &step, predicted) {
            return run.damping.failure.or(Some(reason));
        }
        run.iterations += 1;
        let Some(there) = problem(&(run.point + step)).ok().filter(NormalEquations::is_finite)
        else {
            return run.damping.tighten(Termination::NonFinite);
        };
        if there.cost < run.here.cost {
            run.damping.relax((run.here.cost - there.cost) / predicted);
            run.point += step;
            run.here = there;
            return None;
        }
        // The first step after a success promised little and gave nothing: what is left to gain is
        // less than the cost's own rounding errors.
        if run.damping.failure.is_none() && predicted <= T::epsilon().sqrt() * run.here.cost {
            return Some(Termination::SmallReduction);
        }
        run.damping.tighten(Termination::NoProgress)
    }

    fn at_minimum<const R: usize, const C: usize>(
        &self,
        here: &NormalEquations<T, R, C>,
    ) -> Option<Termination> {
        if here.cost <= self.cost_threshold {
            Some(Termination::SmallCost)
        } else if here.correlation() <= self.gradient_tolerance {
            Some(Termination::SmallGradient)
        } else {
            None
        }
    }

    fn negligible<const R: usize, const C: usize>(
        &self,
        point: &SMatrix<T, R, C>,
        here: &NormalEquations<T, R, C>,
        step: &SMatrix<T, R, C>,
        predicted: T,
    ) -> Option<Termination> {
        let size = point.dot(point).sqrt();
        if step.dot(step).sqrt() <= self.step_tolerance * (size + self.step_tolerance) {
            Some(Termination::SmallStep)
        } else if predicted <= self.reduction_tolerance * here.cost {
            Some(Termination::SmallReduction)
        } else {
            None
        }
    }
}

/// ‖r‖² − ‖r + Jδ‖² for δ that solves (JᵀJ + shift) δ = −Jᵀr.
fn predicted_reduction<T: Ordered, const R: usize, const C: usize>(
    here: &NormalEquations<T, R, C>,
    step: &SMatrix<T, R, C>,
    shift: T,
) -> T {
    shift * step.dot(step) - here.gradient.dot(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::convert::Infallible;
    use nalgebra::{Matrix2x1, Vector1, Vector2};

    type Residuals = Result<NormalEquations<f64, 2, 1>, Infallible>;

    fn equations(residual: Vector2<f64>, by_x: Vector2<f64>, by_y: Vector2<f64>) -> Residuals {
        let mut sum = NormalEquations::default();
        sum.add(&residual, &[[by_x], [by_y]]);
        Ok(sum)
    }

    /// MINPACK's first test problem: r = (10 (y − x²), 1 − x).
    fn rosenbrock(p: &Matrix2x1<f64>) -> Residuals {
        let residual = Vector2::new(10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]);
        equations(residual, Vector2::new(-20.0 * p[0], -1.0), Vector2::new(10.0, 0.0))
    }

    #[test]
    fn rosenbrock_is_minimised() {
        let settings = LevenbergMarquardt::default();
        let found = settings.minimise(Matrix2x1::new(-1.2, 1.0), rosenbrock).unwrap();
        assert!(found.termination.converged(), "{found:?}");
        assert!((found.point - Matrix2x1::new(1.0, 1.0)).abs().max() < 1e-8, "{found:?}");
        assert!((found.start_cost - 24.2).abs() < 1e-12);
    }

    /// r = x + 2y − 5 and its square root's curvature: only the direction (1, 2) is felt.
    fn ravine(p: &Matrix2x1<f64>) -> Residuals {
        let u = p[0] + 2.0 * p[1];
        let slope = Vector2::new(1.0, 0.2 * u);
        equations(Vector2::new(u - 5.0, 0.1 * u * u - 1.0), slope, slope * 2.0)
    }

    #[test]
    fn unfelt_directions_keep_their_start() {
        let start = Matrix2x1::new(0.3, -0.7);
        let found = LevenbergMarquardt::default().minimise(start, ravine).unwrap();
        assert!(found.termination.converged(), "{found:?}");
        let moved = found.point - start;
        assert!(moved.dot(&moved) > 1.0 && (2.0 * moved[0] - moved[1]).abs() < 1e-9, "{moved}");
    }

    #[test]
    fn each_end_has_its_reason() {
        let start = Matrix2x1::new(-1.2, 1.0);
        let settings = LevenbergMarquardt::default();
        let ends = |settings: LevenbergMarquardt<f64>| {
            settings.minimise(start, rosenbrock).unwrap().termination
        };
        assert_eq!(
            ends(LevenbergMarquardt { max_iterations: 0, ..settings }),
            Termination::IterationLimit
        );
        assert_eq!(
            ends(LevenbergMarquardt { cost_threshold: 30.0, ..settings }),
            Termination::SmallCost
        );
        assert_eq!(
            ends(LevenbergMarquardt { gradient_tolerance: 1.0, ..settings }),
            Termination::SmallGradient
        );
        assert_eq!(
            ends(LevenbergMarquardt { step_tolerance: 10.0, ..settings }),
            Termination::SmallStep
        );
        assert_eq!(
            ends(LevenbergMarquardt { reduction_tolerance: 2.0, ..settings }),
            Termination::SmallReduction
        );
    }

    #[test]
    fn a_wrong_jacobian_ends_without_progress() {
        let uphill = |p: &Matrix2x1<f64>| {
            let mut equations = rosenbrock(p)?;
            equations.gradient = -equations.gradient;
            Ok::<_, Infallible>(equations)
        };
        let start = Matrix2x1::new(-1.2, 1.0);
        let found = LevenbergMarquardt::default().minimise(start, uphill).unwrap();
        assert_eq!((found.termination, found.point), (Termination::NoProgress, start));
    }

    #[test]
    fn a_cost_that_is_finite_only_at_the_start_is_told() {
        let start = Matrix2x1::new(-1.2, 1.0);
        let island = |p: &Matrix2x1<f64>| {
            if *p == start { rosenbrock(p).map_err(|_| ()) } else { Err(()) }
        };
        let found = LevenbergMarquardt::default().minimise(start, island).unwrap();
        assert_eq!(found.termination, Termination::NonFinite);
        let nowhere = |_: &Matrix2x1<f64>| Err::<NormalEquations<f64, 2, 1>, _>("start");
        assert_eq!(LevenbergMarquardt::default().minimise(start, nowhere), Err("start"));
    }

    #[test]
    fn a_constant_cost_is_a_minimum() {
        let flat = |_: &Vector1<f64>| {
            let mut sum = NormalEquations::default();
            sum.add(&Vector1::new(3.0), &[[Vector1::new(0.0)]]);
            Ok::<_, Infallible>(sum)
        };
        let found = LevenbergMarquardt::default().minimise(Vector1::new(2.0), flat).unwrap();
        assert_eq!((found.termination, found.point[0]), (Termination::SmallGradient, 2.0));
    }
}
