//! The sweeps: linear fit, then corrections for what Γ does beyond its linearisation.

use super::gram;
use super::limits::{Bounds, Peaks};
use super::plan::{RefinedPlan, RefinedReport};
use super::problem::{Fade, Linearised, Moments, Problem, Swept, larger, root_mean};
use super::task::{Refinement, Start};
use super::window::Window;
use super::workspace::{SpanCurve, Workspace};
use crate::Error;
use crate::constraint::ShapeConstraint;
use crate::linear_algebra::{column, inverse, is_finite, largest, norm, solve};
use crate::motion::{DesiredMotion, SmoothStep, Stretched, Transfer};
use crate::planner::{Task, check_description};
use crate::reference::{Grid, OutputMap};
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// Control points that the end's rest takes: z, ż, u, u̇ and ü.
const REST: usize = 5;

/// Plans a shape trajectory q_s = K⁰ u(t) whose virtual acceleration u is a clamped quintic B-spline,
/// so that the robot's output follows the desired motion as closely as its dynamics allow.
///
/// Near the origin ẍ = u − τ²ü: this operator, on the flat output z with u = z̈, is the fixed Jacobian
/// of the problem. It is factored once; each sweep evaluates Γ once per sample and corrects for the
/// difference. At the end u, u̇ and ü are zero, at the start as well unless the plan begins in a given
/// [`Start`]: from there q_s and q̇_s are continuous.
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
    let fitted = fit(robot, task, refinement, workspace).map_err(|error| match error {
        Error::LimitExceeded { coordinate, unit, time, value, lower, upper, duration: _ } => {
            let duration = sufficient_duration(robot, task, refinement, workspace, &error);
            Error::LimitExceeded { coordinate, unit, time, value, lower, upper, duration }
        }
        other => other,
    })?;
    let Fitted { map, problem, report } = fitted;
    Ok(RefinedPlan {
        motion: task.motion,
        constraint: task.constraint,
        map,
        window: problem.window,
        gain: problem.gain,
        linear: problem.linear,
        start: problem.start,
        fade: problem.fade,
        basis: &workspace.basis,
        points: &workspace.points,
        report,
    })
}

/// What a fit leaves beside the control points in the workspace.
struct Fitted<'p, R: ?Sized, M: ?Sized, C, T: Ordered, const NX: usize, const NS: usize> {
    map: OutputMap<T, NX>,
    problem: Problem<'p, R, M, C, T, NX, NS>,
    report: RefinedReport<T, NS>,
}

/// A duration of the desired motion with which the plan keeps its limits: tried out, not guessed.
fn sufficient_duration<R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
    robot: &R,
    task: &Task<'_, M, T, NS, C>,
    refinement: &Refinement<T, NX, NS>,
    workspace: &mut Workspace<T, NX, POINTS>,
    error: &Error,
) -> Option<f64>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let (mut factor, mut error) = (1.0_f64, *error);
    for _ in 0..8 {
        let Error::LimitExceeded { value, lower, upper, .. } = error else {
            return None;
        };
        let bound = if value > upper { upper } else { lower };
        // Accelerations go with the inverse square of the duration.
        let excess = libm_sqrt::<T>(value / bound);
        if !(excess.is_finite() && excess > 0.0) {
            return None;
        }
        factor *= (excess * 1.01).clamp(1.02, 4.0);
        let motion = Stretched::new(task.motion, T::from_f64(factor)).ok()?;
        let stretched = Task {
            motion: &motion,
            samples: task.samples,
            weighting: task.weighting,
            objective: task.objective,
            parametrisation: task.parametrisation,
            optimiser: task.optimiser,
            constraint: task.constraint,
        };
        match fit(robot, &stretched, refinement, workspace) {
            Ok(_) => return Some(motion.duration().to_f64()),
            Err(next) => error = next,
        }
    }
    None
}

fn libm_sqrt<T: Ordered>(value: f64) -> f64 {
    T::from_f64(value).sqrt().to_f64()
}

fn fit<'p, R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
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
    let mut ends = Ends { virtual_start: [SVector::zeros(); 2], given: REST };
    if let Some(start) = &refinement.start {
        problem.start = *start;
        ends = Ends { virtual_start: begin_at(&mut problem)?, given: REST - 1 };
        problem.catch_up = catch_up(&problem, &ends.virtual_start[0], refinement.catch_up)?;
    }
    workspace.basis.prepare(window.spans);
    place_ends(&problem, &ends, &map, workspace);
    gram::assemble(&workspace.basis, &window.thinned(), &linear, &mut workspace.normal);
    let count = window.spans + super::basis::DEGREE;
    workspace
        .normal
        .factor(ends.given, count - REST)
        .ok_or(Error::Singular { matrix: "fit of the spline" })?;
    let report = sweeps(&problem, refinement, count, workspace)?;
    Ok(Fitted { map, problem, report })
}

/// Standing makes sense where the motion itself stands.
fn check_standing<T: Ordered, M, const NX: usize, const NS: usize>(
    motion: &M,
    refinement: &Refinement<T, NX, NS>,
    step: T,
) -> Result<(), Error>
where
    M: DesiredMotion<T, NX> + ?Sized,
{
    for (standing, time, field) in [
        (refinement.standing_before, T::zero(), "speed at the start of a motion after standing"),
        (refinement.standing_after, motion.duration(), "speed at the end of a motion before standing"),
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
fn desired_start<R, M, C, T, const NX: usize, const NS: usize>(
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
    Start { position, velocity, shape, shape_velocity }
}

/// What is given at the ends of the curve.
struct Ends<T: Ordered, const NX: usize> {
    /// u and u̇ at the start.
    virtual_start: [SVector<T, NX>; 2],
    /// Control points at the start that are given: with rest also ü.
    given: usize,
}

/// u and u̇ that make the start's free shape. What they do not make is left to fade out.
fn begin_at<R, M, C, T, const NX: usize, const NS: usize>(
    problem: &mut Problem<'_, R, M, C, T, NX, NS>,
) -> Result<[SVector<T, NX>; 2], Error>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    let begin = problem.window.start();
    let [shape, rate, ..] = problem.constraint.shape(begin);
    let (shape, rate) = (problem.start.shape - shape, problem.start.shape_velocity - rate);
    let read = shape_reader(problem.robot, &problem.gain)?;
    let made = [read * shape, read * rate];
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
fn catch_up<R, M, C, T, const NX: usize, const NS: usize>(
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
    let Start { position, velocity, shape, shape_velocity } = &problem.start;
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

/// Puts the control points of both ends in place, and the others on the line between.
fn place_ends<R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
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
    let [u, du] = ends.virtual_start;
    // z = q_x + τ²u: a choice, which the defect makes up for.
    let first = workspace.basis.end_points(&[
        start.position + linear.position * u,
        (start.velocity + linear.position * du) * length,
        u * (length * length),
        du * (length * length * length),
        SVector::zeros(),
    ]);
    let goal = problem.motion.derivatives(window.end());
    let shape = problem.constraint.shape(window.end())[0];
    let position = map.inverse() * (goal[0] - problem.robot.output(&SVector::zeros(), &shape));
    let zero = SVector::zeros();
    let velocity = map.inverse() * goal[1];
    let last = workspace.basis.end_points(&[position, -velocity * length, zero, zero, zero]);

    let count = window.spans + super::basis::DEGREE;
    let points = &mut workspace.points;
    points[..ends.given].copy_from_slice(&first[..ends.given]);
    for (k, point) in last.iter().enumerate() {
        points[count - 1 - k] = *point;
    }
    let (from, to) = (points[ends.given - 1], points[count - REST]);
    let way = T::from_f64((count - REST - ends.given + 1) as f64);
    for index in ends.given..count - REST {
        let part = T::from_f64((index + 1 - ends.given) as f64) / way;
        points[index] = from + (to - from) * part;
    }
}

/// What one sweep found.
struct Found<T: Ordered, const NX: usize, const NS: usize> {
    squares: T,
    motion_squares: T,
    largest: T,
    end: SVector<T, NX>,
    end_velocity: SVector<T, NX>,
    peaks: Peaks<T, NX, NS>,
}

fn sweeps<R, M, C, T, const NX: usize, const NS: usize, const POINTS: usize>(
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
    let coarse = Problem { window: problem.window.thinned(), ..*problem };
    let mut run = Run { bounds: &bounds, count, refinement, coarse: &coarse, evaluations: 0, sweeps: 0 };
    let linear = run.linear(workspace)?;
    advance(count, workspace);
    run.approach(workspace)?;
    let (found, converged) = run.finish(problem, workspace)?;
    if let Some(breach) = bounds.first_breach(&found.peaks) {
        return Err(breach);
    }
    let window = &problem.window;
    Ok(RefinedReport {
        output_rmse: root_mean(found.squares, window.count),
        motion_rmse: root_mean(found.motion_squares, window.motion_samples()),
        linear_rmse: linear,
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
}

impl<R, M, C, T, const NX: usize, const NS: usize> Run<'_, '_, R, M, C, T, NX, NS>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    /// The step to the fit of a linear robot, and the error it starts from.
    fn linear<const POINTS: usize>(
        &self,
        workspace: &mut Workspace<T, NX, POINTS>,
    ) -> Result<T, Error> {
        let mut gradient = [SVector::zeros(); POINTS];
        let nodes = self.coarse.linear_sweep(&workspace.basis, &workspace.points);
        let found = pass(self.coarse, nodes, self.bounds, workspace, &mut gradient)?;
        workspace.gradient = gradient;
        step(self.coarse, &self.coarse.window, &found, self.count, workspace)?;
        Ok(root_mean(found.squares, self.coarse.window.count))
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
        self.evaluations = self.evaluations.saturating_add(problem.window.count);
        let change = step(problem, &self.coarse.window, &found, self.count, workspace)?;
        let error = larger(larger(change, &found.end), &found.end_velocity);
        Ok((found, error))
    }

    /// Sweeps of the thinned samples until the next is expected to find nothing to correct.
    fn approach<const POINTS: usize>(
        &mut self,
        workspace: &mut Workspace<T, NX, POINTS>,
    ) -> Result<(), Error> {
        let mut previous = None;
        while self.sweeps + 1 < self.refinement.max_sweeps {
            let (_, error) = self.sweep(self.coarse, workspace)?;
            advance(self.count, workspace);
            let contraction = previous.map_or(T::from_f64(CONTRACTION), |previous| error / previous);
            if !(error * contraction > self.refinement.tolerance) {
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
    let mut last = None;
    for node in nodes {
        let error = problem.output_error(&node);
        if !is_finite(&error) {
            return Err(bounds.explain(problem, &node.sample));
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
        found.peaks.add(node.sample.time, &node.sample.shape, &node.sample.position(&node.position));
        last = Some((node, error));
    }
    moments.flush(basis.span(moments.span), &problem.linear, length, gradient);
    found.largest = found.largest.sqrt();
    if let Some((node, error)) = last {
        let curve = SpanCurve::new(basis, points, node.sample.span, length);
        found.end = error;
        found.end_velocity = problem.output_velocity_error(&node, &curve);
    }
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
    normal.shift_given(count, steps, &mut right);
    normal.solve(&mut right);
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
