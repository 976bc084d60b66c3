//! One experiment: reference, controller and plant in a loop.

use crate::Error;
use crate::experiment::Experiment;
use crate::gains::gains;
use crate::reference::reference;
use crate::scenario::scenario;
use crate::subject::{Subject, System};
use shapebot_control::{Controller, Gains};
use shapebot_planner::value::RobotId;
use shapebot_planning::{PlannedMotion, Refusal};
use shapebot_report::Recorder;
use shapebot_sim::{
    Estimated, Lqr, LqrWeights, RateFilter, Run, Scale, Scenario, Table, Timing, Tracker, World,
    simulate,
};
use shapebot_tasks::simulation::Law;
use shapebot_tasks::{Said, Task};

/// Standing after the plan if the task does not say, s.
const AFTER: f64 = 2.0;

/// Recorded instants per second.
const RECORDED: f64 = 100.0;

/// Bandwidth of the filter that makes rates of counts, over the robot's time.
const RATE_BANDWIDTH: f64 = 13.0;

/// Shown instants of an animation per second.
const SHOWN: f64 = 25.0;

/// Everything that stays the same from run to run of a task.
pub(crate) struct Loops<'a, const N: usize, const NX: usize, const NS: usize> {
    pub(crate) subject: Subject<'a, N, NX, NS>,
    pub(crate) task: &'a Task,
    pub(crate) planned: &'a PlannedMotion,
    pub(crate) reference: Table<N, NX, NS>,
    pub(crate) scale: Scale,
    gains: Gains<f64, NX, NS>,
}

impl<'a, const N: usize, const NX: usize, const NS: usize> Loops<'a, N, NX, NS> {
    pub(crate) fn new(
        subject: Subject<'a, N, NX, NS>,
        task: &'a Task,
        planned: &'a PlannedMotion,
        id: &RobotId<'_>,
    ) -> Result<Self, Error> {
        let gains = gains(subject.model, subject.design, planned, &task.simulation)?;
        let reference = reference(subject.model, planned, id, gains.period)?;
        let scale = Scale::of(&subject.model)?;
        Ok(Self { subject, task, planned, reference, scale, gains })
    }

    /// When the plan ends, s.
    pub(crate) fn duration(&self) -> f64 {
        self.reference.step() * (self.reference.moments().len() - 1) as f64
    }

    /// The plant of the task, with further parameters set.
    pub(crate) fn plant(&self, set: &[(&str, f64)]) -> Result<Box<System<N>>, Refusal> {
        plant(self.subject, self.task, set)
    }

    /// One run; samples per second are recorded, or the first and the last only.
    pub(crate) fn run(
        &self,
        plant: &System<N>,
        scenario: &Scenario<NX, NS>,
        recorded: Option<f64>,
    ) -> Result<Run<N, NX, NS>, Error> {
        match self.task.simulation.law {
            Law::Planned => {
                let controller = Controller::new(&self.subject.model, &self.gains)?;
                self.follow(plant, scenario, recorded, controller)
            }
            Law::Regulator => self.follow(plant, scenario, recorded, self.regulator()?),
        }
    }

    fn follow(
        &self,
        plant: &System<N>,
        scenario: &Scenario<NX, NS>,
        recorded: Option<f64>,
        mut tracker: impl Tracker<N, NX, NS>,
    ) -> Result<Run<N, NX, NS>, Error> {
        let (model, period) = (self.subject.model, self.gains.period);
        let timing = Timing {
            period,
            after: self.task.simulation.after.unwrap_or(AFTER),
            record_every: recorded.map_or(0, |rate| every(period, rate)),
            ..Timing::default()
        };
        let world = World { system: plant, map: model, scenario, timing };
        if self.task.simulation.estimator {
            let sensors = &scenario.sensors;
            let mut estimated = Estimated::new(&model, tracker, sensors, period)?;
            return Ok(simulate(&world, &self.reference, &mut estimated)?);
        }
        if scenario.sensors.position_step > 0.0 {
            let bandwidth = RATE_BANDWIDTH / self.scale.time;
            let mut filtered = RateFilter::new(&model, tracker, period, bandwidth);
            return Ok(simulate(&world, &self.reference, &mut filtered)?);
        }
        Ok(simulate(&world, &self.reference, &mut tracker)?)
    }

    fn regulator(&self) -> Result<Lqr<'_, N, NX, NS>, Error> {
        let Said { value, place } = &self.task.simulation.weights;
        let weights = LqrWeights { state: value.state.clone(), actuator: value.actuator.clone() };
        Lqr::new(&self.subject.model, &weights, self.gains.period).map_err(|error| match error {
            shapebot_sim::Error::Invalid { .. } => Refusal::task(error).at(place).into(),
            other => other.into(),
        })
    }
}

/// The plant of a task, with further parameters set.
fn plant<const N: usize, const NX: usize, const NS: usize>(
    subject: Subject<'_, N, NX, NS>,
    task: &Task,
    set: &[(&str, f64)],
) -> Result<Box<System<N>>, Refusal> {
    let simulation = &task.simulation;
    let own = simulation.plant.iter().map(|(name, value)| (name.value.clone(), *value));
    let mut all: Vec<(String, f64)> = own.collect();
    for (name, value) in set {
        all.retain(|(other, _)| other != name);
        all.push(((*name).to_owned(), *value));
    }
    let model = simulation.plant_model.as_ref();
    let place = simulation.plant.first().map(|(name, _)| &name.place);
    let place = model.map(|model| &model.place).or(place);
    let plant = subject.plants.plant(model.map(|model| model.value.as_str()), &all);
    let plant = plant.and_then(|plant| plant.of::<N>());
    plant.map_err(|refusal| refusal.at(place.map_or("", String::as_str)))
}

/// What a task says of its simulation: the plant, and what happens to it.
///
/// # Errors
///
/// A task that makes no sense for the robot.
pub fn circumstances<const N: usize, const NX: usize, const NS: usize>(
    subject: Subject<'_, N, NX, NS>,
    task: &Task,
) -> Result<(Box<System<N>>, Scenario<NX, NS>), Error> {
    Ok((plant(subject, task, &[])?, scenario(subject.model, &task.simulation)?))
}

/// Steps of `period` per recorded instant.
fn every(period: f64, rate: f64) -> usize {
    ((1.0 / (rate * period)).round() as usize).max(1)
}

/// Runs a planned task; `id` is the robot that the plan has to be for.
///
/// # Errors
///
/// A task that makes no sense for the robot, a plan of another robot, a controller or simulation that
/// is refused.
pub fn run<const N: usize, const NX: usize, const NS: usize>(
    subject: Subject<'_, N, NX, NS>,
    task: &Task,
    planned: &PlannedMotion,
    id: &RobotId<'_>,
) -> Result<Experiment, Error> {
    let loops = Loops::new(subject, task, planned, id)?;
    let scenario = scenario(subject.model, &task.simulation)?;
    let plant = loops.plant(&[])?;
    loops.recorded(&*plant, &scenario)
}

impl<const N: usize, const NX: usize, const NS: usize> Loops<'_, N, NX, NS> {
    /// A run with samples and animation.
    pub(crate) fn recorded(
        &self,
        plant: &System<N>,
        scenario: &Scenario<NX, NS>,
    ) -> Result<Experiment, Error> {
        let run = self.run(plant, scenario, Some(RECORDED))?;
        let plan = (self.planned.output_rmse, self.duration());
        let description = self.subject.model.description();
        let mut experiment = Experiment::of(description, self.task, plan, &run);
        experiment.frame_every = every(1.0 / RECORDED, SHOWN);
        let mut recorder = Recorder::new(&self.subject.model);
        for sample in run.samples.iter().step_by(experiment.frame_every) {
            recorder.push(&sample.state.q, &sample.desired, &sample.planned);
        }
        experiment.animation = Some(recorder.finish());
        if self.task.simulation.law == Law::Regulator {
            let gain = self.regulator()?;
            let rows = gain.gain().row_iter().map(|row| row.iter().copied().collect());
            experiment.regulator = Some(rows.collect());
        }
        Ok(experiment)
    }
}
