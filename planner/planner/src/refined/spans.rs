//! The early sweeps: five sampling intervals in every span, however many samples the plan has.
//!
//! Inside a span curve and acceleration are smooth: a quintic goes through the span's six samples, and
//! the jumps of higher derivatives between spans do no harm.

use super::limits::Bounds;
use super::problem::{Moments, Problem, Sums};
use super::workspace::{SpanCurve, Workspace};
use crate::Error;
use crate::constraint::ShapeConstraint;
use crate::linear_algebra::is_finite;
use crate::motion::DesiredMotion;
use nalgebra::SVector;
use shapebot_dynamics::{Ordered, ShapeAccelerated};

/// Sampling intervals in a span.
pub(super) const INTERVALS: usize = 5;

/// First integral of the quintic over interval `[k]` of a span, in units of h/1440.
const ONCE: [[f64; INTERVALS + 1]; INTERVALS] = [
    [475.0, 1427.0, -798.0, 482.0, -173.0, 27.0],
    [-27.0, 637.0, 1022.0, -258.0, 77.0, -11.0],
    [11.0, -93.0, 802.0, 802.0, -93.0, 11.0],
    [-11.0, 77.0, -258.0, 1022.0, 637.0, -27.0],
    [27.0, -173.0, 482.0, -798.0, 1427.0, 475.0],
];
/// Second integral ∫∫, in units of h²/10080.
const TWICE: [[f64; INTERVALS + 1]; INTERVALS] = [
    [2462.0, 4315.0, -3044.0, 1882.0, -682.0, 107.0],
    [-107.0, 3104.0, 2710.0, -904.0, 277.0, -40.0],
    [40.0, -347.0, 3704.0, 1910.0, -304.0, 37.0],
    [-37.0, 262.0, -902.0, 4444.0, 1355.0, -82.0],
    [82.0, -529.0, 1492.0, -2542.0, 5674.0, 863.0],
];

/// Velocity and position that the defects so far have led to.
struct State<T: Ordered, const NX: usize> {
    velocity: SVector<T, NX>,
    position: SVector<T, NX>,
}

impl<T: Ordered, const NX: usize> State<T, NX> {
    /// Over interval `interval` of a span whose samples are `step` seconds apart.
    fn advance(&mut self, step: T, interval: usize, defects: [&SVector<T, NX>; INTERVALS + 1]) {
        let (once, twice) = (step / T::from_f64(1440.0), step * step / T::from_f64(10080.0));
        self.position += self.velocity * step;
        for (k, defect) in defects.into_iter().enumerate() {
            self.position += defect * (twice * T::from_f64(TWICE[interval][k]));
            self.velocity += defect * (once * T::from_f64(ONCE[interval][k]));
        }
    }
}

/// Where the samples of a span lie, but for the last: that is the first of the next.
pub(super) fn sigmas<T: Ordered>() -> [T; INTERVALS] {
    core::array::from_fn(|k| T::from_f64(k as f64) / T::from_f64(INTERVALS as f64))
}

impl<R, M, C, T, const NX: usize, const NS: usize> Problem<'_, R, M, C, T, NX, NS>
where
    R: ShapeAccelerated<T, NX, NS> + ?Sized,
    M: DesiredMotion<T, NX> + ?Sized,
    C: ShapeConstraint<T, NX, NS>,
    T: Ordered,
{
    /// The fit of a linear robot, from a curve that stays where it begins: only the desired motion is
    /// sampled.
    pub(super) fn fit_linear<const POINTS: usize>(
        &self,
        count: usize,
        bounds: &Bounds<'_, T, NX, NS>,
        workspace: &mut Workspace<T, NX, POINTS>,
    ) -> Result<(), Error> {
        let Workspace { basis, points, steps, normal, .. } = workspace;
        let (length, weight) = (self.window.span_length(), sample_weight::<T>());
        let (resting, zero) = (points[0], SVector::zeros());
        let mut right = [zero; POINTS];
        for span in 0..self.window.spans {
            let mut moments = Moments::new(span);
            for sigma in sigmas() {
                let time = self.window.time_in(span, sigma);
                let [shape, ..] = self.shape(time, &[zero; 3]);
                let error = self.robot.output(&resting, &shape) - self.motion.position(time);
                if !is_finite(&error) {
                    return Err(bounds.explain(self, time, &shape));
                }
                moments.add(sigma, &(self.unwanted(time, &error) * -weight));
            }
            moments.flush(basis.span(span), &self.linear, length, &mut right);
        }
        for (step, point) in steps.iter_mut().zip(points.iter()) {
            *step = point - resting;
        }
        normal.solve(count, steps, &mut right);
        for index in normal.free() {
            points[index] = resting + right[index];
        }
        Ok(())
    }

    /// A sweep of Γ over the samples of all spans; Jᵀr as the workspace's gradient.
    pub(super) fn sweep_spans<const POINTS: usize>(
        &self,
        bounds: &Bounds<'_, T, NX, NS>,
        workspace: &mut Workspace<T, NX, POINTS>,
    ) -> Result<Sums<T, NX>, Error> {
        let Workspace { basis, points, gradient, .. } = workspace;
        *gradient = [SVector::zeros(); POINTS];
        let (length, weight) = (self.window.span_length(), sample_weight::<T>());
        let step = length * weight;
        let mut curve = SpanCurve::new(basis, points, 0, length);
        let (velocity, position) = self.begin(&curve);
        let mut state = State { velocity, position };
        let mut sums = Sums::new();
        let mut first = self.node(self.window.start(), (0, T::zero()), &curve);
        for span in 0..self.window.spans {
            if span > 0 {
                curve = SpanCurve::new(basis, points, span, length);
            }
            let node = |k: usize| {
                let sigma = T::from_f64(k as f64) * weight;
                self.node(self.window.time_in(span, sigma), (span, sigma), &curve)
            };
            let nodes = [first, node(1), node(2), node(3), node(4), node(5)];
            let mut moments = Moments::new(span);
            for (interval, (node, sigma)) in nodes.iter().zip(sigmas()).enumerate() {
                let error = self.output_error(node, &state.position);
                if !is_finite(&error) {
                    return Err(bounds.explain(self, node.time, &node.shape));
                }
                moments.add(sigma, &(self.unwanted(node.time, &error) * weight));
                sums.squares += error.dot(&error) * weight;
                let defects = nodes.each_ref().map(|node| node.defect());
                state.advance(step, interval, defects);
            }
            moments.flush(basis.span(span), &self.linear, length, gradient);
            first = nodes[INTERVALS];
        }
        self.finish(&curve, &state.position, &state.velocity, &mut sums);
        sums.check(self)
    }
}

/// Of a sample, so that those of a span sum up to one.
fn sample_weight<T: Ordered>() -> T {
    T::one() / T::from_f64(INTERVALS as f64)
}
