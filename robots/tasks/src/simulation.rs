//! What a task says about its simulation.

use crate::Quantities;
use crate::task::Said;

/// Which part of the shape makes up for errors of the position (Eq. 36).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compensate {
    /// The shape sets as in the plan.
    Plan,
    /// The unactuated shape alone.
    #[default]
    Body,
}

/// What follows the plan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Law {
    /// The control law of the paper's Fig. 4.
    #[default]
    Planned,
    /// A linear-quadratic regulator that follows the desired motion upright, without a plan.
    Regulator,
}

/// Diagonals of the regulator's weights.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Weights {
    /// Q: coordinates, then rates, SI units.
    pub state: Vec<f64>,
    /// R: actuators.
    pub actuator: Vec<f64>,
}

/// Friction that the model does not have.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Friction {
    /// Force per rate of the position variables.
    pub viscous: Option<Quantities>,
    /// Force whatever the rate.
    pub coulomb: Option<Quantities>,
}

/// Noise of the sensors: standard deviations per sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Noise {
    /// Of unactuated shape coordinates.
    pub lean: Option<Quantities>,
    /// Of their rates.
    pub rate: Option<Quantities>,
    /// Counts per revolution (per metre) of the position variables' encoders; 0 for none.
    pub counts: f64,
}

/// A force for a while.
#[derive(Clone, Debug, PartialEq)]
pub struct Push {
    /// Point of the model.
    pub point: Said<String>,
    /// In world axes.
    pub force: Said<Quantities>,
    /// Seconds.
    pub start: f64,
    /// Seconds.
    pub duration: f64,
}

/// A simulation: what happens to the robot, what it is told, and what drives it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Simulation {
    /// Standing after the plan, seconds.
    pub after: Option<f64>,
    /// Of the noise.
    pub seed: u64,
    /// Which part of the shape makes up for errors of the position.
    pub compensate: Compensate,
    /// What follows the plan.
    pub law: Law,
    /// Weights of the regulator.
    pub weights: Said<Weights>,
    /// Whether disturbing forces are observed; as designed if not said.
    pub observer: Option<bool>,
    /// Whether a constant offset of the lean is estimated; as designed if not said.
    pub offset: Option<bool>,
    /// Whether the tracker is told what an estimator makes of counts, gyro and accelerometer.
    pub estimator: bool,
    /// Gains instead of the designed ones, by name.
    pub gains: Vec<(Said<String>, Vec<f64>)>,
    /// At the drives.
    pub drive: Said<Friction>,
    /// At the floor.
    pub contact: Said<Friction>,
    /// From reading to knowing and from command to force, seconds.
    pub delay: [f64; 2],
    /// Of the sensors.
    pub noise: Said<Noise>,
    /// Constant error of the measured lean.
    pub bias: Option<Said<Quantities>>,
    /// Output beside the plan at the start.
    pub start_position: Option<Said<Quantities>>,
    /// Lean beside the plan at the start.
    pub start_lean: Option<Said<Quantities>>,
    /// Angles by which the floor rises along x and y.
    pub slope: Option<Said<Quantities>>,
    /// Forces from outside.
    pub pushes: Vec<Push>,
    /// Weights that the model writes as energies instead of rigid bodies, by point.
    pub point_weights: Vec<(Said<String>, Quantities)>,
    /// Parameters of the plant that differ from the model's, SI units.
    pub plant: Vec<(Said<String>, f64)>,
    /// Model of the plant, with terms that the robot's own drops.
    pub plant_model: Option<Said<String>>,
    /// Largest forces of the actuators relative to the declared ones.
    pub strength: Option<f64>,
}

/// What the paper reports about an experiment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Paper {
    /// Where.
    pub figure: Option<String>,
    /// Root of the mean squared error of the output against the plan.
    pub rmse: Option<f64>,
    /// Largest error of the output against the plan.
    pub largest: Option<f64>,
    /// Largest compensation by shape set.
    pub compensation: Vec<(Said<String>, f64)>,
}
