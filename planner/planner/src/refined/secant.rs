//! Steps of a fixed Jacobian, with what two of them tell about the slope between.

use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// The step before: as it was asked for, and as it was made.
pub(super) struct Secant<T: Ordered, const NX: usize, const POINTS: usize> {
    last: Option<[[SVector<T, NX>; POINTS]; 2]>,
}

impl<T: Ordered, const NX: usize, const POINTS: usize> Secant<T, NX, POINTS> {
    pub(super) fn new() -> Self {
        Self { last: None }
    }

    /// Corrects a step d: where the one before, made as p, has changed what is asked for by Δ, the
    /// combination d − γ(p + Δ) leaves least of it to first order (Anderson's mixing of depth one).
    /// Plans with a large lean leave a third of an error in every sweep without it.
    pub(super) fn correct(&mut self, count: usize, steps: &mut [SVector<T, NX>; POINTS]) {
        let asked = *steps;
        if let Some([before, made]) = &self.last {
            let (mut along, mut square) = (T::zero(), T::zero());
            for (now, before) in asked.iter().zip(before).take(count) {
                let change = now - before;
                along += now.dot(&change);
                square += change.dot(&change);
            }
            let factor = along / square;
            // Beyond one the steps do not shrink, and their slope says little.
            if factor.abs() < T::one() {
                for (k, step) in steps.iter_mut().enumerate().take(count) {
                    *step -= (made[k] + asked[k] - before[k]) * factor;
                }
            }
        }
        self.last = Some([asked, *steps]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector1;

    /// x = cos x by x += cos x − x: a contraction by two thirds.
    #[test]
    fn a_slow_contraction_becomes_a_secant_method() {
        let (mut x, mut secant) = (0.3_f64, Secant::<f64, 1, 1>::new());
        for _ in 0..7 {
            let mut steps = [Vector1::new(x.cos() - x)];
            secant.correct(1, &mut steps);
            x += steps[0][0];
        }
        assert!((x - x.cos()).abs() < 1e-12, "{x}");
    }
}
