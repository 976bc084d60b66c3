//! A robot in each of its states, kept.

use crate::session::Stage as _;
use crate::{Error, World, network, serve};
use shapebot_bus::Buses as _;
use shapebot_control::Gains;
use shapebot_drive::safety::{Request, State};
use shapebot_drive::{DriveTable, Fault};
use shapebot_drive_build::DriveDescription;
use shapebot_dynamics::Robot;
use shapebot_planner::value::PlanView;
use shapebot_runtime::{Runtime, Settings};
use shapebot_sim::Plant;

/// What a campaign is about: a robot with its drive and a task's plan.
pub struct Subject<'a, R, const N: usize, const NX: usize, const NS: usize> {
    /// Name of the task.
    pub task: &'a str,
    /// The robot.
    pub robot: &'a R,
    /// Its body.
    pub plant: &'a Plant<'a, N, NX, NS>,
    /// Its drive.
    pub description: &'a DriveDescription,
    /// The same for the master.
    pub table: &'a DriveTable<'a>,
    /// Gains.
    pub gains: Gains<f64, NX, NS>,
    /// The task's plan.
    pub plan: PlanView<'a, f64, NX, NS, N>,
}

/// A robot, its buses and its nodes at a time.
pub struct Checkpoint<'a, R, const N: usize, const NX: usize, const NS: usize> {
    /// Words for it.
    pub name: String,
    /// Safety state.
    pub state: State,
    /// Whether nothing has been sent yet.
    pub powered_up: bool,
    pub(crate) runtime: Runtime<'a, R, f64, N, NX, NS>,
    pub(crate) world: World<'a, R, N, NX, NS>,
}

impl<R, const N: usize, const NX: usize, const NS: usize> std::fmt::Debug
    for Checkpoint<'_, R, N, NX, NS>
{
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Checkpoint").field("name", &self.name).finish_non_exhaustive()
    }
}

/// Longest wait for a state, µs.
const PATIENCE: u64 = 10_000_000;

/// Takes a robot through its task and keeps it in each state.
///
/// # Errors
///
/// [`Error::Late`] if a state is not reached.
pub fn checkpoints<'a, R, const N: usize, const NX: usize, const NS: usize>(
    subject: &Subject<'a, R, N, NX, NS>,
) -> Result<Vec<Checkpoint<'a, R, N, NX, NS>>, Error>
where
    R: Robot<f64, N, NX, NS>,
{
    let Subject { robot, plant, description, table, plan, .. } = *subject;
    let mut runtime = Runtime::new(robot, table, &subject.gains, &Settings::default())?;
    runtime.load(plan)?;
    let world = network(description, robot, plant, 1)?;
    let mut walk = Walk { task: subject.task, runtime, world, kept: Vec::new() };
    walk.keep("at power-up", true);
    walk.pass(30_000)?;
    walk.keep("in set-up", false);
    walk.reach(State::LegsDown)?;
    walk.keep_after("", 20_000)?;
    walk.ask(Request::Start)?;
    walk.keep("", false);
    walk.reach(State::Rising)?;
    walk.keep_after("", 100_000)?;
    walk.reach(State::Balancing)?;
    walk.keep_after("", 100_000)?;
    walk.ask(Request::KeepStation)?;
    walk.keep_after("", 300_000)?;
    walk.pass(1_500_000)?;
    walk.branches(table.yaw.is_some())?;
    walk.ask(Request::Track)?;
    let seconds = plan.end_time() - plan.start_time();
    let begun = walk.world.now();
    for percent in [15, 40, 65, 90] {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "`as` saturates"
        )]
        let at = begun + (seconds * 1e4 * f64::from(percent)) as u64;
        walk.pass(at.saturating_sub(walk.world.now()))?;
        walk.keep(&format!("at {percent} %"), false);
    }
    Ok(walk.kept)
}

struct Walk<'s, 'a, R, const N: usize, const NX: usize, const NS: usize> {
    task: &'s str,
    runtime: Runtime<'a, R, f64, N, NX, NS>,
    world: World<'a, R, N, NX, NS>,
    kept: Vec<Checkpoint<'a, R, N, NX, NS>>,
}

impl<'a, R, const N: usize, const NX: usize, const NS: usize> Walk<'_, 'a, R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    /// States that end the walk: each from a copy.
    fn branches(&mut self, has_yaw: bool) -> Result<(), Error> {
        let here = (self.runtime.clone(), self.world.clone());
        if has_yaw {
            self.runtime.master_mut().aim(0.6);
            self.ask(Request::Yaw)?;
            self.keep_after("", 200_000)?;
            (self.runtime, self.world) = here.clone();
        }
        self.ask(Request::Stop)?;
        self.keep_after("", 100_000)?;
        (self.runtime, self.world) = here.clone();
        self.runtime.report(Fault::OperatorSilent, self.world.now());
        self.keep_after("", 50_000)?;
        self.reach(State::FaultDown)?;
        self.keep_after("", 300_000)?;
        (self.runtime, self.world) = here;
        Ok(())
    }

    fn keep(&mut self, name: &str, powered_up: bool) {
        let state = self.runtime.master().state();
        let name = format!("{}, {state:?} {name}", self.task);
        let (runtime, world) = (self.runtime.clone(), self.world.clone());
        let name = name.trim_end().to_owned();
        self.kept.push(Checkpoint { name, state, powered_up, runtime, world });
    }

    fn keep_after(&mut self, name: &str, micros: u64) -> Result<(), Error> {
        self.pass(micros)?;
        self.keep(name, false);
        Ok(())
    }

    fn pass(&mut self, micros: u64) -> Result<(), Error> {
        let end = self.world.now() + micros;
        while self.world.now() < end {
            self.step(end)?;
        }
        Ok(())
    }

    fn step(&mut self, end: u64) -> Result<(), Error> {
        let torque =
            |runtime: &Runtime<'a, R, f64, N, NX, NS>| runtime.master().state().permits_torque();
        let before = torque(&self.runtime);
        serve(&mut self.runtime, &mut self.world, end)?;
        let after = torque(&self.runtime);
        let absent = self.runtime.master().legs().is_none();
        if absent && before != after {
            self.world.hold(!after);
        }
        Ok(())
    }

    fn reach(&mut self, wanted: State) -> Result<(), Error> {
        let end = self.world.now() + PATIENCE;
        while self.runtime.master().state() != wanted {
            if self.world.now() >= end {
                let master = self.runtime.master();
                let (state, faults) = (master.state(), *master.faults());
                return Err(Error::Late {
                    wanted,
                    state,
                    faults,
                    failed_step: master.failed_step(),
                });
            }
            self.step(end)?;
        }
        Ok(())
    }

    fn ask(&mut self, request: Request) -> Result<(), Error> {
        if self.runtime.request(request, self.world.now()) {
            Ok(())
        } else {
            Err(Error::Refused(self.runtime.master().state()))
        }
    }
}
