//! Refined plans.

use super::basis::Basis;
use super::problem::{Fade, Linearised};
use super::task::Start;
use super::window::Window;
use super::workspace::SpanCurve;
use crate::constraint::ShapeConstraint;
use crate::error::Error;
use crate::integrate::DoubleIntegral;
use crate::motion::DesiredMotion;
use crate::plan::{PlanPoint, Row, Sample};
use crate::reference::OutputMap;
use core::fmt;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// How well a refined plan does, over its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefinedReport<T: Ordered, const NS: usize> {
    /// Root of the mean squared ‖h(q_x^p, q_s^p) − x^d‖ over the whole window, metres.
    pub output_rmse: T,
    /// The same inside the motion's own time.
    pub motion_rmse: T,
    /// Root of the mean squared error of the linear fit, before Γ corrected it.
    pub linear_rmse: T,
    /// The largest ‖h(q_x^p, q_s^p) − x^d‖, metres.
    pub output_max_error: T,
    /// ‖h(q_x^p, q_s^p) − x^d‖ at the window's end, metres.
    pub output_end_error: T,
    /// The same of the velocity, metres per second.
    pub output_end_velocity_error: T,
    /// The largest |q_s^p| of each shape coordinate.
    pub peak_shape: SVector<T, NS>,
    /// Spans of the spline.
    pub spans: usize,
    /// Sweeps of Γ along the plan.
    pub sweeps: usize,
    /// Evaluations of Γ.
    pub evaluations: usize,
    /// Whether the sweeps ended below the tolerance.
    pub converged: bool,
}

/// A shape trajectory q_s = K⁰ u(t), plus the constrained shape. It borrows its control points from the
/// workspace.
pub struct RefinedPlan<'a, M: ?Sized, C, T: Ordered, const NX: usize, const NS: usize> {
    pub(crate) motion: &'a M,
    pub(crate) constraint: C,
    pub(crate) map: OutputMap<T, NX>,
    pub(crate) window: Window<T>,
    pub(crate) gain: SMatrix<T, NS, NX>,
    pub(crate) linear: Linearised<T, NX>,
    pub(crate) start: Start<T, NX, NS>,
    pub(crate) fade: Option<Fade<T, NS>>,
    pub(crate) basis: &'a Basis<T>,
    pub(crate) points: &'a [SVector<T, NX>],
    pub(crate) report: RefinedReport<T, NS>,
}

impl<M: ?Sized, C, T: Ordered, const NX: usize, const NS: usize> fmt::Debug
    for RefinedPlan<'_, M, C, T, NX, NS>
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RefinedPlan")
            .field("window", &self.window)
            .field("gain", &self.gain)
            .field("start", &self.start)
            .field("report", &self.report)
            .finish_non_exhaustive()
    }
}

impl<'a, M, C, T, const NX: usize, const NS: usize> RefinedPlan<'a, M, C, T, NX, NS>
where
    M: DesiredMotion<T, NX> + ?Sized,
    T: Ordered,
{
    /// The desired motion that the plan follows.
    pub fn motion(&self) -> &'a M {
        self.motion
    }

    /// K⁰_qx, what turns u into a shape.
    pub fn gain(&self) -> &SMatrix<T, NS, NX> {
        &self.gain
    }

    /// τ² of the output, s²: near the origin h = x with ẍ = u − τ²ü. It depends on the weighting; it may
    /// be zero, have any sign, and couple the axes.
    pub fn time_constant(&self) -> &SMatrix<T, NX, NX> {
        &self.linear.output
    }

    /// The state in which the plan begins.
    pub fn start(&self) -> &Start<T, NX, NS> {
        &self.start
    }

    /// When the plan opens, seconds since the motion's start: not positive.
    pub fn start_time(&self) -> T {
        self.window.start()
    }

    /// When the plan closes, seconds since the motion's start.
    pub fn end_time(&self) -> T {
        self.window.end()
    }

    /// Number of samples that the plan was made with, standing included.
    pub fn samples(&self) -> usize {
        self.window.count
    }

    /// How well the plan does.
    pub fn report(&self) -> &RefinedReport<T, NS> {
        &self.report
    }

    /// Control points of u: those of a clamped quintic B-spline on `spans` equal spans, `spans` + 5.
    pub fn virtual_points(&self) -> impl ExactSizeIterator<Item = SVector<T, NX>> + '_ {
        let spans = self.window.spans;
        let knot = move |k: usize| k.saturating_sub(7).min(spans);
        let length = self.window.span_length();
        // Derivative of a B-spline: differences over the knots that a function lives on.
        let slope = move |index: usize, degree: usize, a: SVector<T, NX>, b: SVector<T, NX>| {
            let width = knot(index + degree + 1) - knot(index + 1);
            (b - a) * (T::from_f64(degree as f64) / (length * T::from_f64(width as f64)))
        };
        let point =
            move |index: usize| self.points.get(index).copied().unwrap_or_else(SVector::zeros);
        let first = move |index: usize| slope(index, 7, point(index), point(index + 1));
        (0..spans + 5).map(move |index| {
            let width = knot(index + 8) - knot(index + 2);
            let difference = first(index + 1) - first(index);
            difference * (T::from_f64(6.0) / (length * T::from_f64(width as f64)))
        })
    }

    /// z and ż.
    pub(crate) fn flat(&self, time: T) -> (SVector<T, NX>, SVector<T, NX>) {
        let (span, sigma) = self.window.place_at(time);
        let length = self.window.span_length();
        let curve = SpanCurve::new(self.basis, self.points, span, length);
        (curve.flat(sigma), curve.flat_rate(sigma, length))
    }

    /// u, u̇, ü at time `t`, seconds since the motion's start; zero before the plan and after it.
    pub fn virtual_acceleration(&self, t: T) -> [SVector<T, NX>; 3] {
        if !(t >= self.window.start() && t <= self.window.end()) {
            return [SVector::zeros(); 3];
        }
        let (span, sigma) = self.window.place_at(t);
        let length = self.window.span_length();
        SpanCurve::new(self.basis, self.points, span, length).acceleration(sigma)
    }

    /// The plan at time `t`, seconds since the motion's start. Before the plan and after it free shape
    /// coordinates are zero.
    pub fn at(&self, t: T) -> PlanPoint<T, NX, NS>
    where
        C: ShapeConstraint<T, NX, NS>,
    {
        let u = self.virtual_acceleration(t);
        let [a, b, c, ..] = self.constraint.shape(t);
        let mut shape = [a + self.gain * u[0], b + self.gain * u[1], c + self.gain * u[2]];
        if let Some(fade) = &self.fade
            && t >= self.window.start()
        {
            fade.add(t, &mut shape);
        }
        let [shape, shape_velocity, shape_acceleration] = shape;
        let desired = self.map.desired(self.motion.derivatives(t));
        PlanPoint {
            time: t,
            desired,
            net_acceleration: u,
            shape,
            shape_velocity,
            shape_acceleration,
        }
    }

    /// The motion of `robot` when it tracks the planned shape exactly, at the plan's samples or `refine`
    /// times as many: Γ integrated twice from the plan's start state.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for `refine` = 0.
    pub fn rows<'s, R>(
        &'s self,
        robot: &'s R,
        refine: usize,
    ) -> Result<
        impl ExactSizeIterator<Item = Row<T, NX, NS>> + use<'s, 'a, M, C, T, NX, NS, R>,
        Error,
    >
    where
        R: ShapeAccelerated<T, NX, NS> + ?Sized,
        C: ShapeConstraint<T, NX, NS>,
    {
        if refine == 0 {
            let expected = "at least 1";
            return Err(Error::Invalid {
                field: "refinement of the samples",
                value: 0.0,
                expected,
            });
        }
        let count = (self.window.count - 1).saturating_mul(refine).saturating_add(1);
        let step = self.window.length() / T::from_f64((count - 1) as f64);
        let sample = move |index: usize| {
            let whole = self.window.time(index / refine);
            let part = T::from_f64((index % refine) as f64) * step;
            let plan = self.at(whole + part);
            let acceleration =
                robot.gamma(&plan.shape, &plan.shape_velocity, &plan.shape_acceleration);
            Sample { plan, acceleration }
        };
        let Start { position, velocity, .. } = self.start;
        let trajectory = DoubleIntegral::new(count, step, velocity, position, sample);
        Ok(trajectory.map(|node| Row::new(robot, node)))
    }
}
