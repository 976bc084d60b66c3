//! The residual of a refined plan and its fixed linearisation.

use super::basis::{Basis, ORDER, SpanBasis};
use super::task::Start;
use super::window::Window;
use super::workspace::SpanCurve;
use crate::Error;
use crate::constraint::ShapeConstraint;
use crate::integrate::{Accelerated, DoubleIntegral};
use crate::linear_algebra::{inverse, is_finite, norm, solve};
use crate::motion::{DesiredMotion, SmoothStep, Transfer};
use crate::reference::OutputMap;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// q̈_x = u − τ²ü near the origin, with q_s = K⁰u.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Linearised<T: Ordered, const NX: usize> {
    /// τ² of the position variables: −∂Γ/∂q̈_s K⁰.
    pub(crate) position: SMatrix<T, NX, NX>,
    /// τ² of the output: the shape moves the output as well.
    pub(crate) output: SMatrix<T, NX, NX>,
    /// ∂h/∂q_x.
    pub(crate) jacobian: SMatrix<T, NX, NX>,
}

impl<T: Ordered, const NX: usize> Linearised<T, NX> {
    pub(crate) fn new<R, const NS: usize>(
        robot: &R,
        gain: &SMatrix<T, NS, NX>,
        map: &OutputMap<T, NX>,
    ) -> Result<Self, Error>
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
    {
        let origin = SVector::zeros();
        let position = -(robot.response(&origin, &origin, &origin).d_qsdd * gain);
        let through_shape = robot.output_jacobian_shape(&SVector::zeros(), &origin) * gain;
        let singular = Error::Singular { matrix: "output Jacobian" };
        let output = position - solve(map.jacobian, through_shape).ok_or(singular)?;
        if !is_finite(&output) {
            return Err(Error::NonFiniteMatrix { matrix: "time constant of the response" });
        }
        Ok(Self { position, output, jacobian: map.jacobian })
    }
}

/// The part of the start's shape that no virtual acceleration makes; it fades out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fade<T: Ordered, const NS: usize> {
    pub(crate) shape: SVector<T, NS>,
    pub(crate) rate: SVector<T, NS>,
    pub(crate) begin: T,
    pub(crate) duration: T,
    pub(crate) step: SmoothStep,
}

impl<T: Ordered, const NS: usize> Fade<T, NS> {
    /// (e + ė t)(1 − s) with two derivatives.
    pub(crate) fn add(&self, time: T, shape: &mut [SVector<T, NS>; 3]) {
        let t = time - self.begin;
        if t >= self.duration {
            return;
        }
        let s = self.step.derivatives(t / self.duration);
        let (ds, dds) = (s[1] / self.duration, s[2] / (self.duration * self.duration));
        let line = self.shape + self.rate * t;
        shape[0] += line * (T::one() - s[0]);
        shape[1] += self.rate * (T::one() - s[0]) - line * ds;
        shape[2] -= self.rate * (ds + ds) + line * dds;
    }
}

/// Everything that a sweep needs beside the control points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Problem<'p, R: ?Sized, M: ?Sized, C, T: Ordered, const NX: usize, const NS: usize>
{
    pub(crate) robot: &'p R,
    pub(crate) motion: &'p M,
    pub(crate) constraint: C,
    pub(crate) window: Window<T>,
    pub(crate) gain: SMatrix<T, NS, NX>,
    pub(crate) linear: Linearised<T, NX>,
    pub(crate) start: Start<T, NX, NS>,
    pub(crate) fade: Option<Fade<T, NS>>,
    /// How a start off the desired motion catches up: the error that is asked for, over time since the
    /// window's start.
    pub(crate) catch_up: Option<Transfer<T, NX>>,
}

/// One sample of a sweep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node<T: Ordered, const NX: usize, const NS: usize> {
    pub(crate) span: usize,
    pub(crate) sigma: T,
    pub(crate) time: T,
    /// q_s.
    pub(crate) shape: SVector<T, NS>,
    /// z − τ²u: q_x if the robot were linear.
    model: SVector<T, NX>,
    /// Γ − (u − τ²ü).
    defect: SVector<T, NX>,
}

impl<T: Ordered, const NX: usize, const NS: usize> Accelerated<T> for Node<T, NX, NS> {
    type Acceleration = SVector<T, NX>;
    fn acceleration(&self) -> &Self::Acceleration {
        &self.defect
    }
}

impl<T: Ordered, const NX: usize, const NS: usize> Node<T, NX, NS> {
    /// Γ − (u − τ²ü).
    pub(crate) fn defect(&self) -> &SVector<T, NX> {
        &self.defect
    }

    /// q_x.
    pub(crate) fn position(&self, defect: &SVector<T, NX>) -> SVector<T, NX> {
        self.model + defect
    }
}

impl<R, M, C, T, const NX: usize, const NS: usize> Problem<'_, R, M, C, T, NX, NS>
where
    T: Ordered,
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
{
    /// q_s, q̇_s, q̈_s.
    #[inline(always)]
    pub(crate) fn shape(&self, time: T, u: &[SVector<T, NX>; 3]) -> [SVector<T, NS>; 3] {
        let [a, b, c, ..] = self.constraint.shape(time);
        let mut shape = [a + self.gain * u[0], b + self.gain * u[1], c + self.gain * u[2]];
        if let Some(fade) = &self.fade {
            fade.add(time, &mut shape);
        }
        shape
    }

    #[inline(always)]
    pub(crate) fn node(
        &self,
        time: T,
        (span, sigma): (usize, T),
        curve: &SpanCurve<T, NX>,
    ) -> Node<T, NX, NS> {
        let u = curve.acceleration(sigma);
        let [shape, shape_velocity, shape_acceleration] = self.shape(time, &u);
        let defect = self.robot.gamma(&shape, &shape_velocity, &shape_acceleration) - u[0]
            + self.linear.position * u[2];
        let model = curve.flat(sigma) - self.linear.position * u[0];
        Node { span, sigma, time, shape, model, defect }
    }

    /// Samples, to be asked for in order.
    fn nodes<'s>(
        &'s self,
        basis: &'s Basis<T>,
        points: &'s [SVector<T, NX>],
    ) -> impl FnMut(usize) -> Node<T, NX, NS> + 's {
        let length = self.window.span_length();
        let mut curve = SpanCurve::new(basis, points, 0, length);
        let mut current = 0;
        let mut places = self.window.places();
        move |index| {
            let place = places.next().unwrap_or((current, T::one()));
            if place.0 != current {
                current = place.0;
                curve = SpanCurve::new(basis, points, current, length);
            }
            self.node(self.window.time(index), place, &curve)
        }
    }

    /// The plan's samples with the defect integrated twice from the start state.
    pub(crate) fn sweep<'s>(
        &'s self,
        basis: &'s Basis<T>,
        points: &'s [SVector<T, NX>],
    ) -> DoubleIntegral<T, Node<T, NX, NS>, impl FnMut(usize) -> Node<T, NX, NS> + 's> {
        let length = self.window.span_length();
        let curve = SpanCurve::new(basis, points, 0, length);
        let (velocity, position) = self.begin(&curve);
        let source = self.nodes(basis, points);
        DoubleIntegral::new(self.window.count, self.window.step(), velocity, position, source)
    }

    /// What the start state has beyond z − τ²u: velocity and position, on the curve's first span.
    pub(crate) fn begin(&self, curve: &SpanCurve<T, NX>) -> (SVector<T, NX>, SVector<T, NX>) {
        let [u, ..] = curve.acceleration(T::zero());
        let model = curve.flat(T::zero()) - self.linear.position * u;
        let velocity = self.start.velocity - self.model_velocity(T::zero(), curve);
        (velocity, self.start.position - model)
    }

    /// ż − τ²u̇.
    fn model_velocity(&self, sigma: T, curve: &SpanCurve<T, NX>) -> SVector<T, NX> {
        let [_, rate, _] = curve.acceleration(sigma);
        curve.flat_rate(sigma, self.window.span_length()) - self.linear.position * rate
    }

    /// h(q_x, q_s) − x^d at a sample, where the defect has led to `defect`.
    pub(crate) fn output_error(
        &self,
        node: &Node<T, NX, NS>,
        defect: &SVector<T, NX>,
    ) -> SVector<T, NX> {
        self.robot.output(&node.position(defect), &node.shape) - self.motion.position(node.time)
    }

    /// The part of that error which is not asked for.
    pub(crate) fn unwanted(&self, time: T, error: &SVector<T, NX>) -> SVector<T, NX> {
        match &self.catch_up {
            None => *error,
            Some(catch_up) => error - catch_up.position(time - self.window.start()),
        }
    }

    /// Errors of the output and its velocity at the window's end: position and velocity are what the
    /// defect has led to.
    pub(crate) fn finish(
        &self,
        curve: &SpanCurve<T, NX>,
        position: &SVector<T, NX>,
        velocity: &SVector<T, NX>,
        sums: &mut Sums<T, NX>,
    ) {
        let (time, end) = (self.window.end(), T::one());
        let u = curve.acceleration(end);
        let [shape, rate, _] = self.shape(time, &u);
        let position = curve.flat(end) - self.linear.position * u[0] + position;
        let velocity = self.model_velocity(end, curve) + velocity;
        let by_shape = self.robot.output_jacobian_shape(&position, &shape);
        let [desired, desired_velocity, ..] = self.motion.derivatives(time);
        sums.end = self.robot.output(&position, &shape) - desired;
        sums.end_velocity = self.linear.jacobian * velocity + by_shape * rate - desired_velocity;
    }

    /// Steps of the first control points from the end that cancel the end errors, last point first.
    pub(crate) fn end_steps(
        &self,
        basis: &Basis<T>,
        error: &SVector<T, NX>,
        velocity_error: &SVector<T, NX>,
    ) -> Option<[SVector<T, NX>; 5]> {
        let inverse = inverse(self.linear.jacobian)?;
        let zero = SVector::zeros();
        let slope = inverse * velocity_error * self.window.span_length();
        Some(basis.end_points(&[-(inverse * error), slope, zero, zero, zero]))
    }
}

/// What every sweep finds: the sum of squared errors, and the errors at the end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sums<T: Ordered, const NX: usize> {
    pub(crate) squares: T,
    pub(crate) end: SVector<T, NX>,
    pub(crate) end_velocity: SVector<T, NX>,
}

impl<T: Ordered, const NX: usize> Sums<T, NX> {
    pub(crate) fn new() -> Self {
        let zero = SVector::zeros();
        Self { squares: T::zero(), end: zero, end_velocity: zero }
    }

    /// These, if they are numbers.
    pub(crate) fn check<R: ?Sized, M: ?Sized, C, const NS: usize>(
        self,
        problem: &Problem<'_, R, M, C, T, NX, NS>,
    ) -> Result<Self, Error> {
        if self.squares.is_finite() && is_finite(&self.end) && is_finite(&self.end_velocity) {
            return Ok(self);
        }
        let time = problem.window.end().to_f64();
        Err(Error::NonFinite { quantity: "squared error of the plan", time })
    }
}

/// Sums of a residual times powers of σ over one span.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments<T: Ordered, const NX: usize> {
    pub(crate) span: usize,
    sums: [SVector<T, NX>; ORDER],
}

impl<T: Ordered, const NX: usize> Moments<T, NX> {
    pub(crate) fn new(span: usize) -> Self {
        Self { span, sums: [SVector::zeros(); ORDER] }
    }

    #[inline]
    pub(crate) fn add(&mut self, sigma: T, residual: &SVector<T, NX>) {
        let mut weighted = *residual;
        for sum in &mut self.sums {
            *sum += weighted;
            weighted *= sigma;
        }
    }

    /// Adds Σ (b_i − τ² b̈_i)ᵀ Jᵀ r of the span to the gradient.
    pub(crate) fn flush(
        &self,
        basis: &SpanBasis<T>,
        linear: &Linearised<T, NX>,
        length: T,
        gradient: &mut [SVector<T, NX>],
    ) {
        let (jacobian, lag) = (linear.jacobian.transpose(), linear.output.transpose());
        let squared = T::one() / (length * length);
        // Σ (σᵏ − τ²(σᵏ)̈)ᵀ Jᵀ r.
        let mut sums = self.sums;
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = jacobian * self.sums[k];
            if k > 1 {
                let bend = squared * T::from_f64((k * (k - 1)) as f64);
                *sum -= lag * (jacobian * self.sums[k - 2]) * bend;
            }
        }
        for (function, entry) in basis.iter().zip(gradient.iter_mut().skip(self.span)) {
            for (sum, &coefficient) in sums.iter().zip(function) {
                *entry += sum * coefficient;
            }
        }
    }
}

/// Root of a sum of squares over `count` samples.
pub(crate) fn root_mean<T: Ordered>(sum: T, count: usize) -> T {
    (sum / T::from_f64(count as f64)).sqrt()
}

/// Largest of two magnitudes, the second that of a vector.
pub(crate) fn larger<T: Ordered, const NX: usize>(a: T, b: &SVector<T, NX>) -> T {
    let b = norm(b);
    if b > a { b } else { a }
}
