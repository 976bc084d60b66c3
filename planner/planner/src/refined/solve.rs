//! The sweeps: linear fit, then corrections for what Γ does beyond its linearisation.

use super::ends::{Ends, REST, begin_at, catch_up, check_standing, desired_start, place_ends};
use super::plan::{RefinedPlan, RefinedReport};
use super::problem::{Linearised, Problem};
use super::sweeps::sweeps;
use super::task::Refinement;
use super::window::Window;
use super::workspace::Workspace;
use crate::Error;
use crate::constraint::ShapeConstraint;
use crate::motion::{DesiredMotion, Stretched};
use crate::planner::{Task, check_description};
use crate::reference::{Grid, OutputMap};
use nalgebra::SVector;
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// Plans a shape trajectory q_s = K⁰ u(t) whose virtual acceleration u is a clamped quintic B-spline,
/// so that the robot's output follows the desired motion as closely as its dynamics allow.
///
/// Near the origin ẍ = u − τ²ü: this operator, on the flat output z with u = z̈, is the fixed Jacobian
/// of the problem. It is factored once; each sweep evaluates Γ once per sample and corrects for the
/// difference. At the end u, u̇ and ü are zero, at the start as well unless the plan begins in a given
/// [`Start`](crate::refined::Start): from there q_s and q̇_s are continuous.
///
/// Objective, optimiser and free gain rows of the task do not apply: the output's position error is
/// minimised over all of u.
///
/// # Errors
///
/// Those of [`plan`](crate::plan), and
///
/// - [`Error::Invalid`] for senseless settings of the refinement or too small a workspace,
/// - [`Error::LimitExceeded`] where a shape coordinate leaves its limits or a coordinate its declared
///   range, with the duration that would do, if a longer one does.
///
/// A plan whose sweeps did not converge is no error: see [`RefinedReport::converged`].
pub fn refine<'w, 'a: 'w, R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
    robot: &R,
    task: &Task<'a, M, T, NS, C>,
    refinement: &Refinement<T, NX, NS>,
    workspace: &'w mut Workspace<T, NX, POINTS>,
) -> Result<RefinedPlan<'w, M, C, T, NX, NS>, Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let fitted = fit(robot, task, refinement, workspace).map_err(|error| {
        with_duration(task, error, |stretched| {
            fit(robot, stretched, refinement, workspace).map(|_| ())
        })
    })?;
    Ok(fitted.plan(task, workspace))
}

/// What a fit leaves beside the control points in the workspace.
pub(super) struct Fitted<'p, R: ?Sized, M: ?Sized, C, T: Ordered, const NX: usize, const NS: usize>
{
    map: OutputMap<T, NX>,
    problem: Problem<'p, R, M, C, T, NX, NS>,
    report: RefinedReport<T, NS>,
}

impl<R: ?Sized, M: ?Sized, C: Copy, T: Ordered, const NX: usize, const NS: usize>
    Fitted<'_, R, M, C, T, NX, NS>
{
    pub(super) fn plan<'w, 'a: 'w, const POINTS: usize>(
        &self,
        task: &Task<'a, M, T, NS, C>,
        workspace: &'w Workspace<T, NX, POINTS>,
    ) -> RefinedPlan<'w, M, C, T, NX, NS> {
        RefinedPlan {
            motion: task.motion,
            constraint: task.constraint,
            map: self.map,
            window: self.problem.window,
            gain: self.problem.gain,
            linear: self.problem.linear,
            start: self.problem.start,
            fade: self.problem.fade,
            basis: &workspace.basis,
            points: &workspace.points,
            report: self.report,
        }
    }
}

/// The error of a plan that exceeds a limit, with a duration of the desired motion that does not: tried
/// out, not guessed.
pub(super) fn with_duration<M, C, T, const NX: usize, const NS: usize>(
    task: &Task<'_, M, T, NS, C>,
    error: Error,
    mut attempt: impl FnMut(&Task<'_, Stretched<&M, T>, T, NS, C>) -> Result<(), Error>,
) -> Error
where
    M: DesiredMotion<T, NX> + ?Sized,
    C: Copy,
    T: Ordered,
{
    let (mut factor, mut latest) = (1.0_f64, error);
    for _ in 0..8 {
        let Error::LimitExceeded { value, lower, upper, .. } = latest else {
            return error;
        };
        let bound = if value > upper { upper } else { lower };
        // Accelerations go with the inverse square of the duration.
        let excess = T::from_f64(value / bound).sqrt().to_f64();
        if !(excess.is_finite() && excess > 0.0) {
            return error;
        }
        factor *= (excess * 1.01).clamp(1.02, 4.0);
        let Ok(motion) = Stretched::new(task.motion, T::from_f64(factor)) else {
            return error;
        };
        match attempt(&task.with_motion(&motion)) {
            Ok(()) => return error.with_duration(motion.duration().to_f64()),
            Err(next) => latest = next,
        }
    }
    error
}

pub(super) fn fit<'p, R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
    robot: &'p R,
    task: &Task<'p, M, T, NS, C>,
    refinement: &Refinement<T, NX, NS>,
    workspace: &mut Workspace<T, NX, POINTS>,
) -> Result<Fitted<'p, R, M, C, T, NX, NS>, Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    check_description(robot)?;
    refinement.check()?;
    let map = OutputMap::new(robot)?;
    let standing = [refinement.standing_before, refinement.standing_after];
    let grid = Grid::new(task.motion, task.samples)?;
    let window = Window::new(grid, standing, refinement.spans, POINTS)?;
    let gain = task.free_gain(robot)?;
    let linear = Linearised::new(robot, &gain, &map)?;
    let mut problem = Problem {
        robot,
        motion: task.motion,
        constraint: task.constraint,
        window,
        gain,
        linear,
        start: desired_start(robot, task, &window, &map),
        fade: None,
        catch_up: None,
    };
    check_standing(task.motion, refinement, window.step())?;
    let mut ends = Ends { virtual_start: [SVector::zeros(); 3], given: REST };
    if let Some(start) = &refinement.start {
        problem.start = *start;
        let given = if start.shape_acceleration.is_some() { REST } else { REST - 1 };
        ends = Ends { virtual_start: begin_at(&mut problem)?, given };
        problem.catch_up = catch_up(&problem, &ends.virtual_start[0], refinement.catch_up)?;
    }
    workspace.basis.prepare(window.spans);
    place_ends(&problem, &ends, &map, workspace);
    let count = window.spans + super::basis::DEGREE;
    workspace
        .normal
        .prepare(&workspace.basis, &window, &linear, (ends.given, count - REST))
        .ok_or(Error::Singular { matrix: "fit of the spline" })?;
    let report = sweeps(&problem, refinement, count, workspace)?;
    Ok(Fitted { map, problem, report })
}
