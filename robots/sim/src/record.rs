//! What came out of a run.

use crate::reference::Moment;
use nalgebra::SVector;
use shapebot_control::{Command, State};

/// One control period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<const N: usize, const NX: usize, const NS: usize> {
    /// Since the start, s.
    pub time: f64,
    /// The plant's state.
    pub state: State<f64, N>,
    /// Where the output is desired, planned, and is, in the output's unit.
    pub desired: SVector<f64, NX>,
    /// h of the plan.
    pub planned: SVector<f64, NX>,
    /// h of the plant.
    pub actual: SVector<f64, NX>,
    /// q_s^p.
    pub planned_shape: SVector<f64, NS>,
    /// q_s^c (Eq. 36).
    pub compensation: SVector<f64, NS>,
    /// Forces that the controller asks of the actuators, in the order of the description.
    pub actuator: SVector<f64, N>,
    /// Whether something met a limit.
    pub saturated: bool,
}

/// When and how a robot fell: a position variable or an unactuated shape variable left its declared
/// range (a ballbot lies down, a cart is off its track, a marble off its plate), or a coordinate is no
/// number any more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fall {
    /// s
    pub time: f64,
    /// Index of the coordinate.
    pub coordinate: usize,
    /// Its value.
    pub value: f64,
}

/// Errors over the time of the reference, output's unit; with what compensation and actuators gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors<const N: usize, const NS: usize> {
    /// Root of the mean squared distance from the plan.
    pub plan_rmse: f64,
    /// Root of the mean squared distance from the desired motion.
    pub desired_rmse: f64,
    /// Largest distance from the plan.
    pub plan_max: f64,
    /// Largest distance from the desired motion.
    pub desired_max: f64,
    /// Distance from the desired goal when the reference ends.
    pub goal_error: f64,
    /// Distance from the desired goal when the run ends.
    pub end_error: f64,
    /// Root of the mean squared compensation of each shape coordinate.
    pub compensation_rms: SVector<f64, NS>,
    /// Largest compensation of each shape coordinate.
    pub compensation_peak: SVector<f64, NS>,
    /// Largest force asked of each actuator.
    pub actuator_peak: SVector<f64, N>,
    /// Part of the steps in which something met a limit.
    pub saturated: f64,
}

/// A run.
#[derive(Clone, Debug, PartialEq)]
pub struct Run<const N: usize, const NX: usize, const NS: usize> {
    /// Every so many control periods, and the last.
    pub samples: Vec<Sample<N, NX, NS>>,
    /// If it fell, the run ends there.
    pub fell: Option<Fall>,
    /// Over all control periods, recorded or not. Those of a run that fell end with it.
    pub errors: Errors<N, NS>,
}

impl<const N: usize, const NX: usize, const NS: usize> Run<N, NX, NS> {
    /// The largest distance from the plan at and after a time, over the recorded samples; infinite if
    /// the run ended before.
    #[must_use]
    pub fn plan_error_after(&self, time: f64) -> f64 {
        let late = self.samples.iter().filter(|sample| sample.time >= time - 1e-9);
        let distances = late.map(|sample| (sample.actual - sample.planned).norm());
        if self.fell.is_some() {
            return f64::INFINITY;
        }
        distances
            .fold(None, |worst: Option<f64>, d| Some(worst.map_or(d, |w| w.max(d))))
            .unwrap_or(f64::INFINITY)
    }
}

/// Sums up errors step by step.
pub(crate) struct Tally<const N: usize, const NS: usize> {
    errors: Errors<N, NS>,
    counted: f64,
    steps: f64,
}

impl<const N: usize, const NS: usize> Tally<N, NS> {
    pub(crate) fn new() -> Self {
        let errors = Errors {
            plan_rmse: 0.0,
            desired_rmse: 0.0,
            plan_max: 0.0,
            desired_max: 0.0,
            goal_error: 0.0,
            end_error: 0.0,
            compensation_rms: SVector::zeros(),
            compensation_peak: SVector::zeros(),
            actuator_peak: SVector::zeros(),
            saturated: 0.0,
        };
        Self { errors, counted: 0.0, steps: 0.0 }
    }

    /// `within`: the reference still runs.
    pub(crate) fn add<const NX: usize>(
        &mut self,
        moment: &Moment<N, NX, NS>,
        actual: &SVector<f64, NX>,
        command: &Command<f64, N, NX, NS>,
        within: bool,
    ) {
        let errors = &mut self.errors;
        let desired = (actual - moment.desired[0]).norm();
        errors.end_error = desired;
        errors.actuator_peak = errors.actuator_peak.sup(&command.actuator.abs());
        errors.compensation_peak = errors.compensation_peak.sup(&command.compensation.abs());
        errors.saturated += f64::from(u8::from(command.saturated));
        self.steps += 1.0;
        if within {
            let plan = (actual - moment.planned).norm();
            errors.plan_rmse += plan * plan;
            errors.desired_rmse += desired * desired;
            errors.plan_max = errors.plan_max.max(plan);
            errors.desired_max = errors.desired_max.max(desired);
            errors.goal_error = desired;
            errors.compensation_rms += command.compensation.component_mul(&command.compensation);
            self.counted += 1.0;
        }
    }

    pub(crate) fn errors(&self) -> Errors<N, NS> {
        let counted = self.counted.max(1.0);
        let mean = |sum: f64| (sum / counted).sqrt();
        Errors {
            plan_rmse: mean(self.errors.plan_rmse),
            desired_rmse: mean(self.errors.desired_rmse),
            compensation_rms: self.errors.compensation_rms.map(mean),
            saturated: self.errors.saturated / self.steps.max(1.0),
            ..self.errors
        }
    }
}
