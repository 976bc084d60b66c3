//! A tracker that is told what an estimator makes of the sensors.

use crate::raw::Unit;
use crate::reference::Moment;
use crate::simulate::Tracker;
use crate::{Error, Sensors};
use nalgebra::SVector;
use shapebot_control::estimator::{Estimator, Reading, Settings};
use shapebot_control::{Command, State};
use shapebot_dynamics::Robot;

/// Puts the estimator of `shapebot-control` between the sensors and a tracker: encoder counts, gyro and
/// accelerometer instead of states. Counts are absolute, lean and rates have to be found.
pub struct Estimated<'r, R, T, const N: usize, const NX: usize, const NS: usize> {
    tracker: T,
    robot: &'r R,
    settings: Settings<f64, N>,
    estimator: Estimator<'r, R, f64, N, NX, NS>,
    started: bool,
}

impl<'r, R, T, const N: usize, const NX: usize, const NS: usize> Estimated<'r, R, T, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    /// For a tracker that works every `period` seconds on a robot like `robot`. Encoders have the steps
    /// of `sensors`, or 2¹⁶ counts per unit of their coordinate.
    ///
    /// # Errors
    ///
    /// As [`Estimator::new`].
    pub fn new(
        robot: &'r R,
        tracker: T,
        sensors: &Sensors<NS>,
        period: f64,
    ) -> Result<Self, Error> {
        let mut settings = Settings::<f64, N>::new(period);
        for (i, resolution) in settings.resolution.iter_mut().enumerate() {
            let step = if i < NX { sensors.position_step } else { sensors.joint_step };
            if step > 0.0 {
                *resolution = step;
            }
        }
        let estimator = Estimator::new(robot, &settings, &SVector::zeros());
        let estimator = estimator.map_err(Error::Control)?;
        Ok(Self { tracker, robot, settings, estimator, started: false })
    }
}

impl<R, T, const N: usize, const NX: usize, const NS: usize> Tracker<N, NX, NS>
    for Estimated<'_, R, T, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
    T: Tracker<N, NX, NS>,
{
    fn step(
        &mut self,
        state: &State<f64, N>,
        moment: &Moment<N, NX, NS>,
    ) -> Command<f64, N, NX, NS> {
        self.tracker.step(state, moment)
    }

    fn unit(&self) -> Option<Unit<N>> {
        let frame = self.estimator.frame().unwrap_or(0);
        let Settings { point, resolution, .. } = self.settings;
        Some(Unit { frame, point, resolution })
    }

    fn estimate(&mut self, reading: &Reading<f64, N>, moment: &Moment<N, NX, NS>) -> State<f64, N> {
        let target = &moment.target;
        if !self.started {
            let start =
                SVector::from_fn(|i, _| f64::from(reading.counts[i]) * self.settings.resolution[i]);
            if let Ok(estimator) = Estimator::new(self.robot, &self.settings, &start) {
                self.estimator = estimator;
            }
            self.started = true;
        }
        let expected = R::join(&target.position[2], &target.shape[2]);
        self.estimator.step(reading, &expected).state
    }
}
