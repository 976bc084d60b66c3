//! Rates of the position variables, and a constant offset of the measured shape.

use super::Settings;
use super::rate::FlatFilter;
use crate::observer::{OffsetObserver, flat_rate};
use crate::plant::{Dynamics, Plant};
use crate::signal::Finite;
use crate::{Error, State};
use nalgebra::SVector;
use shapebot_dynamics::{Ordered, Robot};

/// Compares how the velocity changes with Γ of the measured shape: the difference is an offset of that
/// shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeanOffset<T: Ordered, const N: usize, const NX: usize, const NS: usize> {
    plant: Plant<T, N, NX, NS>,
    filter: FlatFilter<T, NX>,
    observer: Option<OffsetObserver<T, NX>>,
}

impl<T: Ordered, const N: usize, const NX: usize, const NS: usize> LeanOffset<T, N, NX, NS> {
    pub(crate) fn new<R: Robot<T, N, NX, NS>>(
        robot: &R,
        settings: &Settings<T, N>,
    ) -> Result<Self, Error> {
        let plant = Plant::new(robot)?;
        // q̇_x answers q_s = K⁺ u by ẍ = u − τ² ü.
        let lag = plant.response * plant.body_gain;
        let squared = lag.iter().fold(T::zero(), |sum, x| sum + *x * *x) / T::from_f64(NX as f64);
        let filter = FlatFilter::new(settings, squared.sqrt());
        Ok(Self { plant, filter, observer: None })
    }

    pub(crate) fn balancing(&self) -> bool {
        self.plant.balancing
    }

    /// The offset, measured less true; a balancing robot's q̇_x is put into the state.
    pub(crate) fn step<R: Robot<T, N, NX, NS>>(
        &mut self,
        robot: &R,
        settings: &Settings<T, N>,
        state: &mut State<T, N>,
        expected: &SVector<T, N>,
    ) -> SVector<T, NS> {
        let (qx, qs) = R::split(&state.q);
        let (mut qxd, qsd) = R::split(&state.qd);
        let (_, qsdd) = R::split(expected);
        let response = &self.plant.response;
        let motion = robot.motion(&state.q, &state.qd);
        let drag = robot.dissipative_force(&state.q, &state.qd);
        let dynamics = Dynamics { motion: &motion, drag: &drag };
        let slope = self.plant.gamma(&dynamics, &qsdd) - response * qsdd;
        if self.plant.balancing {
            let found = self.observer.map_or(slope, |observer| slope + observer.offset);
            let rate = self.filter.step(&(qx - response * qs), &found, settings.period);
            qxd = rate + response * qsd;
            state.qd = R::join(&qxd, &qsd);
        }
        let z = flat_rate(response, &qxd, &qsd);
        let mut observer = self.observer.unwrap_or_else(|| OffsetObserver::new(z, slope));
        observer.advance(&z, &slope, [settings.period, settings.offset_rate]);
        if !observer.added_to(Finite::new()).holds() {
            return SVector::from_element(T::zero());
        }
        self.observer = Some(observer);
        -(self.plant.body_gain * observer.offset)
    }
}
