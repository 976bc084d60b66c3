//! Counts and their rates.

use super::Settings;
use crate::State;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// Tracking filters of second order on the counts, both poles at −[`Settings::encoder_rate`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Encoders<T: Ordered, const N: usize> {
    start: SVector<T, N>,
    last: Option<[i32; N]>,
    /// Counts since the start: exact however far the robot goes.
    total: [i64; N],
    /// Filtered deviation from the counts, and rate.
    track: SVector<T, N>,
    rate: SVector<T, N>,
}

impl<T: Ordered, const N: usize> Encoders<T, N> {
    pub(crate) fn new(_: &Settings<T, N>, start: &SVector<T, N>) -> Self {
        let zero = SVector::from_element(T::zero());
        Self { start: *start, last: None, total: [0; N], track: zero, rate: zero }
    }

    pub(crate) fn step(
        &mut self,
        settings: &Settings<T, N>,
        counts: &[i32; N],
        expected: &SVector<T, N>,
    ) -> State<T, N> {
        let last = self.last.unwrap_or(*counts);
        self.last = Some(*counts);
        let Settings { period, encoder_rate, resolution, .. } = settings;
        // Both poles of the sampled filter at e^(−ω T).
        let pole = (-(*encoder_rate) * *period).exp();
        let correction = T::one() - pole * pole;
        let gain = (T::one() - pole) * (T::one() - pole) / *period;
        let mut q = self.start;
        for i in 0..N {
            let (now, before) = (counts[i], last[i]);
            let moved = now.wrapping_sub(before);
            self.total[i] += i64::from(moved);
            q[i] += T::from_f64(self.total[i] as f64) * resolution[i];
            let half = T::from_f64(0.5) * *period * expected[i];
            // The filter follows the counts; what it keeps is how far it is behind.
            let ahead = self.track[i] + (self.rate[i] + half) * *period
                - T::from_f64(f64::from(moved)) * resolution[i];
            self.rate[i] += expected[i] * *period - ahead * gain;
            self.track[i] = ahead * (T::one() - correction);
        }
        State { q, qd: self.rate }
    }
}
