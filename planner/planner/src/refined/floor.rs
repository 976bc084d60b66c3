//! The smallest error that any plan can have.

use super::plan::RefinedPlan;
use crate::linear_algebra::{inverse, norm};
use crate::motion::DesiredMotion;
use nalgebra::{Matrix2, SMatrix, SVector, Vector2};
use shapebot_dynamics::Ordered;

/// The two solutions of λφ̈ = φ along an eigenvector of (τ²)ᵀ: orthogonal to every residual of a free plan.
#[derive(Clone, Copy)]
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

/// An eigenvector of (τ²)ᵀ with what its two solutions meet.
#[derive(Clone, Copy)]
struct Axis<T: Ordered, const NX: usize> {
    direction: SVector<T, NX>,
    functions: Homogeneous<T>,
    /// The flat output at both ends, along the direction. It may be taken off: from each function that
    /// of the end at which the function is large.
    shift: [T; 2],
}

/// Projections of what a plan has to follow on all solutions, and these solutions' products.
struct Projections<T: Ordered, const NX: usize> {
    known: [Vector2<T>; NX],
    gram: [[Matrix2<T>; NX]; NX],
}

impl<T: Ordered, const NX: usize> Projections<T, NX> {
    /// The squared length of the projection, by elimination of the blocks.
    fn square(mut self) -> Option<T> {
        let mut sum = T::zero();
        for c in 0..NX {
            let inverse = inverse(self.gram[c][c])?;
            let (row, known) = (self.gram[c], self.known[c]);
            for r in c + 1..NX {
                let factor = self.gram[r][c] * inverse;
                self.known[r] -= factor * known;
                for (entry, above) in self.gram[r].iter_mut().zip(&row).skip(c) {
                    *entry -= factor * above;
                }
            }
            sum += known.dot(&(inverse * known));
        }
        Some(if sum > T::zero() { sum } else { T::zero() })
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
    /// x = z − τ²z̈ with z and ż given at both ends, and the error is J(x − x^d): what is left of x^d lies
    /// in (JᵀJ)⁻¹ times the span of the solutions of (τ²)ᵀφ̈ = φ. `None` if (τ²)ᵀ has no real
    /// eigenvectors, or couples more than two axes.
    pub fn floor(&self) -> Option<T> {
        let eigenvectors = eigenvectors(&self.linear.output)?;
        // vᵀ(JᵀJ)⁻¹w is the product of J⁻ᵀv and J⁻ᵀw.
        let metric = inverse(self.linear.jacobian)?.transpose();
        let axes = eigenvectors.map(|(value, direction)| self.axis(value, direction));
        let mut sums =
            Projections { known: [Vector2::zeros(); NX], gram: [[Matrix2::zeros(); NX]; NX] };
        self.add_ends(&axes, &mut sums);
        for index in 0..self.window.count {
            let inner = index > 0 && index + 1 < self.window.count;
            let weight = self.window.step() * T::from_f64(if inner { 1.0 } else { 0.5 });
            self.add_sample(&axes, self.window.time(index), weight, &mut sums);
        }
        for i in 0..NX {
            for k in 0..NX {
                let product = (metric * axes[i].direction).dot(&(metric * axes[k].direction));
                sums.gram[i][k] *= product;
            }
            if self.is_immediate(&axes[i]) {
                // Nothing is left of what can be followed at once.
                sums.known[i] = Vector2::zeros();
                for k in 0..NX {
                    (sums.gram[i][k], sums.gram[k][i]) = (Matrix2::zeros(), Matrix2::zeros());
                }
                sums.gram[i][i] = Matrix2::identity();
            }
        }
        Some((sums.square()? / self.window.length()).sqrt())
    }

    fn axis(&self, squared: T, direction: SVector<T, NX>) -> Axis<T, NX> {
        let (start, end) = (self.window.start(), self.window.end());
        let constant = squared.abs().sqrt();
        let functions = Homogeneous { squared, constant, start, end };
        let desired = self.map.desired(self.motion.derivatives(end)).position[0];
        let shift = [direction.dot(&self.flat(start).0), direction.dot(&desired)];
        Axis { direction, functions, shift }
    }

    /// Whether u acts at once along an axis: τ² is zero, as far as samples can tell.
    fn is_immediate(&self, axis: &Axis<T, NX>) -> bool {
        axis.functions.constant <= self.window.step() * T::epsilon().sqrt()
    }

    fn add_sample(
        &self,
        axes: &[Axis<T, NX>; NX],
        time: T,
        weight: T,
        sums: &mut Projections<T, NX>,
    ) {
        let desired = self.map.desired(self.motion.derivatives(time)).position[0];
        let values = axes.map(|axis| {
            if self.is_immediate(&axis) {
                return [T::zero(); 2];
            }
            axis.functions.at(time).map(|(value, _)| value)
        });
        for (i, axis) in axes.iter().enumerate() {
            let along = axis.direction.dot(&desired);
            for a in 0..2 {
                sums.known[i][a] -= weight * values[i][a] * (along - axis.shift[a]);
                for k in 0..NX {
                    for b in 0..2 {
                        sums.gram[i][k][(a, b)] += weight * values[i][a] * values[k][b];
                    }
                }
            }
        }
    }

    /// What the given ends contribute, and Euler and Maclaurin's correction of the trapezoidal rule.
    fn add_ends(&self, axes: &[Axis<T, NX>; NX], sums: &mut Projections<T, NX>) {
        let (start, end) = (self.window.start(), self.window.end());
        let desired = |time| self.map.desired(self.motion.derivatives(time)).position;
        let correction = self.window.step() * self.window.step() / T::from_f64(12.0);
        let (flat, flat_rate) = self.flat(start);
        let limits = [desired(start), desired(end)];
        // The plan's own end makes up for what Γ adds to the linearised robot's motion.
        let ends = [(start, flat, flat_rate), (end, limits[1][0], limits[1][1])];
        for ((limit, (time, flat, rate)), sign) in
            limits.iter().zip(ends).zip([-T::one(), T::one()])
        {
            let functions = axes.map(|axis| {
                if self.is_immediate(&axis) {
                    return [(T::zero(), T::zero()); 2];
                }
                axis.functions.at(time)
            });
            for (i, axis) in axes.iter().enumerate() {
                let along = |vector: &SVector<T, NX>| axis.direction.dot(vector);
                for (a, &(value, slope)) in functions[i].iter().enumerate() {
                    let shift = axis.shift[a];
                    let end = along(&rate) * value - (along(&flat) - shift) * slope;
                    sums.known[i][a] -= axis.functions.squared * sign * end;
                    let change = along(&limit[1]) * value + (along(&limit[0]) - shift) * slope;
                    sums.known[i][a] += sign * correction * change;
                    for (k, others) in functions.iter().enumerate() {
                        for (b, other) in others.iter().enumerate() {
                            let change = slope * other.0 + value * other.1;
                            sums.gram[i][k][(a, b)] -= sign * correction * change;
                        }
                    }
                }
            }
        }
    }
}

/// Eigenvalues and unit eigenvectors of the transpose of τ²; `None` if they are not real, not
/// independent, or those of a coupled matrix beyond 2 × 2.
fn eigenvectors<T: Ordered, const NX: usize>(
    squared: &SMatrix<T, NX, NX>,
) -> Option<[(T, SVector<T, NX>); NX]> {
    if let Some(diagonal) = super::gram::diagonal(squared) {
        let unit = |i| SVector::from_fn(|k, _| if k == i { T::one() } else { T::zero() });
        return Some(core::array::from_fn(|i| (diagonal[i], unit(i))));
    }
    if NX != 2 {
        return None;
    }
    let entry = |i: usize, j: usize| squared[(j, i)];
    let half = T::from_f64(0.5);
    let mean = (entry(0, 0) + entry(1, 1)) * half;
    let difference = (entry(0, 0) - entry(1, 1)) * half;
    let radicand = difference * difference + entry(0, 1) * entry(1, 0);
    let size = crate::linear_algebra::largest(squared.iter().copied());
    if radicand <= size * size * T::epsilon().sqrt() {
        return None;
    }
    let root = radicand.sqrt();
    let vector = |value: T| {
        let two = [[entry(0, 1), value - entry(0, 0)], [value - entry(1, 1), entry(1, 0)]];
        let [a, b] = two.map(|pair| SVector::from_fn(|i, _| pair[i]));
        let longer = if norm(&a) > norm(&b) { a } else { b };
        (value, longer / norm(&longer))
    };
    let values = [mean + root, mean - root];
    Some(core::array::from_fn(|i| vector(values[i])))
}
