//! Refined plans whose forces keep limits.

use super::plan::RefinedPlan;
use super::solve::{Fitted, fit, with_duration};
use super::task::Refinement;
use super::workspace::Workspace;
use crate::Error;
use crate::constraint::ShapeConstraint;
use crate::motion::DesiredMotion;
use crate::plan::Row;
use crate::planner::Task;
use crate::torque::{ForceReport, survey_forces};
use shapebot_dynamics::{Ordered, Robot, ShapeAccelerated};

/// A refined plan with its forces.
pub type PlanWithForces<'a, M, C, T, const N: usize, const NX: usize, const NS: usize> =
    (RefinedPlan<'a, M, C, T, NX, NS>, ForceReport<T, N>);

/// [`refine`](crate::refine), with the forces of the actuators along the plan's samples: those that the
/// description limits are limits of the plan.
///
/// # Errors
///
/// Those of [`refine`](crate::refine) and of [`survey_forces`]; [`Error::LimitExceeded`] names an
/// actuator, too.
pub fn refine_with_forces<
    'w,
    'a: 'w,
    R,
    M,
    C,
    T,
    const N: usize,
    const NX: usize,
    const NS: usize,
    const POINTS: usize,
>(
    robot: &R,
    task: &Task<'a, M, T, NS, C>,
    refinement: &Refinement<T, NX, NS>,
    workspace: &'w mut Workspace<T, NX, POINTS>,
) -> Result<PlanWithForces<'w, M, C, T, N, NX, NS>, Error>
where
    R: Robot<T, N, NX, NS>,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    refine_surveyed(robot, task, refinement, workspace, |rows| survey_forces(robot, rows))
}

/// [`refine`](crate::refine), with a survey of the plan's samples that may refuse it: an
/// [`Error::LimitExceeded`] of the survey gets a duration that would do, if there is one.
///
/// For robots whose forces are known apart from their response Γ: see
/// [`survey_within`](crate::survey_within).
///
/// # Errors
///
/// Those of [`refine`](crate::refine) and of the survey.
pub fn refine_surveyed<
    'w,
    'a: 'w,
    R,
    M,
    C,
    T,
    S,
    const NX: usize,
    const NS: usize,
    const POINTS: usize,
>(
    robot: &R,
    task: &Task<'a, M, T, NS, C>,
    refinement: &Refinement<T, NX, NS>,
    workspace: &'w mut Workspace<T, NX, POINTS>,
    mut survey: impl FnMut(&mut dyn Iterator<Item = Row<T, NX, NS>>) -> Result<S, Error>,
) -> Result<(RefinedPlan<'w, M, C, T, NX, NS>, S), Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let surveyed = surveyed(robot, task, refinement, workspace, &mut survey);
    let (fitted, found) = surveyed.map_err(|error| {
        with_duration(task, error, |stretched| {
            self::surveyed(robot, stretched, refinement, workspace, &mut survey).map(|_| ())
        })
    })?;
    Ok((fitted.plan(task, workspace), found))
}

/// A fit, and what the survey makes of it.
type Surveyed<'p, R, M, C, T, S, const NX: usize, const NS: usize> =
    (Fitted<'p, R, M, C, T, NX, NS>, S);

fn surveyed<'p, R, M, C, T, S, const NX: usize, const NS: usize, const POINTS: usize>(
    robot: &'p R,
    task: &Task<'p, M, T, NS, C>,
    refinement: &Refinement<T, NX, NS>,
    workspace: &mut Workspace<T, NX, POINTS>,
    survey: &mut impl FnMut(&mut dyn Iterator<Item = Row<T, NX, NS>>) -> Result<S, Error>,
) -> Result<Surveyed<'p, R, M, C, T, S, NX, NS>, Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let fitted = fit(robot, task, refinement, workspace)?;
    let found = survey(&mut fitted.plan(task, workspace).rows(robot, 1)?)?;
    Ok((fitted, found))
}
