//! Rates of the position variables of a balancing robot.

use super::Settings;
use nalgebra::SVector;
use shapebot_dynamics::Ordered;

/// Tracking filter of second order on y = q_x − N q_s, N = ∂Γ/∂q̈_s.
///
/// A filter on the counts alone lags behind by some milliseconds, which a fast loop does not bear: what
/// balances a robot shakes position and shape against each other. y feels none of it, and the model
/// knows ÿ = Γ(q_s, q̇_s, q̈_s) − N q̈_s without the drives' forces, so that a slow filter does not lag;
/// q̇_x = ẏ + N q̇_s takes the fast part from the gyro.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatFilter<T: Ordered, const NX: usize> {
    /// Both poles, 1/s.
    bandwidth: T,
    /// y and ẏ.
    estimate: Option<[SVector<T, NX>; 2]>,
}

impl<T: Ordered, const NX: usize> FlatFilter<T, NX> {
    /// `squared` is τ², s².
    pub(crate) fn new<const N: usize>(settings: &Settings<T, N>, squared: T) -> Self {
        let (wanted, most) = (settings.position_rate / squared.sqrt(), settings.encoder_rate);
        // Infinite where the model has no such time.
        let bandwidth = if wanted < most { wanted } else { most };
        Self { bandwidth, estimate: None }
    }

    /// ẏ from y as measured and ÿ as expected over the period that ended now.
    pub(crate) fn step(
        &mut self,
        measured: &SVector<T, NX>,
        acceleration: &SVector<T, NX>,
        period: T,
    ) -> SVector<T, NX> {
        let zero = SVector::from_element(T::zero());
        let Some([y, yd]) = self.estimate else {
            self.estimate = Some([*measured, zero]);
            return zero;
        };
        // Both poles of the sampled filter at e^(−ω T).
        let pole = (-self.bandwidth * period).exp();
        let correction = T::one() - pole * pole;
        let gain = (T::one() - pole) * (T::one() - pole) / period;
        let half = T::from_f64(0.5) * period;
        let ahead = y + (yd + acceleration * half) * period;
        let residual = measured - ahead;
        let yd = yd + acceleration * period + residual * gain;
        self.estimate = Some([ahead + residual * correction, yd]);
        yd
    }
}
