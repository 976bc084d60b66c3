//! Algorithm 1.

use crate::Error;
use crate::constraint::{ShapeConstraint, Unconstrained};
use crate::gain::Weighting;
use crate::motion::DesiredMotion;
use crate::objective::{GainProblem, Objective};
use crate::optimise::{Minimum, Optimiser};
use crate::plan::Plan;
use crate::reference::{Grid, OutputMap};
use crate::report::Report;
use core::fmt;
use nalgebra::SMatrix;
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// What of the gain the optimiser chooses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Parametrisation {
    /// S in K = K⁰ S, n_x × n_x: the shape sets keep the proportions that the weighting gives them.
    #[default]
    Proportions,
    /// All entries of the rows of K that K⁰ uses. The weighting is only where the search begins: with
    /// several shape sets the shares may go anywhere.
    FreeRows,
}

/// What is to be planned, and how.
///
/// ```
/// # use shapebot_planner::{Objective, Task, Weighting, motion::Line};
/// let line = Line::new([0.0, 0.0].into(), [2.0, 0.0].into(), 5.0, 9)?;
/// // A ballbot with arms: nothing from the left and the right arm, all from the body.
/// let task = Task::<_, _, 6>::new(&line, 501)
///     .weighting(Weighting::Contributions(&[0.0, 0.0, 1.0]))
///     .objective(Objective::Position);
/// # Ok::<(), shapebot_planner::Error>(())
/// ```
pub struct Task<'a, M: ?Sized, T: Ordered, const NS: usize, C = Unconstrained> {
    /// The desired motion of the output.
    pub motion: &'a M,
    /// Number of equidistant samples, both ends included, at least [`MIN_SAMPLES`](crate::MIN_SAMPLES).
    pub samples: usize,
    /// How the shape variables share the work.
    pub weighting: Weighting<'a, T, NS>,
    /// What is minimised.
    pub objective: Objective,
    /// What of the gain it chooses.
    pub parametrisation: Parametrisation,
    /// How.
    pub optimiser: Optimiser<T>,
    /// Shape sets that follow trajectories of their own: [`Constrained`](crate::Constrained).
    pub constraint: C,
}

// By hand, because the motion is only borrowed: it need not be Clone or Debug itself.
impl<M: ?Sized, T: Ordered, const NS: usize, C: Copy> Clone for Task<'_, M, T, NS, C> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M: ?Sized, T: Ordered, const NS: usize, C: Copy> Copy for Task<'_, M, T, NS, C> {}

impl<M: ?Sized, T: Ordered, const NS: usize, C> fmt::Debug for Task<'_, M, T, NS, C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Task")
            .field("samples", &self.samples)
            .field("weighting", &self.weighting)
            .field("objective", &self.objective)
            .field("optimiser", &self.optimiser)
            .finish_non_exhaustive()
    }
}

impl<'a, M: ?Sized, T: Ordered, const NS: usize> Task<'a, M, T, NS> {
    /// A desired motion and its number of samples; all else at its default.
    pub fn new(motion: &'a M, samples: usize) -> Self {
        Self {
            motion,
            samples,
            weighting: Weighting::default(),
            objective: Objective::default(),
            parametrisation: Parametrisation::default(),
            optimiser: Optimiser::default(),
            constraint: Unconstrained,
        }
    }
}

impl<'a, M: ?Sized, T: Ordered, const NS: usize, C> Task<'a, M, T, NS, C> {
    /// The task with another weighting.
    #[must_use]
    pub fn weighting(self, weighting: Weighting<'a, T, NS>) -> Self {
        Self { weighting, ..self }
    }

    /// The task with another objective.
    #[must_use]
    pub fn objective(self, objective: Objective) -> Self {
        Self { objective, ..self }
    }

    /// The task with another parametrisation of the gain.
    #[must_use]
    pub fn parametrisation(self, parametrisation: Parametrisation) -> Self {
        Self { parametrisation, ..self }
    }

    /// The task with shape sets constrained.
    #[must_use]
    pub fn constraint<D>(self, constraint: D) -> Task<'a, M, T, NS, D> {
        let Self { motion, samples, weighting, objective, parametrisation, optimiser, .. } = self;
        Task { motion, samples, weighting, objective, parametrisation, optimiser, constraint }
    }

    /// The same for another motion.
    pub(crate) fn with_motion<'b, L: ?Sized>(&self, motion: &'b L) -> Task<'b, L, T, NS, C>
    where
        'a: 'b,
        C: Copy,
    {
        let Self { samples, weighting, objective, parametrisation, optimiser, constraint, .. } =
            *self;
        Task { motion, samples, weighting, objective, parametrisation, optimiser, constraint }
    }

    /// K⁰_qx of the free shape sets.
    pub(crate) fn free_gain<R, const NX: usize>(
        &self,
        robot: &R,
    ) -> Result<SMatrix<T, NS, NX>, Error>
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
        C: ShapeConstraint<T, NX, NS>,
    {
        self.weighting.free_gain(robot, |index| self.constraint.holds(index))
    }

    /// The task with another optimiser or other settings.
    #[must_use]
    pub fn optimiser(self, optimiser: impl Into<Optimiser<T>>) -> Self {
        Self { optimiser: optimiser.into(), ..self }
    }
}

/// Plans a shape trajectory for a desired motion of the robot's output: Algorithm 1 with the gain
/// sought as K = K⁰ S, or in all its entries.
///
/// Each step of the optimiser evaluates Γ with its Jacobians once per sample; a last pass without
/// Jacobians fills the report. No heap, and stack in proportion to n_x² n_s, not to the samples.
///
/// # Errors
///
/// - [`Error::Invalid`] and its kin: a task that makes no sense.
/// - [`Error::Length`]: a robot whose description does not fit its dimensions.
/// - [`Error::Singular`], [`Error::UselessShapeSet`]: a robot whose shape does not do what is asked.
/// - [`Error::NonFinite`]: Γ or the desired motion is no number somewhere along the plan of K⁰.
/// - [`Error::OutOfRange`]: the plan leaves a coordinate's declared range.
///
/// A plan whose optimiser did not converge is no error: see [`Report::termination`].
pub fn plan<'a, R, M, C, T, const NX: usize, const NS: usize>(
    robot: &R,
    task: &Task<'a, M, T, NS, C>,
) -> Result<Plan<'a, M, T, NX, NS, C>, Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    check_description(robot)?;
    check_optimiser(&task.optimiser)?;
    let initial_gain = task.free_gain(robot)?;
    let blank = Plan {
        motion: task.motion,
        constraint: task.constraint,
        map: OutputMap::new(robot)?,
        grid: Grid::new(task.motion, task.samples)?,
        initial_gain,
        factor: SMatrix::identity(),
        gain: initial_gain,
        report: Report::default(),
    };
    let mut plan = match task.parametrisation {
        Parametrisation::Proportions => {
            let problem = problem(robot, task, &blank, initial_gain);
            let (minimum, report) = minimise(&problem, task, SMatrix::<T, NX, NX>::identity())?;
            Plan { factor: minimum, gain: initial_gain * minimum, report, ..blank }
        }
        Parametrisation::FreeRows => {
            let rows = SMatrix::<T, NS, NS>::from_fn(|i, j| {
                let used = initial_gain.row(i).iter().any(|&entry| entry != T::zero());
                if i == j && used { T::one() } else { T::zero() }
            });
            let problem = problem(robot, task, &blank, rows);
            let (gain, report) = minimise(&problem, task, initial_gain)?;
            Plan { factor: robot.shape_gain() * gain, gain, report, ..blank }
        }
    };
    plan.survey(robot)?;
    Ok(plan)
}

fn problem<'p, R, M, C, T, const NX: usize, const NS: usize, const P: usize>(
    robot: &'p R,
    task: &Task<'p, M, T, NS, C>,
    blank: &Plan<'p, M, T, NX, NS, C>,
    directions: SMatrix<T, NS, P>,
) -> GainProblem<'p, R, M, C, T, NX, NS, P>
where
    R: ?Sized,
    M: ?Sized,
    C: Copy,
    T: Ordered,
{
    GainProblem {
        robot,
        motion: task.motion,
        constraint: task.constraint,
        map: blank.map,
        grid: blank.grid,
        directions,
        objective: task.objective,
    }
}

/// The best parameters, and what the optimiser knows for the report.
fn minimise<R, M, C, T, const NX: usize, const NS: usize, const P: usize>(
    problem: &GainProblem<'_, R, M, C, T, NX, NS, P>,
    task: &Task<'_, M, T, NS, C>,
    start: SMatrix<T, P, NX>,
) -> Result<(SMatrix<T, P, NX>, Report<T, NS>), Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let mut passes = 0_usize;
    let minimum = match &task.optimiser {
        Optimiser::LevenbergMarquardt(settings) => settings.minimise(start, |factor| {
            passes += 1;
            problem.linearise(factor)
        })?,
        Optimiser::NelderMead(settings) => {
            let minimum = settings.minimise(start, |factor| {
                passes += 1;
                problem.cost(factor)
            })?;
            // The costs do not change, and columns that the motion does not excite stay at K⁰.
            let point = start + (minimum.point - start) * problem.excited();
            Minimum { point, ..minimum }
        }
    };
    let report = Report::new(&minimum, task.samples.saturating_mul(passes));
    Ok((minimum.point, report))
}

/// Ranges and shape sets are looked up by index: the description must be that of the robot.
pub(crate) fn check_description<T, const NX: usize, const NS: usize, R>(
    robot: &R,
) -> Result<(), Error>
where
    T: Ordered,
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
{
    let description = robot.shape_description();
    let check = |field, found, expected| {
        if found == expected { Ok(()) } else { Err(Error::Length { field, found, expected }) }
    };
    check("position coordinates described", description.position_count, NX)?;
    check("coordinates described", description.coordinates.len(), NX + NS)
}

fn check_optimiser<T: Ordered>(optimiser: &Optimiser<T>) -> Result<(), Error> {
    let numbers = match *optimiser {
        Optimiser::LevenbergMarquardt(settings) => [
            ("cost threshold", settings.cost_threshold),
            ("gradient tolerance", settings.gradient_tolerance),
            ("step tolerance", settings.step_tolerance),
            ("reduction tolerance", settings.reduction_tolerance),
            ("initial damping", settings.initial_damping),
        ],
        Optimiser::NelderMead(settings) => [
            ("cost threshold", settings.cost_threshold),
            ("step tolerance", settings.step_tolerance),
            ("reduction tolerance", settings.reduction_tolerance),
            ("initial edge", settings.initial_edge),
            ("initial edge", settings.initial_edge),
        ],
    };
    for (field, value) in numbers {
        if !value.is_finite() || value < T::zero() {
            let expected = "a finite number that is not negative";
            return Err(Error::Invalid { field, value: value.to_f64(), expected });
        }
    }
    Ok(())
}
