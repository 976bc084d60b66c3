//! Integration of sampled accelerations, twice, sample by sample.
//!
//! Through four neighbouring samples goes a cubic; over an interval its first and second integral are
//! exact. Inside, the interval is the middle one of the four; at both ends the stencil is one-sided.
//! Both integrals converge with the fourth power of the sampling interval, each acceleration is
//! evaluated once (a rule with midpoints would need two), and a window of four samples is all the
//! storage. Motions whose fourth derivative jumps between samples lose order there, not the sum.

use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// Fewest samples: one stencil.
pub const MIN_SAMPLES: usize = 4;

/// First integral of the cubic over interval `[k]` of its stencil, in units of h/24.
const ONCE: [[f64; 4]; 3] =
    [[9.0, 19.0, -5.0, 1.0], [-1.0, 13.0, 13.0, -1.0], [1.0, -5.0, 19.0, 9.0]];
/// Second integral ∫∫, in units of h²/360.
const TWICE: [[f64; 4]; 3] =
    [[97.0, 114.0, -39.0, 8.0], [-8.0, 129.0, 66.0, -7.0], [7.0, -36.0, 171.0, 38.0]];

/// What can be integrated: a vector, or a vector with its sensitivities.
pub(crate) trait Linear<T>: Copy {
    /// self + factor · other.
    fn plus(self, factor: T, other: &Self) -> Self;
}

impl<T: Ordered, const N: usize> Linear<T> for SVector<T, N> {
    fn plus(self, factor: T, other: &Self) -> Self {
        self + other * factor
    }
}

/// A sample that carries an acceleration.
pub(crate) trait Accelerated<T>: Copy {
    type Acceleration: Linear<T>;
    fn acceleration(&self) -> &Self::Acceleration;
}

/// A sample with the velocity and position that its and its predecessors' accelerations lead to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Integrated<S, V> {
    pub(crate) sample: S,
    pub(crate) velocity: V,
    pub(crate) position: V,
}

/// Iterator over the integrated samples; `source(i)` is called once for each i < `count`, in order.
pub(crate) struct DoubleIntegral<T, S: Accelerated<T>, F> {
    source: F,
    count: usize,
    step: T,
    /// Sample i of the window is at i modulo 4.
    window: [S; 4],
    /// Index of the window's first sample.
    first: usize,
    next: usize,
    velocity: S::Acceleration,
    position: S::Acceleration,
}

impl<T: Ordered, S: Accelerated<T>, F: FnMut(usize) -> S> DoubleIntegral<T, S, F> {
    /// `count` ≥ [`MIN_SAMPLES`] samples, `step` seconds apart, from an initial velocity and position.
    pub(crate) fn new(
        count: usize,
        step: T,
        velocity: S::Acceleration,
        position: S::Acceleration,
        mut source: F,
    ) -> Self {
        let window = [source(0), source(1), source(2), source(3)];
        Self { source, count, step, window, first: 0, next: 0, velocity, position }
    }

    /// Moves the state over interval `interval` of the window.
    fn advance(&mut self, interval: usize) {
        let once = self.step / T::from_f64(24.0);
        let twice = self.step * self.step / T::from_f64(360.0);
        let mut position = self.position.plus(self.step, &self.velocity);
        let mut velocity = self.velocity;
        for k in 0..4 {
            let acceleration = self.window[(self.first + k) % 4].acceleration();
            position = position.plus(twice * T::from_f64(TWICE[interval][k]), acceleration);
            velocity = velocity.plus(once * T::from_f64(ONCE[interval][k]), acceleration);
        }
        self.position = position;
        self.velocity = velocity;
    }
}

impl<T: Ordered, S: Accelerated<T>, F: FnMut(usize) -> S> DoubleIntegral<T, S, F> {
    /// The next sample with the velocity and position at it: [`Iterator::next`] without a copy.
    #[inline]
    pub(crate) fn next_node(&mut self) -> Option<(&S, &S::Acceleration, &S::Acceleration)> {
        let node = self.next;
        if node >= self.count {
            return None;
        }
        if node > 0 {
            // The interval from node − 1 to node, in the middle of the stencil where there is room.
            let stencil = node.saturating_sub(2).min(self.count.saturating_sub(MIN_SAMPLES));
            if stencil > self.first {
                self.first = stencil;
                self.window[(stencil + 3) % 4] = (self.source)(stencil + 3);
            }
            self.advance((node - 1 - self.first).min(2));
        }
        self.next += 1;
        Some((&self.window[node % 4], &self.velocity, &self.position))
    }
}

impl<T: Ordered, S: Accelerated<T>, F: FnMut(usize) -> S> Iterator for DoubleIntegral<T, S, F> {
    type Item = Integrated<S, S::Acceleration>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_node().map(|(&sample, &velocity, &position)| Integrated {
            sample,
            velocity,
            position,
        })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = self.count - self.next;
        (left, Some(left))
    }
}

impl<T: Ordered, S: Accelerated<T>, F: FnMut(usize) -> S> ExactSizeIterator
    for DoubleIntegral<T, S, F>
{
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector1;

    impl Accelerated<f64> for (f64, Vector1<f64>) {
        type Acceleration = Vector1<f64>;
        fn acceleration(&self) -> &Vector1<f64> {
            &self.1
        }
    }

    fn integrate(
        count: usize,
        duration: f64,
        start: [f64; 2],
        acceleration: impl Fn(f64) -> f64,
    ) -> impl ExactSizeIterator<Item = Integrated<(f64, Vector1<f64>), Vector1<f64>>> {
        let step = duration / (count - 1) as f64;
        DoubleIntegral::new(count, step, Vector1::new(start[1]), Vector1::new(start[0]), move |i| {
            let t = i as f64 * step;
            (t, Vector1::new(acceleration(t)))
        })
    }

    #[test]
    fn accelerations_up_to_cubic_are_integrated_exactly() {
        let position =
            |t: f64| 2.0 - t + t * t / 2.0 - t.powi(3) / 6.0 + t.powi(4) / 12.0 + t.powi(5) / 20.0;
        let velocity = |t: f64| -1.0 + t - t * t / 2.0 + t.powi(3) / 3.0 + t.powi(4) / 4.0;
        for count in [4, 5, 6, 33] {
            let rows = integrate(count, 1.5, [2.0, -1.0], |t| 1.0 - t + t * t + t.powi(3));
            assert_eq!(rows.len(), count);
            for row in rows {
                let t = row.sample.0;
                assert!((row.position[0] - position(t)).abs() < 1e-14, "{count} {t}");
                assert!((row.velocity[0] - velocity(t)).abs() < 1e-14, "{count} {t}");
            }
        }
    }

    #[test]
    fn velocity_and_position_converge_with_the_fourth_power_of_the_interval() {
        let errors = |count| {
            integrate(count, 4.0, [0.0, -1.0], f64::sin).fold([0.0_f64; 2], |worst, row| {
                let t = row.sample.0;
                [
                    worst[0].max((row.position[0] + t.sin()).abs()),
                    worst[1].max((row.velocity[0] + t.cos()).abs()),
                ]
            })
        };
        let (coarse, fine) = (errors(101), errors(201));
        for quantity in 0..2 {
            let order = (coarse[quantity] / fine[quantity]).log2();
            assert!((3.7..4.5).contains(&order), "order {order}");
            assert!(coarse[quantity] < 1e-6);
        }
    }
}
