//! What came out of an experiment: lists, whatever the robot's sizes.

use nalgebra::SVector;
use shapebot_dynamics::Description;
use shapebot_report::Animation;
use shapebot_sim::Run;
use shapebot_tasks::simulation::Law;
use shapebot_tasks::{Method, Task};

/// A closed-loop run of a task.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The robot.
    pub description: Description,
    /// The task's title, or empty.
    pub title: String,
    /// How its plan was made.
    pub method: Method,
    /// What followed it.
    pub law: Law,
    /// Root of the mean squared error of the plan's output against the desired one.
    pub plan_rmse: f64,
    /// When the plan ends, s.
    pub duration: f64,
    /// Errors of the run.
    pub errors: Errors,
    /// If it fell, the run ends there.
    pub fell: Option<Fall>,
    /// Recorded instants.
    pub samples: Vec<Sample>,
    /// Poses over some of them.
    pub animation: Option<Animation>,
    /// From one shown instant of the animation to the next: every so many samples.
    pub frame_every: usize,
    /// Gain of the regulator, a row per actuator; none for the control law.
    pub regulator: Option<Vec<Vec<f64>>>,
}

/// Errors over the time of the plan, in the output's unit; with compensation and forces.
#[derive(Clone, Debug, PartialEq)]
pub struct Errors {
    /// Root of the mean squared distance from the plan.
    pub plan_rmse: f64,
    /// Root of the mean squared distance from the desired motion.
    pub desired_rmse: f64,
    /// Largest distance from the plan.
    pub plan_max: f64,
    /// Largest distance from the desired motion.
    pub desired_max: f64,
    /// Distance from the desired goal when the plan ends.
    pub goal: f64,
    /// Distance from the desired goal when the run ends.
    pub end: f64,
    /// Largest compensation of each shape coordinate.
    pub compensation: Vec<f64>,
    /// Largest error of each shape coordinate against planned and compensating shape together, over the
    /// recorded instants.
    pub shape: Vec<f64>,
    /// Largest force of each actuator.
    pub force: Vec<f64>,
    /// Part of the time in which something met a limit.
    pub saturated: f64,
}

/// When and how a robot fell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fall {
    /// s
    pub time: f64,
    /// The coordinate that left its range.
    pub coordinate: &'static str,
    /// Its value.
    pub value: f64,
}

/// A recorded instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Since the start, s.
    pub time: f64,
    /// Desired, planned and actual output.
    pub output: [Vec<f64>; 3],
    /// q and q̇ of the plant.
    pub state: [Vec<f64>; 2],
    /// q_s of the plan.
    pub planned_shape: Vec<f64>,
    /// q_s^c (Eq. 36).
    pub compensation: Vec<f64>,
    /// Forces of the actuators.
    pub force: Vec<f64>,
}

fn list<const L: usize>(vector: &SVector<f64, L>) -> Vec<f64> {
    vector.as_slice().to_vec()
}

impl Experiment {
    /// From a run; without animation.
    pub(crate) fn of<const N: usize, const NX: usize, const NS: usize>(
        description: &Description,
        task: &Task,
        plan: (f64, f64),
        run: &Run<N, NX, NS>,
    ) -> Self {
        let actuators = description.actuators.len();
        let samples = run.samples.iter().map(|sample| Sample {
            time: sample.time,
            output: [list(&sample.desired), list(&sample.planned), list(&sample.actual)],
            state: [list(&sample.state.q), list(&sample.state.qd)],
            planned_shape: list(&sample.planned_shape),
            compensation: list(&sample.compensation),
            force: sample.actuator.iter().take(actuators).copied().collect(),
        });
        let mut shape = vec![0.0_f64; NS];
        for sample in &run.samples {
            let wanted = sample.planned_shape + sample.compensation;
            for (i, peak) in shape.iter_mut().enumerate() {
                *peak = peak.max((sample.state.q[NX + i] - wanted[i]).abs());
            }
        }
        let errors = &run.errors;
        Self {
            description: *description,
            title: task.title.clone().unwrap_or_default(),
            method: task.method,
            law: task.simulation.law,
            plan_rmse: plan.0,
            duration: plan.1,
            errors: Errors {
                plan_rmse: errors.plan_rmse,
                desired_rmse: errors.desired_rmse,
                plan_max: errors.plan_max,
                desired_max: errors.desired_max,
                goal: errors.goal_error,
                end: errors.end_error,
                compensation: list(&errors.compensation_peak),
                shape,
                force: errors.actuator_peak.iter().take(actuators).copied().collect(),
                saturated: errors.saturated,
            },
            fell: run.fell.map(|fall| Fall {
                time: fall.time,
                coordinate: description.coordinates.get(fall.coordinate).map_or("", |c| c.name),
                value: fall.value,
            }),
            samples: samples.collect(),
            animation: None,
            frame_every: 1,
            regulator: None,
        }
    }

    /// Largest compensation within a shape set.
    #[must_use]
    pub fn compensation_of(&self, set: &str) -> Option<f64> {
        let set = self.description.shape_sets.iter().find(|other| other.name == set)?;
        let part = self.errors.compensation.get(set.first..set.first + set.len)?;
        Some(part.iter().copied().fold(0.0, f64::max))
    }
}
