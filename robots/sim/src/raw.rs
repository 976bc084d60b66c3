//! What sensors say before anyone makes a state of it.

use crate::floor::turned_gravity;
use crate::{Plant, Sensors};
use nalgebra::{Matrix3, SVector, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use shapebot_control::State;
use shapebot_control::estimator::Reading;
use std::collections::VecDeque;

/// Gravity, m/s².
const GRAVITY: f64 = 9.81;

/// Seconds over which a turning rate is measured from rotations.
const SHORT: f64 = 1e-5;

/// Where an inertial unit sits, and what a count is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit<const N: usize> {
    /// Index of the frame that it turns with.
    pub frame: usize,
    /// Index of the point at which it sits.
    pub point: usize,
    /// Unit of the coordinate per count of its encoder.
    pub resolution: SVector<f64, N>,
}

/// The encoders and the inertial unit of a run.
///
/// [`Sensors::lean_bias`] turns the unit in its frame, [`Sensors::lean_rate_bias`] is the gyro's error,
/// [`Sensors::lean_rate_noise`] the gyro's noise along each axis, and [`Sensors::lean_noise`] the
/// accelerometer's, as the lean that it feigns at rest.
pub(crate) struct RawSensors<const N: usize, const NS: usize> {
    settings: Sensors<NS>,
    period: f64,
    noise: ChaCha8Rng,
    /// Velocity, m/s, and axes of the unit one period before.
    before: Option<(Vector3<f64>, Matrix3<f64>)>,
    /// Readings on their way, oldest first.
    on_the_way: VecDeque<Reading<f64, N>>,
    age: usize,
}

impl<const N: usize, const NS: usize> RawSensors<N, NS> {
    pub(crate) fn new(settings: Sensors<NS>, period: f64, seed: u64) -> Self {
        Self {
            settings,
            period,
            noise: ChaCha8Rng::seed_from_u64(seed),
            before: None,
            on_the_way: VecDeque::new(),
            age: (settings.delay / period).round() as usize,
        }
    }

    /// A reading at a state; the acceleration is the mean over the period before.
    pub(crate) fn read<const NX: usize>(
        &mut self,
        plant: &Plant<'_, N, NX, NS>,
        unit: &Unit<N>,
        state: &State<f64, N>,
    ) -> Reading<f64, N> {
        let (system, sensors) = (plant.system(), self.settings);
        let all = |shape: &SVector<f64, NS>| {
            SVector::<f64, N>::from_fn(|i, _| if i < N - NS { 0.0 } else { shape[i - (N - NS)] })
        };
        let seen = state.q + all(&sensors.lean_bias);
        let rate = state.qd + all(&sensors.lean_rate_bias);
        let rotation = system.frame_rotation(&seen, unit.frame);
        let [before, after] =
            [-SHORT, SHORT].map(|time| system.frame_rotation(&(seen + rate * time), unit.frame));
        let spin = rotation.transpose() * (after - before) / (2.0 * SHORT);
        let velocity = system.point_jacobian(&state.q, unit.point) * state.qd;
        let (last, axes) =
            self.before.replace((velocity, rotation)).unwrap_or((velocity, rotation));
        let mean = 0.5 * (rotation + axes);
        let down = turned_gravity(plant.floor_angles(&state.q)) - Vector3::z();
        let felt = (velocity - last) / self.period - down * GRAVITY;
        let count = |i: usize| (seen[i] / unit.resolution[i]).round() as i64 as i32;
        let reading = Reading {
            counts: std::array::from_fn(count),
            gyro: Vector3::new(spin[(2, 1)], spin[(0, 2)], spin[(1, 0)])
                + self.noise(sensors.lean_rate_noise),
            accelerometer: mean.transpose() * felt + self.noise(sensors.lean_noise * GRAVITY),
        };
        self.on_the_way.push_back(reading);
        if self.on_the_way.len() > self.age + 1 {
            self.on_the_way.pop_front();
        }
        *self.on_the_way.front().unwrap_or(&reading)
    }

    fn noise(&mut self, deviation: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| {
            let sample: f64 = StandardNormal.sample(&mut self.noise);
            deviation * sample
        })
    }
}
