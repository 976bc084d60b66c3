//! A constant offset of the measured shape.

use super::Settings;
use crate::observer::{OffsetObserver, flat_rate};
use crate::plant::Plant;
use crate::{Error, State};
use nalgebra::SVector;
use shapebot_dynamics::{Ordered, Robot};

/// Compares how the velocity changes with Γ of the measured shape: the difference is an offset of that
/// shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeanOffset<T: Ordered, const N: usize, const NX: usize, const NS: usize> {
    plant: Plant<T, N, NX, NS>,
    observer: Option<OffsetObserver<T, NX>>,
}

impl<T: Ordered, const N: usize, const NX: usize, const NS: usize> LeanOffset<T, N, NX, NS> {
    pub(crate) fn new<R: Robot<T, N, NX, NS>>(robot: &R) -> Result<Self, Error> {
        Ok(Self { plant: Plant::new(robot)?, observer: None })
    }

    pub(crate) fn balancing(&self) -> bool {
        self.plant.balancing
    }

    /// The offset: measured less true.
    pub(crate) fn step<R: Robot<T, N, NX, NS>>(
        &mut self,
        robot: &R,
        settings: &Settings<T, N>,
        state: &State<T, N>,
        expected: &SVector<T, N>,
    ) -> SVector<T, NS> {
        let (qxd, qsd) = R::split(&state.qd);
        let (_, qsdd) = R::split(expected);
        let dynamics =
            (robot.motion(&state.q, &state.qd), robot.dissipative_force(&state.q, &state.qd));
        let slope = self.plant.gamma(&dynamics, &qsdd) - self.plant.response * qsdd;
        let z = flat_rate(&self.plant.response, &qxd, &qsd);
        let mut observer = self.observer.unwrap_or_else(|| OffsetObserver::new(z, slope));
        observer.advance(&z, &slope, [settings.period, settings.offset_rate]);
        if !observer.is_finite() {
            return SVector::from_element(T::zero());
        }
        self.observer = Some(observer);
        -(self.plant.body_gain * observer.offset)
    }
}
