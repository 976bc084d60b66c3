//! Desired motions from samples: a smoothing spline with a stated fit.

use super::basis::{Basis, DEGREE};
use super::problem::{Linearised, Moments, larger, root_mean};
use super::window::Window;
use super::workspace::{SpanCurve, Workspace};
use crate::Error;
use crate::linear_algebra::is_finite;
use crate::motion::{Derivatives, DesiredMotion, check_duration};
use crate::reference::Grid;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::Ordered;

/// Control points that rest takes at an end: the position and four derivatives.
const REST: usize = 5;

/// A motion through recorded or computed samples: the clamped spline of degree seven, from rest to
/// rest at the first and last sample, that is closest to them. It is of class C⁴, with the rest around
/// it too.
#[derive(Clone, Copy, Debug)]
pub struct Sampled<'a, T: Ordered, const NX: usize> {
    basis: &'a Basis<T>,
    points: &'a [SVector<T, NX>],
    window: Window<T>,
    rmse: T,
    max_error: T,
}

impl<'a, T: Ordered, const NX: usize> Sampled<'a, T, NX> {
    /// Fits `samples` at equal distances in time over `duration` seconds with a spline of `spans` spans
    /// (from 4; fewer are smoother). The control points stay in the workspace.
    ///
    /// # Errors
    ///
    /// Fewer than [`MIN_REFINED_SAMPLES`](super::MIN_REFINED_SAMPLES) samples, one that is not finite,
    /// more spans than half the samples or than the workspace has room for, a duration that is not
    /// positive and finite.
    pub fn fit<const POINTS: usize>(
        samples: &[SVector<T, NX>],
        duration: T,
        spans: usize,
        workspace: &'a mut Workspace<T, NX, POINTS>,
    ) -> Result<Self, Error> {
        check_duration(duration)?;
        if let Some(index) = samples.iter().position(|sample| !is_finite(sample)) {
            let expected = "finite in every coordinate";
            return Err(Error::InvalidEntry { field: "samples", index, value: f64::NAN, expected });
        }
        let grid = Grid::of(samples.len(), duration)?;
        let window = Window::new(grid, [T::zero(); 2], Some(spans), POINTS)?;
        let count = spans + DEGREE;
        let identity = Linearised {
            position: SMatrix::zeros(),
            output: SMatrix::zeros(),
            jacobian: SMatrix::identity(),
        };
        workspace.basis.prepare(spans);
        let singular = Error::Singular { matrix: "fit of the spline" };
        workspace
            .normal
            .prepare_samples(&workspace.basis, &window, (REST, count - REST))
            .ok_or(singular)?;
        place(samples, count, workspace);
        // Once for the fit, once for what rounding left of it.
        for _ in 0..2 {
            correct(samples, &window, &identity, workspace);
        }
        let workspace: &'a Workspace<T, NX, POINTS> = workspace;
        let (basis, points) = (&workspace.basis, &workspace.points[..count]);
        let mut sampled = Self { basis, points, window, rmse: T::zero(), max_error: T::zero() };
        let (squares, max_error) = sampled.errors(samples);
        sampled.rmse = root_mean(squares, samples.len());
        sampled.max_error = max_error;
        Ok(sampled)
    }

    /// Sum of the squared distances from the samples, and the largest distance.
    fn errors(&self, samples: &[SVector<T, NX>]) -> (T, T) {
        let (mut squares, mut most) = (T::zero(), T::zero());
        for (index, sample) in samples.iter().enumerate() {
            let error = self.position(self.window.time(index)) - sample;
            squares += error.dot(&error);
            most = larger(most, &error);
        }
        (squares, most)
    }

    /// Root of the mean squared distance of the curve from the samples, in their unit.
    pub fn rmse(&self) -> T {
        self.rmse
    }

    /// The largest distance of the curve from a sample, in their unit.
    pub fn max_error(&self) -> T {
        self.max_error
    }

    fn curve(&self, t: T) -> (SpanCurve<T, NX>, T) {
        let (span, sigma) = self.window.place_at(t);
        (SpanCurve::new(self.basis, self.points, span, self.window.span_length()), sigma)
    }
}

/// Rest at the first and last sample, the other control points on the line between.
fn place<T: Ordered, const NX: usize, const POINTS: usize>(
    samples: &[SVector<T, NX>],
    count: usize,
    workspace: &mut Workspace<T, NX, POINTS>,
) {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return;
    };
    let way = T::from_f64((count - 2 * REST + 1) as f64);
    for (index, point) in workspace.points.iter_mut().enumerate().take(count) {
        let inner = (index + 1).saturating_sub(REST).min(count - 2 * REST + 1);
        *point = first + (last - first) * (T::from_f64(inner as f64) / way);
    }
}

/// One step of least squares.
fn correct<T: Ordered, const NX: usize, const POINTS: usize>(
    samples: &[SVector<T, NX>],
    window: &Window<T>,
    identity: &Linearised<T, NX>,
    workspace: &mut Workspace<T, NX, POINTS>,
) {
    let Workspace { basis, points, gradient, normal, .. } = workspace;
    *gradient = [SVector::zeros(); POINTS];
    let length = window.span_length();
    let mut moments = Moments::new(0);
    let mut curve = SpanCurve::new(basis, points, 0, length);
    for (sample, (span, sigma)) in samples.iter().zip(window.places()) {
        if span != moments.span {
            moments.flush(basis.span(moments.span), identity, length, gradient);
            moments = Moments::new(span);
            curve = SpanCurve::new(basis, points, span, length);
        }
        moments.add(sigma, &(sample - curve.flat(sigma)));
    }
    moments.flush(basis.span(moments.span), identity, length, gradient);
    normal.solve_free(gradient);
    for index in normal.free() {
        points[index] += gradient[index];
    }
}

impl<T: Ordered, const NX: usize> DesiredMotion<T, NX> for Sampled<'_, T, NX> {
    fn duration(&self) -> T {
        self.window.length()
    }

    fn derivatives(&self, t: T) -> Derivatives<T, NX> {
        let (curve, sigma) = self.curve(t);
        let mut derivatives = [SVector::zeros(); 5];
        derivatives[0] = curve.flat(sigma);
        if t >= T::zero() && t <= self.window.length() {
            derivatives[1] = curve.flat_rate(sigma, self.window.span_length());
            derivatives[2..].copy_from_slice(&curve.acceleration(sigma));
        }
        derivatives
    }

    fn position(&self, t: T) -> SVector<T, NX> {
        let (curve, sigma) = self.curve(t);
        curve.flat(sigma)
    }
}
