//! A task from power-up to rest on the legs.

use crate::{Error, World, serve};
use nalgebra::SVector;
use shapebot_bus::{Buses, Wired};
use shapebot_control::State as Coordinates;
use shapebot_drive::safety::{Request, State};
use shapebot_drive::{Counters, DriveTable, Jitter, Role};
use shapebot_dynamics::Robot;
use shapebot_nodes::Mechanism;
use shapebot_planner::value::{PlanView, Stored};
use shapebot_runtime::{Runtime, Snapshot};

/// Where a runtime works: buses, and what is known of the robot beside them.
pub trait Stage<const N: usize>: Buses {
    /// Coordinates and rates as they are, now; `None` if only sensors know.
    fn truth(&mut self) -> Option<Coordinates<f64, N>> {
        None
    }

    /// Holds a robot without legs by hand, or lets it go.
    fn hold(&mut self, _held: bool) {}
}

impl<const N: usize> Stage<N> for Wired {}

impl<R, const N: usize, const NX: usize, const NS: usize> Stage<N> for World<'_, R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    fn truth(&mut self) -> Option<Coordinates<f64, N>> {
        Some(*self.plant_now().mechanism().state())
    }

    fn hold(&mut self, held: bool) {
        self.plant_now().mechanism_mut().set_legs(f64::from(u8::from(held)));
    }
}

/// Times of a session, µs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Script {
    /// For set-up, for enabling and rising, and for lowering.
    pub patience: u64,
    /// Standing before the plan.
    pub before: u64,
    /// Standing after it.
    pub after: u64,
    /// Lateness that is forgiven beyond what the drive's table allows: for computers that keep no time.
    pub slack: u32,
}

impl Script {
    /// The table with limits that forgive lateness.
    pub(crate) fn forgiving<'t>(&self, mut table: DriveTable<'t>) -> DriveTable<'t> {
        let cycles = self.slack.div_ceil(table.timing.period_us.max(1));
        let cycles = u8::try_from(cycles).unwrap_or(u8::MAX);
        let (timing, safety) = (&mut table.timing, &mut table.safety);
        timing.jitter_limit_us = timing.jitter_limit_us.saturating_add(self.slack);
        for limit in [&mut timing.missed_fault, &mut safety.stale_fault, &mut safety.silent_fault] {
            *limit = limit.saturating_add(cycles);
        }
        table
    }
}

impl Default for Script {
    /// Three seconds before the plan, two after it; nothing is forgiven.
    fn default() -> Self {
        Self { patience: 10_000_000, before: 3_000_000, after: 2_000_000, slack: 0 }
    }
}

/// A control cycle.
#[derive(Clone, Copy, Debug)]
pub struct Cycle<'c, T: Stored, const N: usize, const NX: usize, const NS: usize> {
    /// Now, µs: after the controller's turn.
    pub now: u64,
    /// What the runtime made of it.
    pub snapshot: &'c Snapshot<T, N, NX, NS>,
    /// The robot as it is, now.
    pub truth: Option<Coordinates<f64, N>>,
}

/// What came out of a session. Errors are those of the output against the plan while it is followed, of
/// the robot as it is where that is known, else as measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Root of the mean squared error.
    pub plan_rmse: f64,
    /// Largest error.
    pub plan_max: f64,
    /// Distance from the plan's end when the robot stood again.
    pub end_error: f64,
    /// Whether errors are those of the robot as it is.
    pub is_truth: bool,
    /// Largest measured lean while the plan was followed, rad.
    pub lean_max: f64,
    /// Largest compensation, rad.
    pub compensation_max: f64,
    /// Largest force of an actuator that the controller asked for, N·m or N.
    pub force_max: f64,
    /// Cycles in which the plan was followed.
    pub cycles: u32,
    /// What happened on the buses.
    pub counters: Counters,
    /// How late SYNC was.
    pub sync: Jitter,
}

/// Takes a robot through a task: set-up, enabling, rising, balancing, station keeping, the plan, station
/// keeping, legs down. `each` sees every control cycle.
///
/// # Errors
///
/// [`Error::Late`] where a state is not reached, with the faults of the drive; errors of the buses.
pub fn run<R, T, S, const N: usize, const NX: usize, const NS: usize>(
    runtime: &mut Runtime<'_, R, T, N, NX, NS>,
    (robot, plan): (&R, &PlanView<'_, T, NX, NS, N>),
    stage: &mut S,
    script: &Script,
    each: &mut dyn FnMut(&Cycle<'_, T, N, NX, NS>),
) -> Result<Outcome, Error>
where
    R: Robot<T, N, NX, NS>,
    T: Stored,
    S: Stage<N>,
{
    let legs = runtime.master().table().nodes.iter().any(|node| node.role == Role::Legs);
    let tally = Tally::default();
    let mut session = Session { runtime, robot, plan, stage, each, tally, legs };
    session.reach(State::LegsDown, script.patience)?;
    session.ask(Request::Start)?;
    session.reach(State::Balancing, script.patience)?;
    session.ask(Request::KeepStation)?;
    session.stay(State::StationKeeping, script.before)?;
    session.ask(Request::Track)?;
    let seconds = (plan.end_time() - plan.start_time()).to_f64();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates")]
    let duration = (seconds * 1e6) as u64;
    session.reach(State::StationKeeping, duration + script.patience)?;
    session.stay(State::StationKeeping, script.after)?;
    session.tally.end_error = session.error_at_end();
    session.ask(Request::Stop)?;
    session.reach(State::LegsDown, script.patience)?;
    Ok(session.outcome())
}

struct Session<'s, 'a, R, T: Stored, S, const N: usize, const NX: usize, const NS: usize> {
    runtime: &'s mut Runtime<'a, R, T, N, NX, NS>,
    robot: &'s R,
    plan: &'s PlanView<'s, T, NX, NS, N>,
    stage: &'s mut S,
    each: &'s mut dyn FnMut(&Cycle<'_, T, N, NX, NS>),
    tally: Tally,
    legs: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    squares: f64,
    largest: f64,
    cycles: u32,
    lean: f64,
    compensation: f64,
    force: f64,
    end_error: f64,
    is_truth: bool,
}

impl<R, T, S, const N: usize, const NX: usize, const NS: usize> Session<'_, '_, R, T, S, N, NX, NS>
where
    R: Robot<T, N, NX, NS>,
    T: Stored,
    S: Stage<N>,
{
    /// Lets the runtime work until a state is reached.
    fn reach(&mut self, wanted: State, patience: u64) -> Result<(), Error> {
        let end = self.stage.now() + patience;
        while self.runtime.master().state() != wanted {
            if self.stage.now() >= end || self.runtime.master().state() == State::FaultDown {
                return Err(self.late(wanted));
            }
            self.step(end)?;
        }
        Ok(())
    }

    /// Lets the runtime work for a while; the state must not change.
    fn stay(&mut self, state: State, micros: u64) -> Result<(), Error> {
        let end = self.stage.now() + micros;
        while self.stage.now() < end {
            self.step(end)?;
            if self.runtime.master().state() != state {
                return Err(self.late(state));
            }
        }
        Ok(())
    }

    fn late(&self, wanted: State) -> Error {
        let master = self.runtime.master();
        let (state, faults) = (master.state(), *master.faults());
        Error::Late { wanted, state, faults, failed_step: master.failed_step() }
    }

    fn ask(&mut self, request: Request) -> Result<(), Error> {
        let now = self.stage.now();
        if self.runtime.request(request, now) {
            Ok(())
        } else {
            Err(Error::Refused(self.runtime.master().state()))
        }
    }

    fn step(&mut self, until: u64) -> Result<(), Error> {
        let before = self.runtime.snapshot().cycle;
        let state = self.runtime.master().state();
        serve(self.runtime, self.stage, until)?;
        let now = self.runtime.master().state();
        if !self.legs && now.permits_torque() != state.permits_torque() {
            self.stage.hold(!now.permits_torque());
        }
        if self.runtime.snapshot().cycle != before {
            self.note();
        }
        Ok(())
    }

    fn note(&mut self) {
        let snapshot = self.runtime.snapshot();
        let (now, truth) = (self.stage.now(), self.stage.truth());
        (self.each)(&Cycle { now, snapshot, truth });
        let tally = &mut self.tally;
        tally.is_truth = truth.is_some();
        let (Some(plan_time), Some(command)) = (snapshot.plan_time, snapshot.command) else {
            return;
        };
        // The plan at the time at which the robot is looked at.
        let (state, age) = match truth {
            Some(truth) => (
                Coordinates { q: truth.q.map(T::from_f64), qd: truth.qd.map(T::from_f64) },
                now.saturating_sub(snapshot.time_us),
            ),
            None => (snapshot.state, 0),
        };
        let planned = self.plan.at(plan_time + T::from_f64(age as f64 * 1e-6));
        let error = distance(self.robot, &state.q, &planned.position[0], &planned.shape[0]);
        tally.squares += error * error;
        tally.largest = tally.largest.max(error);
        tally.cycles += 1;
        let most = |most: f64, x: &T| most.max(x.abs().to_f64());
        for lean in self.runtime.master().table().safety.lean {
            let lean = snapshot.state.q.get(usize::from(*lean));
            tally.lean = lean.iter().fold(tally.lean, |largest, x| most(largest, x));
        }
        tally.compensation = command.compensation.iter().fold(tally.compensation, most);
        tally.force = command.actuator.iter().fold(tally.force, most);
    }

    fn error_at_end(&mut self) -> f64 {
        let end = self.plan.at(self.plan.end_time());
        let q = match self.stage.truth() {
            Some(truth) => truth.q.map(T::from_f64),
            None => self.runtime.snapshot().state.q,
        };
        distance(self.robot, &q, &end.position[0], &end.shape[0])
    }

    fn outcome(&self) -> Outcome {
        let (tally, master) = (&self.tally, self.runtime.master());
        Outcome {
            plan_rmse: (tally.squares / f64::from(tally.cycles.max(1))).sqrt(),
            plan_max: tally.largest,
            end_error: tally.end_error,
            is_truth: tally.is_truth,
            lean_max: tally.lean,
            compensation_max: tally.compensation,
            force_max: tally.force,
            cycles: tally.cycles,
            counters: *master.counters(),
            sync: *master.jitter(),
        }
    }
}

/// Distance of the output at q from the planned one.
fn distance<R, T, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    q: &SVector<T, N>,
    position: &SVector<T, NX>,
    shape: &SVector<T, NS>,
) -> f64
where
    R: Robot<T, N, NX, NS>,
    T: Stored,
{
    let (qx, qs) = R::split(q);
    let apart = robot.output(&qx, &qs) - robot.output(position, shape);
    apart.dot(&apart).to_f64().sqrt()
}
