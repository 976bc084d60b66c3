//! Sweeps of Γ along the plan, each with a step of the control points.

use super::limits::{Bounds, Peaks};
use super::plan::RefinedReport;
use super::problem::{Moments, Problem, Swept, larger, root_mean};
use super::task::Refinement;
use super::window::Window;
use super::workspace::{SpanCurve, Workspace};
use crate::Error;
use crate::constraint::ShapeConstraint;
use crate::linear_algebra::{exceeds, is_finite, norm};
use crate::motion::DesiredMotion;
use nalgebra::SVector;
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// What one sweep found.
struct Found<T: Ordered, const NX: usize, const NS: usize> {
    squares: T,
    motion_squares: T,
    largest: T,
    end: SVector<T, NX>,
    end_velocity: SVector<T, NX>,
    peaks: Peaks<T, NX, NS>,
}

pub(super) fn sweeps<R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
    problem: &Problem<'_, R, M, C, T, NX, NS>,
    refinement: &Refinement<T, NX, NS>,
    count: usize,
    workspace: &mut Workspace<T, NX, POINTS>,
) -> Result<RefinedReport<T, NS>, Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let bounds = Bounds::new(problem.robot, refinement.limits.as_ref());
    let coarse = Problem { window: problem.window.coarse(), ..*problem };
    let mut run = Run {
        bounds: &bounds,
        count,
        refinement,
        coarse: &coarse,
        evaluations: 0,
        sweeps: 0,
        linear_rmse: None,
    };
    run.linear(workspace)?;
    run.approach(workspace)?;
    let (found, converged) = run.finish(problem, workspace)?;
    if let Some(breach) = bounds.first_breach(&found.peaks) {
        return Err(breach);
    }
    let window = &problem.window;
    Ok(RefinedReport {
        output_rmse: root_mean(found.squares, window.count),
        motion_rmse: root_mean(found.motion_squares, window.motion_samples()),
        linear_rmse: run.linear_rmse.unwrap_or_else(T::zero),
        output_max_error: found.largest,
        output_end_error: norm(&found.end),
        output_end_velocity_error: norm(&found.end_velocity),
        peak_shape: found.peaks.magnitude(),
        spans: window.spans,
        sweeps: run.sweeps,
        evaluations: run.evaluations,
        converged,
    })
}

/// How much of the error a step leaves, until it is measured.
const CONTRACTION: f64 = 1.0 / 60.0;

/// The sweeps of one plan.
struct Run<'r, 'p, R: ?Sized, M: ?Sized, C, T: Ordered, const NX: usize, const NS: usize> {
    /// The problem on as few samples as resolve the spline: most of the way is made there.
    coarse: &'r Problem<'p, R, M, C, T, NX, NS>,
    bounds: &'r Bounds<'r, T, NX, NS>,
    refinement: &'r Refinement<T, NX, NS>,
    count: usize,
    evaluations: usize,
    sweeps: usize,
    /// What Γ makes of the linear fit.
    linear_rmse: Option<T>,
}

impl<R, M, C, T, const NX: usize, const NS: usize> Run<'_, '_, R, M, C, T, NX, NS>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    /// The fit of a linear robot, from a curve that stays where it begins: only the desired motion is
    /// sampled.
    fn linear<const POINTS: usize>(
        &self,
        workspace: &mut Workspace<T, NX, POINTS>,
    ) -> Result<(), Error> {
        let Workspace { basis, points, steps, normal, .. } = workspace;
        let (problem, free) = (self.coarse, normal.free());
        let length = problem.window.span_length();
        let resting = points[0];
        let zero = SVector::zeros();
        let mut right = [zero; POINTS];
        let mut moments = Moments::new(0);
        for (index, (span, sigma)) in (0..problem.window.count).zip(problem.window.places()) {
            let time = problem.window.time(index);
            let [shape, ..] = problem.shape(time, &[zero; 3]);
            let error = problem.robot.output(&resting, &shape) - problem.motion.position(time);
            if !is_finite(&error) {
                return Err(self.bounds.explain(problem, time, &shape));
            }
            if span != moments.span {
                moments.flush(basis.span(moments.span), &problem.linear, length, &mut right);
                moments = Moments::new(span);
            }
            moments.add(sigma, &-problem.unwanted(time, &error));
        }
        moments.flush(basis.span(moments.span), &problem.linear, length, &mut right);
        for (step, point) in steps.iter_mut().zip(points.iter()) {
            *step = point - resting;
        }
        normal.solve(self.count, steps, &mut right);
        for index in free {
            points[index] = resting + right[index];
        }
        Ok(())
    }

    /// One sweep of Γ and the step it asks for; the largest of that step's effect and the end errors.
    fn sweep<const POINTS: usize>(
        &mut self,
        problem: &Problem<'_, R, M, C, T, NX, NS>,
        workspace: &mut Workspace<T, NX, POINTS>,
    ) -> Result<(Found<T, NX, NS>, T), Error> {
        let mut gradient = [SVector::zeros(); POINTS];
        let nodes = problem.sweep(&workspace.basis, &workspace.points);
        let found = pass(problem, nodes, self.bounds, workspace, &mut gradient)?;
        workspace.gradient = gradient;
        self.sweeps += 1;
        let rmse = root_mean(found.squares, problem.window.count);
        self.linear_rmse = self.linear_rmse.or(Some(rmse));
        self.evaluations = self.evaluations.saturating_add(problem.window.count);
        let change = step(problem, &self.coarse.window, &found, self.count, workspace)?;
        let error = larger(larger(change, &found.end), &found.end_velocity);
        Ok((found, error))
    }

    /// Sweeps of the coarse samples until the next is expected to find nothing to correct.
    fn approach<const POINTS: usize>(
        &mut self,
        workspace: &mut Workspace<T, NX, POINTS>,
    ) -> Result<(), Error> {
        let mut previous = None;
        while self.sweeps + 1 < self.refinement.max_sweeps {
            let (_, error) = self.sweep(self.coarse, workspace)?;
            advance(self.count, workspace);
            let contraction =
                previous.map_or(T::from_f64(CONTRACTION), |previous| error / previous);
            if !exceeds(error * contraction, self.refinement.tolerance) {
                break;
            }
            previous = Some(error);
        }
        Ok(())
    }

    /// Sweeps of all samples until they confirm the plan.
    fn finish<const POINTS: usize>(
        &mut self,
        problem: &Problem<'_, R, M, C, T, NX, NS>,
        workspace: &mut Workspace<T, NX, POINTS>,
    ) -> Result<(Found<T, NX, NS>, bool), Error> {
        loop {
            let (found, error) = self.sweep(problem, workspace)?;
            let converged = error <= self.refinement.tolerance;
            if converged || self.sweeps >= self.refinement.max_sweeps {
                return Ok((found, converged));
            }
            advance(self.count, workspace);
        }
    }
}

/// One sweep over the samples: errors, peaks, and Jᵀr as `gradient`.
fn pass<R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
    problem: &Problem<'_, R, M, C, T, NX, NS>,
    nodes: impl Iterator<Item = Swept<T, NX, NS>>,
    bounds: &Bounds<'_, T, NX, NS>,
    workspace: &Workspace<T, NX, POINTS>,
    gradient: &mut [SVector<T, NX>; POINTS],
) -> Result<Found<T, NX, NS>, Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let Workspace { basis, points, .. } = workspace;
    *gradient = [SVector::zeros(); POINTS];
    let length = problem.window.span_length();
    let mut moments = Moments::new(0);
    let zero = SVector::zeros();
    let mut found = Found {
        squares: T::zero(),
        motion_squares: T::zero(),
        largest: T::zero(),
        end: zero,
        end_velocity: zero,
        peaks: Peaks::new(),
    };
    for node in nodes {
        let error = problem.output_error(&node);
        if !is_finite(&error) {
            return Err(bounds.explain(problem, node.sample.time, &node.sample.shape));
        }
        if node.sample.span != moments.span {
            moments.flush(basis.span(moments.span), &problem.linear, length, gradient);
            moments = Moments::new(node.sample.span);
        }
        moments.add(node.sample.sigma, &problem.unwanted(node.sample.time, &error));
        let square = error.dot(&error);
        found.squares += square;
        if problem.window.in_motion(node.sample.index) {
            found.motion_squares += square;
        }
        if square > found.largest {
            found.largest = square;
        }
        found.peaks.add(
            node.sample.time,
            &node.sample.shape,
            &node.sample.position(&node.position),
        );
        if node.sample.index + 1 == problem.window.count {
            let curve = SpanCurve::new(basis, points, node.sample.span, length);
            found.end = error;
            found.end_velocity = problem.output_velocity_error(&node, &curve);
        }
    }
    moments.flush(basis.span(moments.span), &problem.linear, length, gradient);
    found.largest = found.largest.sqrt();
    if !found.squares.is_finite() || !is_finite(&found.end_velocity) {
        let time = problem.window.end().to_f64();
        return Err(Error::NonFinite { quantity: "squared error of the plan", time });
    }
    Ok(found)
}

/// Solves for the next steps of the control points; the root mean square by which they will move the
/// output.
fn step<R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
    problem: &Problem<'_, R, M, C, T, NX, NS>,
    factored: &Window<T>,
    found: &Found<T, NX, NS>,
    count: usize,
    workspace: &mut Workspace<T, NX, POINTS>,
) -> Result<T, Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let Workspace { basis, gradient, steps, normal, .. } = workspace;
    let last = problem
        .end_steps(basis, &found.end, &found.end_velocity)
        .ok_or(Error::Singular { matrix: "output Jacobian" })?;
    *steps = [SVector::zeros(); POINTS];
    for (k, step) in last.iter().enumerate() {
        steps[count - 1 - k] = *step;
    }
    // The matrix has been summed over the samples of another window.
    let scale = factored.intervals() / problem.window.intervals();
    for entry in gradient.iter_mut() {
        *entry *= scale;
    }
    let mut right = *gradient;
    for entry in &mut right {
        *entry = -*entry;
    }
    normal.solve(count, steps, &mut right);
    let free = normal.free();
    steps[free.clone()].copy_from_slice(&right[free.clone()]);
    let mut reduction = T::zero();
    for index in free {
        reduction += steps[index].dot(&gradient[index]);
    }
    let change = root_mean(reduction.abs(), factored.count);
    if change.is_finite() {
        return Ok(larger(change, &SVector::<T, 1>::zeros()));
    }
    let time = problem.window.end().to_f64();
    Err(Error::NonFinite { quantity: "step of the control points", time })
}

fn advance<T: Ordered, const NX: usize, const POINTS: usize>(
    count: usize,
    workspace: &mut Workspace<T, NX, POINTS>,
) {
    for (point, step) in workspace.points.iter_mut().zip(&workspace.steps).take(count) {
        *point += step;
    }
}
