//! Rates of position variables from counts.

use crate::reference::Moment;
use crate::simulate::Tracker;
use nalgebra::{SMatrix, SVector};
use shapebot_control::{Command, State};
use shapebot_dynamics::ShapeAccelerated;

/// Gives a tracker smooth rates of the position variables where sensors only count.
///
/// What drives a balancing robot shakes its position and its shape against each other. With
/// N = ∂Γ/∂q̈_s, y = q_x − N q_s feels none of it: ÿ = Γ(q_s, q̇_s, q̈_s) − N q̈_s hardly depends on q̈_s,
/// and that of the plan will do. A tracking filter on y that expects this acceleration may be slow
/// without lagging behind, and q̇_x = ẏ + N q̇_s takes the fast part from the gyro.
pub struct RateFilter<'a, T, const NX: usize, const NS: usize> {
    tracker: T,
    model: &'a dyn ShapeAccelerated<f64, NX, NS>,
    response: SMatrix<f64, NX, NS>,
    period: f64,
    /// α and β/T of the filter.
    gains: [f64; 2],
    /// y and ẏ.
    estimate: Option<[SVector<f64, NX>; 2]>,
}

impl<'a, T, const NX: usize, const NS: usize> RateFilter<'a, T, NX, NS> {
    /// With both poles at `bandwidth`, rad/s, for a tracker that works every `period` seconds on a
    /// robot like `model`.
    pub fn new(
        model: &'a dyn ShapeAccelerated<f64, NX, NS>,
        tracker: T,
        period: f64,
        bandwidth: f64,
    ) -> Self {
        let zero = SVector::zeros();
        let pole = (-bandwidth * period).exp();
        Self {
            tracker,
            model,
            response: model.response(&zero, &zero, &zero).d_qsdd,
            period,
            gains: [1.0 - pole * pole, (1.0 - pole) * (1.0 - pole) / period],
            estimate: None,
        }
    }

    fn rate(
        &mut self,
        position: SVector<f64, NX>,
        shape: &SVector<f64, NS>,
        shape_rate: &SVector<f64, NS>,
        shape_acceleration: &SVector<f64, NS>,
    ) -> SVector<f64, NX> {
        let measured = position - self.response * shape;
        let still = -(self.response * shape_rate);
        let [y, yd] = self.estimate.unwrap_or([measured, still]);
        let acceleration = self.model.gamma(shape, shape_rate, shape_acceleration)
            - self.response * shape_acceleration;
        let half = 0.5 * self.period * self.period;
        let ahead = y + yd * self.period + acceleration * half;
        let residual = measured - ahead;
        let [alpha, beta] = self.gains;
        let yd = yd + acceleration * self.period + residual * beta;
        self.estimate = Some([ahead + residual * alpha, yd]);
        yd + self.response * shape_rate
    }
}

impl<T, const N: usize, const NX: usize, const NS: usize> Tracker<N, NX, NS>
    for RateFilter<'_, T, NX, NS>
where
    T: Tracker<N, NX, NS>,
{
    fn step(
        &mut self,
        state: &State<f64, N>,
        moment: &Moment<N, NX, NS>,
    ) -> Command<f64, N, NX, NS> {
        let position = SVector::from_fn(|i, _| state.q[i]);
        let shape = SVector::from_fn(|i, _| state.q[NX + i]);
        let shape_rate = SVector::from_fn(|i, _| state.qd[NX + i]);
        let rate = self.rate(position, &shape, &shape_rate, &moment.target.shape[2]);
        let mut smooth = *state;
        for (entry, rate) in smooth.qd.iter_mut().zip(rate.iter()) {
            *entry = *rate;
        }
        self.tracker.step(&smooth, moment)
    }
}
