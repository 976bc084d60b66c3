//! Sweeps of Γ along the plan, each with a step of the control points.

use super::limits::{Bounds, Peaks};
use super::plan::RefinedReport;
use super::problem::{Moments, Problem, Sums, larger, root_mean};
use super::secant::Secant;
use super::spans::INTERVALS;
use super::task::Refinement;
use super::workspace::{SpanCurve, Workspace};
use crate::Error;
use crate::constraint::ShapeConstraint;
use crate::linear_algebra::{exceeds, is_finite, norm};
use crate::motion::DesiredMotion;
use nalgebra::SVector;
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// What one sweep found.
struct Found<T: Ordered, const NX: usize, const NS: usize> {
    sums: Sums<T, NX>,
    motion_squares: T,
    largest: T,
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
    problem.fit_linear(count, &bounds, workspace)?;
    let mut run = Run {
        problem,
        bounds: &bounds,
        count,
        refinement,
        evaluations: 0,
        sweeps: 0,
        linear_rmse: None,
    };
    run.approach(workspace)?;
    let (found, converged) = run.finish(workspace)?;
    if let Some(breach) = bounds.first_breach(&found.peaks) {
        return Err(breach);
    }
    let window = &problem.window;
    Ok(RefinedReport {
        output_rmse: root_mean(found.sums.squares, window.count),
        motion_rmse: root_mean(found.motion_squares, window.motion_samples()),
        linear_rmse: run.linear_rmse.unwrap_or_else(T::zero),
        output_max_error: found.largest,
        output_end_error: norm(&found.sums.end),
        output_end_velocity_error: norm(&found.sums.end_velocity),
        peak_shape: found.peaks.magnitude(),
        spans: window.spans,
        sweeps: run.sweeps,
        evaluations: run.evaluations,
        converged,
    })
}

/// The sweeps of one plan.
struct Run<'r, 'p, R: ?Sized, M: ?Sized, C, T: Ordered, const NX: usize, const NS: usize> {
    problem: &'r Problem<'p, R, M, C, T, NX, NS>,
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
    /// Counts a sweep of `samples` samples of root mean squared error `rmse`, and finds the step it asks
    /// for; the largest of that step's effect and the end errors. Inside the window the samples count
    /// as if their weights summed up to `weight`.
    fn step<const POINTS: usize>(
        &mut self,
        sums: &Sums<T, NX>,
        (samples, weight): (usize, usize),
        rmse: T,
        workspace: &mut Workspace<T, NX, POINTS>,
    ) -> Result<T, Error> {
        self.sweeps += 1;
        self.evaluations = self.evaluations.saturating_add(samples);
        self.linear_rmse = self.linear_rmse.or(Some(rmse));
        let change = step(self.problem, sums, weight, self.count, workspace)?;
        Ok(larger(larger(change, &sums.end), &sums.end_velocity))
    }

    /// Sweeps of few samples: two, and more until the next is expected to find nothing to correct.
    /// Two are what a plan from a moving robot takes; one from rest is made better by the second, and
    /// both take the same time.
    fn approach<const POINTS: usize>(
        &mut self,
        workspace: &mut Workspace<T, NX, POINTS>,
    ) -> Result<(), Error> {
        let spans = self.problem.window.spans;
        let (mut previous, mut secant) = (None::<T>, Secant::new());
        while self.sweeps + 1 < self.refinement.max_sweeps {
            let sums = self.problem.sweep_spans(self.bounds, workspace)?;
            let rmse = root_mean(sums.squares, spans);
            let error = self.step(&sums, (INTERVALS * spans + 1, spans), rmse, workspace)?;
            secant.correct(self.count, &mut workspace.steps);
            advance(self.count, workspace);
            // A step leaves of an error what the step before has left of its own.
            let left = previous.map(|previous| error * (error / previous));
            if left.is_some_and(|left| !exceeds(left, self.refinement.tolerance)) {
                break;
            }
            previous = Some(error);
        }
        Ok(())
    }

    /// Sweeps of all samples until they confirm the plan.
    fn finish<const POINTS: usize>(
        &mut self,
        workspace: &mut Workspace<T, NX, POINTS>,
    ) -> Result<(Found<T, NX, NS>, bool), Error> {
        let mut secant = Secant::new();
        loop {
            let found = pass(self.problem, self.bounds, workspace)?;
            let samples = self.problem.window.count;
            let rmse = root_mean(found.sums.squares, samples);
            let error = self.step(&found.sums, (samples, samples - 1), rmse, workspace)?;
            let converged = error <= self.refinement.tolerance;
            if converged || self.sweeps >= self.refinement.max_sweeps {
                return Ok((found, converged));
            }
            secant.correct(self.count, &mut workspace.steps);
            advance(self.count, workspace);
        }
    }
}

/// One sweep over the samples: errors, peaks, and Jᵀr as the workspace's gradient.
fn pass<R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
    problem: &Problem<'_, R, M, C, T, NX, NS>,
    bounds: &Bounds<'_, T, NX, NS>,
    workspace: &mut Workspace<T, NX, POINTS>,
) -> Result<Found<T, NX, NS>, Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let Workspace { basis, points, gradient, .. } = workspace;
    *gradient = [SVector::zeros(); POINTS];
    let (length, last) = (problem.window.span_length(), problem.window.count - 1);
    let mut moments = Moments::new(0);
    let (sums, zero) = (Sums::new(), T::zero());
    let mut found = Found { sums, motion_squares: zero, largest: zero, peaks: Peaks::new() };
    let (mut swept, mut index) = (problem.sweep(basis, points), 0);
    while let Some((node, velocity, position)) = swept.next_node() {
        let error = problem.output_error(node, position);
        if !is_finite(&error) {
            return Err(bounds.explain(problem, node.time, &node.shape));
        }
        if node.span != moments.span {
            moments.flush(basis.span(moments.span), &problem.linear, length, gradient);
            moments = Moments::new(node.span);
        }
        moments.add(node.sigma, &problem.unwanted(node.time, &error));
        let square = error.dot(&error);
        found.sums.squares += square;
        if problem.window.in_motion(index) {
            found.motion_squares += square;
        }
        if square > found.largest {
            found.largest = square;
        }
        found.peaks.add(node.time, &node.shape, &node.position(position));
        if index == last {
            let curve = SpanCurve::new(basis, points, node.span, length);
            problem.finish(&curve, position, velocity, &mut found.sums);
        }
        index += 1;
    }
    moments.flush(basis.span(moments.span), &problem.linear, length, gradient);
    found.largest = found.largest.sqrt();
    found.sums.check(problem)?;
    Ok(found)
}

/// Solves for the next steps of the control points; the root mean square by which they will move the
/// output. `weight` is the sum of the weights of the samples that the gradient was summed over.
fn step<R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
    problem: &Problem<'_, R, M, C, T, NX, NS>,
    sums: &Sums<T, NX>,
    weight: usize,
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
        .end_steps(basis, &sums.end, &sums.end_velocity)
        .ok_or(Error::Singular { matrix: "output Jacobian" })?;
    *steps = [SVector::zeros(); POINTS];
    for (k, step) in last.iter().enumerate() {
        steps[count - 1 - k] = *step;
    }
    // The matrix has weight one in every span.
    let spans = problem.window.spans;
    let scale = T::from_f64(spans as f64) / T::from_f64(weight as f64);
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
    let change = root_mean(reduction.abs(), spans);
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
