//! Polynomials in time.

use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// From a value with its rate and acceleration to rest elsewhere, in a polynomial of fifth degree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToRest<T: Ordered, const L: usize> {
    start: [SVector<T, L>; 3],
    goal: SVector<T, L>,
    duration: T,
}

impl<T: Ordered, const L: usize> ToRest<T, L> {
    /// In `duration` seconds.
    pub(crate) fn new(start: [SVector<T, L>; 3], goal: SVector<T, L>, duration: T) -> Self {
        Self { start, goal, duration }
    }

    /// At rest for ever.
    pub(crate) fn still(goal: SVector<T, L>) -> Self {
        let zero = SVector::from_element(T::zero());
        Self { start: [goal, zero, zero], goal, duration: T::zero() }
    }

    pub(crate) fn goal(&self) -> &SVector<T, L> {
        &self.goal
    }

    pub(crate) fn is_over(&self, time: T) -> bool {
        time >= self.duration
    }

    /// Value, rate and acceleration `time` seconds after the start.
    pub(crate) fn at(&self, time: T) -> [SVector<T, L>; 3] {
        let zero = SVector::from_element(T::zero());
        if self.is_over(time) {
            return [self.goal, zero, zero];
        }
        let c = T::from_f64;
        let (h, s) = (self.duration, time / self.duration);
        let [value, rate, second] = self.start;
        let (c1, c2) = (rate * h, second * (c(0.5) * h * h));
        let gap = self.goal - value - c1 - c2;
        let slope = -(c1 + c2 * c(2.0));
        let bend = -(c2 * c(2.0));
        let c3 = gap * c(10.0) - slope * c(4.0) + bend * c(0.5);
        let c4 = gap * c(-15.0) + slope * c(7.0) - bend;
        let c5 = gap * c(6.0) - slope * c(3.0) + bend * c(0.5);
        let first =
            c1 + (c2 * c(2.0) + (c3 * c(3.0) + (c4 * c(4.0) + c5 * (c(5.0) * s)) * s) * s) * s;
        let curved = c2 * c(2.0) + (c3 * c(6.0) + (c4 * c(12.0) + c5 * (c(20.0) * s)) * s) * s;
        [value + (c1 + (c2 + (c3 + (c4 + c5 * s) * s) * s) * s) * s, first / h, curved / (h * h)]
    }
}

#[cfg(test)]
mod tests {
    use super::ToRest;
    use nalgebra::Vector1;

    #[test]
    fn both_ends_are_met_and_rates_are_derivatives() {
        let start = [1.0_f64, 2.0, -3.0].map(Vector1::new);
        let motion = ToRest::new(start, Vector1::new(4.0), 1.5);
        assert_eq!(motion.at(0.0), start);
        let [end, rate, second] = motion.at(1.5 - 1e-9);
        assert!((end[0] - 4.0).abs() < 1e-8 && rate[0].abs() < 1e-7 && second[0].abs() < 1e-6);
        assert_eq!(motion.at(2.0), [4.0, 0.0, 0.0].map(Vector1::new));
        for time in [0.2, 0.7, 1.3] {
            let h = 1e-5;
            let [before, here, after] = [time - h, time, time + h].map(|t| motion.at(t));
            let rate: f64 = (after[0][0] - before[0][0]) / (2.0 * h);
            let second = (after[1][0] - before[1][0]) / (2.0 * h);
            assert!((rate - here[1][0]).abs() < 1e-7, "{rate} {}", here[1][0]);
            assert!((second - here[2][0]).abs() < 1e-6, "{second} {}", here[2][0]);
        }
    }
}
