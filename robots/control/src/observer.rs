//! Observers of what the model does not know.

use crate::clamp::clamp_all;
use crate::signal::Finite;
use nalgebra::{SMatrix, SVector};
use shapebot_dynamics::Ordered;

/// Observer of disturbing forces on the position variables: where these are actuated, cyclic and free of
/// gravity, ṗ_x = τ_x + d exactly, so that no acceleration is needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MomentumObserver<T: Ordered, const NX: usize> {
    /// Integral of τ_x + d̂: what the momentum would be.
    momentum: SVector<T, NX>,
    /// d̂.
    pub(crate) disturbance: SVector<T, NX>,
}

impl<T: Ordered, const NX: usize> MomentumObserver<T, NX> {
    pub(crate) fn new(momentum: SVector<T, NX>) -> Self {
        Self { momentum, disturbance: SVector::from_element(T::zero()) }
    }

    /// One period later, in which `force` acted.
    pub(crate) fn advance(
        &mut self,
        measured: &SVector<T, NX>,
        force: &SVector<T, NX>,
        step: [T; 2],
    ) {
        let [period, rate] = step;
        self.momentum += (force + self.disturbance) * period;
        self.disturbance = (measured - self.momentum) * rate;
    }

    pub(crate) fn added_to(&self, sum: Finite<T>) -> Finite<T> {
        sum.and(&self.momentum).and(&self.disturbance)
    }
}

/// Observer of a constant offset of the measured shape, as the acceleration b of q_x that it feigns.
///
/// With N = ∂Γ/∂q̈_s and z = q̇_x − N q̇_s, ż = Γ(q_s, q̇_s, q̈_s^p) − N q̈_s^p + b to first order in the
/// deviation from the plan; no acceleration is measured, and no force of an actuator enters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OffsetObserver<T: Ordered, const NX: usize> {
    estimate: SVector<T, NX>,
    slope: SVector<T, NX>,
    /// Gain of the estimate of z.
    gain: T,
    /// b̂.
    pub(crate) offset: SVector<T, NX>,
}

impl<T: Ordered, const NX: usize> OffsetObserver<T, NX> {
    pub(crate) fn new(z: SVector<T, NX>, slope: SVector<T, NX>) -> Self {
        Self { estimate: z, slope, gain: T::one(), offset: SVector::from_element(T::zero()) }
    }

    /// One period later: `slope` is the model's ż now. Both poles of the error are at −`rate`, once the
    /// first readings are averaged: one noisy reading would take b̂ along for 1/`rate`.
    pub(crate) fn advance(&mut self, z: &SVector<T, NX>, slope: &SVector<T, NX>, step: [T; 2]) {
        let [period, rate] = step;
        let half = T::from_f64(0.5) * period;
        self.estimate += (self.slope + slope) * half + self.offset * period;
        self.slope = *slope;
        let innovation = z - self.estimate;
        let gain = rate * period;
        let (average, least) = (self.gain / (T::one() + self.gain), gain + gain);
        self.gain = if average > least { average } else { least };
        self.estimate += innovation * self.gain;
        self.offset += innovation * (gain * rate);
    }

    /// Keeps b̂ where it can be made up for.
    pub(crate) fn limit(&mut self, limit: &SVector<T, NX>) {
        self.offset = clamp_all(&self.offset, limit);
    }

    pub(crate) fn added_to(&self, sum: Finite<T>) -> Finite<T> {
        // The gain is between limits of its own.
        sum.and(&self.estimate).and(&self.slope).and(&self.offset)
    }
}

/// z = q̇_x − N q̇_s.
pub(crate) fn flat_rate<T: Ordered, const NX: usize, const NS: usize>(
    response: &SMatrix<T, NX, NS>,
    qxd: &SVector<T, NX>,
    qsd: &SVector<T, NS>,
) -> SVector<T, NX> {
    qxd - response * qsd
}
