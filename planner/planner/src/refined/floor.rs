//! The smallest error that any plan can have.

use super::plan::RefinedPlan;
use crate::linear_algebra::solve;
use crate::motion::DesiredMotion;
use nalgebra::{Matrix2, Vector2};
use shapebot_dynamics::Ordered;

/// The two solutions of τ²φ̈ = φ that are orthogonal to every residual of a free plan.
struct Homogeneous<T> {
    squared: T,
    /// √|τ²|, seconds.
    constant: T,
    start: T,
    end: T,
}

impl<T: Ordered> Homogeneous<T> {
    /// (φ, φ̇) of both.
    fn at(&self, time: T) -> [(T, T); 2] {
        let rate = T::one() / self.constant;
        if self.squared > T::zero() {
            let decay = ((self.start - time) * rate).exp();
            let growth = ((time - self.end) * rate).exp();
            [(decay, -decay * rate), (growth, growth * rate)]
        } else {
            let (sine, cosine) = ((time - self.start) * rate).sin_cos();
            [(cosine, -sine * rate), (sine, cosine * rate)]
        }
    }
}

impl<M, C, T, const NX: usize, const NS: usize> RefinedPlan<'_, M, C, T, NX, NS>
where
    M: DesiredMotion<T, NX> + ?Sized,
    T: Ordered,
{
    /// The root mean squared output error over the plan's window that no plan can be below which ends
    /// where this one does: of the linearised robot, with u free but for its ends, in metres. It is not
    /// zero because a robot cannot lean before its time.
    ///
    /// x = z − τ²z̈ with z and ż given at both ends: what is left of x^d lies in the span of the two
    /// solutions of τ²φ̈ = φ. `None` if τ² or the output's axes are coupled.
    pub fn floor(&self) -> Option<T> {
        let lags = super::gram::diagonal(&self.linear.output)?;
        let jacobian = self.linear.jacobian;
        let scales = super::gram::diagonal(&(jacobian.transpose() * jacobian))?;
        let mut sum = T::zero();
        for (axis, (&lag, &scale)) in lags.iter().zip(&scales).enumerate() {
            sum += self.axis_floor(axis, lag)? * scale;
        }
        Some((sum / self.window.length()).sqrt())
    }

    /// The integral of the squared residual of one axis, in the position coordinate's unit.
    fn axis_floor(&self, axis: usize, squared: T) -> Option<T> {
        let (start, end) = (self.window.start(), self.window.end());
        let constant = squared.abs().sqrt();
        if constant <= self.window.step() * T::epsilon().sqrt() {
            return Some(T::zero());
        }
        let functions = Homogeneous { squared, constant, start, end };
        let (flat, rate) = self.flat(start);
        // The plan's own end makes up for what Γ adds to the linearised robot's motion.
        let desired = |time| self.map.desired(self.motion.derivatives(time)).position;
        let limits = [desired(start), desired(end)];
        let edges = [
            (flat[axis], rate[axis], functions.at(start)),
            (limits[1][0][axis], limits[1][1][axis], functions.at(end)),
        ];
        // A constant may be taken off: that of the end at which the function is large.
        let shift = [edges[0].0, edges[1].0];
        let mut known = Vector2::zeros();
        let mut gram = Matrix2::zeros();
        for (edge, sign) in edges.iter().zip([-T::one(), T::one()]) {
            for j in 0..2 {
                let (value, rate) = edge.2[j];
                known[j] -= squared * sign * (edge.1 * value - (edge.0 - shift[j]) * rate);
            }
        }
        for index in 0..self.window.count {
            let time = self.window.time(index);
            let inner = index > 0 && index + 1 < self.window.count;
            let weight = self.window.step() * T::from_f64(if inner { 1.0 } else { 0.5 });
            let desired = desired(time)[0][axis];
            let values = functions.at(time).map(|(value, _)| value);
            for j in 0..2 {
                known[j] -= weight * values[j] * (desired - shift[j]);
                for k in 0..2 {
                    gram[(j, k)] += weight * values[j] * values[k];
                }
            }
        }
        // Euler and Maclaurin's correction of the trapezoidal rule.
        let correction = self.window.step() * self.window.step() / T::from_f64(12.0);
        for ((limit, edge), sign) in limits.iter().zip(&edges).zip([T::one(), -T::one()]) {
            let weight = sign * correction;
            for j in 0..2 {
                let (value, rate) = edge.2[j];
                let slope = limit[1][axis] * value + (limit[0][axis] - shift[j]) * rate;
                known[j] -= weight * slope;
                for k in 0..2 {
                    gram[(j, k)] += weight * (rate * edge.2[k].0 + value * edge.2[k].1);
                }
            }
        }
        let square = known.dot(&solve(gram, known)?);
        Some(if square > T::zero() { square } else { T::zero() })
    }
}
