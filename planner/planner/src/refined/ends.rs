//! What a plan begins and ends with.

use super::basis::DEGREE;
use super::problem::{Fade, Problem};
use super::task::{Refinement, Start};
use super::window::Window;
use super::workspace::Workspace;
use crate::Error;
use crate::constraint::ShapeConstraint;
use crate::linear_algebra::{column, inverse, largest, norm, solve};
use crate::motion::{DesiredMotion, SmoothStep, Transfer};
use crate::planner::Task;
use crate::reference::OutputMap;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// Control points that the end's rest takes: z, ż, u, u̇ and ü.
pub(super) const REST: usize = 5;

/// Standing makes sense where the motion itself stands.
pub(super) fn check_standing<T: Ordered, M, const NX: usize, const NS: usize>(
    motion: &M,
    refinement: &Refinement<T, NX, NS>,
    step: T,
) -> Result<(), Error>
where
    M: DesiredMotion<T, NX> + ?Sized,
{
    for (standing, time, field) in [
        (refinement.standing_before, T::zero(), "speed at the start of a motion after standing"),
        (
            refinement.standing_after,
            motion.duration(),
            "speed at the end of a motion before standing",
        ),
    ] {
        let [_, velocity, acceleration, ..] = motion.derivatives(time);
        let speed = norm(&velocity);
        // What the motion gathers in one sampling interval is rest as well as can be told.
        if standing > T::zero() && speed > norm(&acceleration) * step + T::epsilon().sqrt() {
            return Err(Error::Invalid { field, value: speed.to_f64(), expected: "0" });
        }
    }
    Ok(())
}

/// On the desired motion, free shape coordinates at rest.
pub(super) fn desired_start<R, M, C, T, const NX: usize, const NS: usize>(
    robot: &R,
    task: &Task<'_, M, T, NS, C>,
    window: &Window<T>,
    map: &OutputMap<T, NX>,
) -> Start<T, NX, NS>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let [shape, shape_velocity, ..] = task.constraint.shape(window.start());
    let [output, output_velocity, ..] = task.motion.derivatives(window.start());
    let offset = robot.output(&SVector::zeros(), &shape);
    let position = map.inverse() * (output - offset);
    let by_shape = robot.output_jacobian_shape(&position, &shape);
    let velocity = map.inverse() * (output_velocity - by_shape * shape_velocity);
    Start { position, velocity, shape, shape_velocity, shape_acceleration: None }
}

/// What is given at the ends of the curve.
pub(super) struct Ends<T: Ordered, const NX: usize> {
    /// u, u̇ and ü at the start.
    pub(super) virtual_start: [SVector<T, NX>; 3],
    /// Control points at the start that are given: ü is, or is not.
    pub(super) given: usize,
}

/// u, u̇ and ü that make the start's free shape. What they do not make is left to fade out.
pub(super) fn begin_at<R, M, C, T, const NX: usize, const NS: usize>(
    problem: &mut Problem<'_, R, M, C, T, NX, NS>,
) -> Result<[SVector<T, NX>; 3], Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let begin = problem.window.start();
    let [shape, rate, second, ..] = problem.constraint.shape(begin);
    let (shape, rate) = (problem.start.shape - shape, problem.start.shape_velocity - rate);
    let read = shape_reader(problem.robot, &problem.gain)?;
    let second = problem.start.shape_acceleration.map_or_else(SVector::zeros, |s| s - second);
    let made = [read * shape, read * rate, read * second];
    let left = [shape - problem.gain * made[0], rate - problem.gain * made[1]];
    let size = largest(shape.iter().chain(rate.iter()).copied());
    let rest = largest(left.iter().flat_map(|v| v.iter().copied()));
    if rest > size * T::epsilon() * T::from_f64(64.0) {
        let two = T::from_f64(2.0);
        let length = problem.window.length();
        let duration = if length < two { length } else { two };
        problem.fade = Some(Fade {
            shape: left[0],
            rate: left[1],
            begin,
            duration,
            step: SmoothStep::new(9)?,
        });
    }
    Ok(made)
}

/// From the start's output, velocity and (near the origin) acceleration to the desired motion.
pub(super) fn catch_up<R, M, C, T, const NX: usize, const NS: usize>(
    problem: &Problem<'_, R, M, C, T, NX, NS>,
    acceleration: &SVector<T, NX>,
    seconds: Option<T>,
) -> Result<Option<Transfer<T, NX>>, Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let Start { position, velocity, shape, shape_velocity, .. } = &problem.start;
    let jacobian = problem.linear.jacobian;
    let by_shape = problem.robot.output_jacobian_shape(position, shape);
    let desired = problem.motion.derivatives(problem.window.start());
    let zero = SVector::zeros();
    let from = [
        problem.robot.output(position, shape) - desired[0],
        jacobian * velocity + by_shape * shape_velocity - desired[1],
        jacobian * acceleration - desired[2],
        zero,
        zero,
    ];
    let size = T::one() + largest(desired.iter().flat_map(|d| d.iter().copied()));
    let off = largest(from.iter().flat_map(|d| d.iter().copied()));
    if off <= size * T::epsilon() * T::from_f64(1024.0) {
        return Ok(None);
    }
    let length = problem.window.length();
    let seconds = seconds.filter(|seconds| *seconds < length).unwrap_or(length);
    Transfer::new(&from, &[zero; 5], seconds).map(Some)
}

/// The matrix that reads u off a shape: by the unactuated coordinates, if K⁰ moves them; what an
/// unactuated coordinate does cannot be forced otherwise. Else by least squares.
fn shape_reader<R, T, const NX: usize, const NS: usize>(
    robot: &R,
    gain: &SMatrix<T, NS, NX>,
) -> Result<SMatrix<T, NX, NS>, Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    T: Ordered,
{
    let description = robot.shape_description();
    let mut rows = [0; NX];
    let mut found = 0;
    for index in description.unactuated_shape().filter(|&index| index < NS) {
        if let Some(row) = rows.get_mut(found) {
            *row = index;
        }
        found += 1;
    }
    let block = SMatrix::<T, NX, NX>::from_fn(|i, j| gain[(rows[i], j)]);
    if found == NX
        && let Some(inverse) = inverse(block)
    {
        let mut read = SMatrix::<T, NX, NS>::zeros();
        for (k, &row) in rows.iter().enumerate() {
            read.set_column(row, &column(&inverse, k));
        }
        return Ok(read);
    }
    let transposed = gain.transpose();
    solve(transposed * gain, transposed).ok_or(Error::Singular { matrix: "initial gain" })
}

/// Puts the control points of both ends in place.
pub(super) fn place_ends<R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
    problem: &Problem<'_, R, M, C, T, NX, NS>,
    ends: &Ends<T, NX>,
    map: &OutputMap<T, NX>,
    workspace: &mut Workspace<T, NX, POINTS>,
) where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let (window, linear, start) = (&problem.window, &problem.linear, &problem.start);
    let length = window.span_length();
    let [u, du, ddu] = ends.virtual_start;
    // z = q_x + τ²u: a choice, which the defect makes up for.
    let first = workspace.basis.end_points(&[
        start.position + linear.position * u,
        (start.velocity + linear.position * du) * length,
        u * (length * length),
        du * (length * length * length),
        ddu * (length * length * length * length),
    ]);
    let goal = problem.motion.derivatives(window.end());
    let shape = problem.constraint.shape(window.end())[0];
    let position = map.inverse() * (goal[0] - problem.robot.output(&SVector::zeros(), &shape));
    let zero = SVector::zeros();
    let velocity = map.inverse() * goal[1];
    let last = workspace.basis.end_points(&[position, -velocity * length, zero, zero, zero]);

    let count = window.spans + DEGREE;
    let points = &mut workspace.points;
    points[..ends.given].copy_from_slice(&first[..ends.given]);
    for (k, point) in last.iter().enumerate() {
        points[count - 1 - k] = *point;
    }
}
