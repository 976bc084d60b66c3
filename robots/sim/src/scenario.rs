//! What differs from the nominal case.

use crate::error::at_least;
use crate::{Error, Floor, Friction};
use nalgebra::{SVector, Vector3};
use shapebot_dynamics::Description;

/// A force for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Index of a point of the description.
    pub point: usize,
    /// In world axes, N.
    pub force: Vector3<f64>,
    /// When it begins, s.
    pub start: f64,
    /// How long it lasts, s.
    pub duration: f64,
}

impl Push {
    /// Whether it acts at a time.
    pub(crate) fn acts(&self, time: f64) -> bool {
        time >= self.start && time < self.start + self.duration
    }
}

/// Imperfections of the sensors. Noise is white and Gaussian, given by its standard deviation per
/// sample.
///
/// Unactuated shape coordinates are an inertial unit's (relative to gravity, whatever the floor), the
/// others are joint encoders' and exact but for their resolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors<const NS: usize> {
    /// Noise of unactuated shape coordinates, rad.
    pub lean_noise: f64,
    /// Noise of their rates, rad/s.
    pub lean_rate_noise: f64,
    /// Constant error of shape coordinates.
    pub lean_bias: SVector<f64, NS>,
    /// Constant error of shape rates.
    pub lean_rate_bias: SVector<f64, NS>,
    /// Step of the encoders of position variables, in their unit: 2π over the counts per revolution.
    /// Zero for none; with it, rates are differences of counts: see [`crate::RateFilter`].
    pub position_step: f64,
    /// Step of the encoders of actuated shape coordinates; their rates are taken as measured.
    pub joint_step: f64,
    /// Age of what the controller is given, s.
    pub delay: f64,
}

impl<const NS: usize> Default for Sensors<NS> {
    fn default() -> Self {
        Self {
            lean_noise: 0.0,
            lean_rate_noise: 0.0,
            lean_bias: SVector::zeros(),
            lean_rate_bias: SVector::zeros(),
            position_step: 0.0,
            joint_step: 0.0,
            delay: 0.0,
        }
    }
}

/// Everything that makes a run different from the nominal one. [`Scenario::default`] is nominal.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario<const NX: usize, const NS: usize> {
    /// Between the drives and what they drive, on q̇_x.
    pub drive: Friction,
    /// Between the robot and the floor, on the rate of the output in units of q_x: acts in position and
    /// shape rows through ∂h/∂q.
    pub contact: Friction,
    /// Slopes.
    pub floor: Floor,
    /// Weights beyond the rigid bodies', N, by point: see [`crate::Weights`].
    pub weights: Vec<(usize, f64)>,
    /// Forces from outside.
    pub pushes: Vec<Push>,
    /// Time from a command to its force, s.
    pub actuation_delay: f64,
    /// Limits of the actuators relative to the declared ones.
    pub strength: f64,
    /// What the controller is told.
    pub sensors: Sensors<NS>,
    /// q_x beside the reference at the start.
    pub start_position: SVector<f64, NX>,
    /// q_s beside the reference at the start; the output stays where `start_position` puts it.
    pub start_shape: SVector<f64, NS>,
    /// Of the noise.
    pub seed: u64,
}

impl<const NX: usize, const NS: usize> Default for Scenario<NX, NS> {
    fn default() -> Self {
        Self {
            drive: Friction::default(),
            contact: Friction::default(),
            floor: Floor::default(),
            weights: Vec::new(),
            pushes: Vec::new(),
            actuation_delay: 0.0,
            strength: 1.0,
            sensors: Sensors::default(),
            start_position: SVector::zeros(),
            start_shape: SVector::zeros(),
            seed: 0,
        }
    }
}

impl<const NX: usize, const NS: usize> Scenario<NX, NS> {
    /// Refuses numbers out of range and points that a robot does not have.
    pub(crate) fn check(&self, description: &Description) -> Result<(), Error> {
        at_least("viscous friction of the drive", self.drive.viscous, 0.0)?;
        at_least("dry friction of the drive", self.drive.coulomb, 0.0)?;
        at_least("viscous friction of the contact", self.contact.viscous, 0.0)?;
        at_least("dry friction of the contact", self.contact.coulomb, 0.0)?;
        at_least("actuation delay", self.actuation_delay, 0.0)?;
        at_least("strength of the actuators", self.strength, 0.0)?;
        at_least("noise of the lean", self.sensors.lean_noise, 0.0)?;
        at_least("noise of the lean rate", self.sensors.lean_rate_noise, 0.0)?;
        at_least("step of the encoders", self.sensors.position_step, 0.0)?;
        at_least("step of the joint encoders", self.sensors.joint_step, 0.0)?;
        at_least("sensing delay", self.sensors.delay, 0.0)?;
        if self.floor.wave != [0.0; 2] {
            at_least("length of the floor's waves", self.floor.wavelength, f64::MIN_POSITIVE)?;
        }
        let points = description.points.len();
        let used = self.pushes.iter().map(|push| push.point);
        for index in used.chain(self.weights.iter().map(|&(point, _)| point)) {
            if index >= points {
                return Err(Error::Point { index, points });
            }
        }
        Ok(())
    }
}
