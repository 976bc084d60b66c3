//! Safety states and the controller, cycle by cycle.

use crate::sensing::Sensing;
use crate::stand::{Balance, Stand, seconds};
use crate::tuning::Tuning;
use crate::{Error, Settings};
use nalgebra::SVector;
use shapebot_control::{Command, Controller, Gains, State, Target};
use shapebot_drive::operator::{Commanded, MAX_GAINS, Tuned};
use shapebot_drive::safety::{Request, State as Safety};
use shapebot_drive::{DriveTable, Fault, Frame, MAX_AXES, Master};
use shapebot_dynamics::Robot;
use shapebot_planner::value::{PlanView, Stored};

/// A robot on its buses: master, controller and reference.
///
/// Pass each received frame to [`Self::receive`], call [`Self::poll`] after that and at
/// [`Self::next_wake`], and send what it gives. Time is microseconds of a clock that does not go
/// backwards.
#[derive(Debug)]
pub struct Runtime<'a, R, T: Stored, const N: usize, const NX: usize, const NS: usize> {
    robot: &'a R,
    master: Master<'a>,
    controller: Controller<'a, R, T, N, NX, NS>,
    tuning: Tuning<T, NX, NS>,
    settings: Settings<T>,
    balance: Balance<T, NX, NS>,
    sensing: Sensing<T, N, NX, NS>,
    plan: Option<PlanView<'a, T, NX, NS, N>>,
    /// The safety state in the cycle before.
    before: Safety,
    stand: Stand<T, NX, NS>,
    /// When the plan was begun, µs.
    tracking_since: u64,
    /// A stop was asked for while the robot moved.
    stopping: bool,
    /// When the operator was last heard, µs; `None` unless the watch is armed.
    operator_heard: Option<u64>,
    snapshot: Snapshot<T, N, NX, NS>,
}

/// What a cycle was about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot<T: Stored, const N: usize, const NX: usize, const NS: usize> {
    /// Number of the cycle, from the master.
    pub cycle: u32,
    /// When it began with SYNC, µs.
    pub time_us: u64,
    /// Safety state in which it was computed.
    pub safety: Safety,
    /// Time of the plan, s, while it is followed.
    pub plan_time: Option<T>,
    /// The robot, as sampled at SYNC.
    pub state: State<T, N>,
    /// What was wanted.
    pub target: Target<T, N, NX, NS>,
    /// What the controller said; `None` where the safety state permits no torque.
    pub command: Option<Command<T, N, NX, NS>>,
}

// Derived, this would ask for a robot that is Clone; only a reference to it is copied.
impl<R, T: Stored, const N: usize, const NX: usize, const NS: usize> Clone
    for Runtime<'_, R, T, N, NX, NS>
{
    fn clone(&self) -> Self {
        Self { master: self.master.clone(), ..*self }
    }
}

impl<'a, R, T, const N: usize, const NX: usize, const NS: usize> Runtime<'a, R, T, N, NX, NS>
where
    R: Robot<T, N, NX, NS>,
    T: Stored,
{
    /// A runtime that has not sent anything yet.
    ///
    /// # Errors
    ///
    /// A drive for another robot or period than the gains', what the controller refuses, settings out of
    /// range.
    pub fn new(
        robot: &'a R,
        table: &'a DriveTable<'a>,
        gains: &Gains<T, NX, NS>,
        settings: &Settings<T>,
    ) -> Result<Self, Error> {
        settings.check()?;
        let found = usize::from(table.coordinates);
        if found != N {
            return Err(Error::Coordinates { found, expected: N });
        }
        let drive_us = table.timing.period_us;
        let difference = gains.period.to_f64() * 1e6 - f64::from(drive_us);
        if !(-0.5..=0.5).contains(&difference) {
            return Err(Error::Period { drive_us });
        }
        let controller = Controller::new(robot, gains)?;
        let balance = Balance {
            body_gain: *controller.body_gain(),
            authority: *controller.authority(),
            servoed: controller.servoed(),
            period: gains.period,
        };
        let (at, shape) = (SVector::from_element(T::zero()), SVector::from_element(T::zero()));
        let rest = SVector::from_element(T::zero());
        let snapshot = Snapshot {
            cycle: 0,
            time_us: 0,
            safety: Safety::Off,
            plan_time: None,
            state: State { q: rest, qd: rest },
            target: Target::stand(at),
            command: None,
        };
        Ok(Self {
            robot,
            master: Master::new(table),
            controller,
            tuning: Tuning::new(gains),
            settings: *settings,
            balance,
            sensing: Sensing::new(robot, gains.period, settings.rate_bandwidth),
            plan: None,
            before: Safety::Off,
            stand: Stand::still(at, shape, 0),
            tracking_since: 0,
            stopping: false,
            operator_heard: None,
            snapshot,
        })
    }

    /// The drive's master.
    #[must_use]
    pub const fn master(&self) -> &Master<'a> {
        &self.master
    }

    /// The drive's master, for an operator's commands. Requests rather go to [`Self::request`].
    pub const fn master_mut(&mut self) -> &mut Master<'a> {
        &mut self.master
    }

    /// What an operator set.
    #[must_use]
    pub fn tuned(&self) -> Tuned {
        Tuned { factors: self.tuning.factors(), watch: self.operator_heard.is_some() }
    }

    /// The last cycle.
    #[must_use]
    pub const fn snapshot(&self) -> &Snapshot<T, N, NX, NS> {
        &self.snapshot
    }

    /// Takes a plan to be followed at the next [`Request::Track`].
    ///
    /// # Errors
    ///
    /// [`Error::Busy`] while a plan is being followed.
    pub fn load(&mut self, plan: PlanView<'a, T, NX, NS, N>) -> Result<(), Error> {
        if self.master.state() == Safety::Tracking {
            return Err(Error::Busy);
        }
        self.plan = Some(plan);
        Ok(())
    }

    /// Takes a frame that was received on a bus.
    pub fn receive(&mut self, bus: usize, frame: &Frame, now: u64) {
        self.master.receive(bus, frame, now);
    }

    /// Sends what is due; runs the controller when the inputs of a cycle are there.
    pub fn poll(&mut self, now: u64, out: &mut dyn FnMut(usize, Frame)) {
        self.master.poll(now, out);
        if self.master.inputs_due(now) {
            self.master.measure(now);
            let command = self.cycle(now);
            self.master.command(&command, now, out);
        }
    }

    /// When [`Self::poll`] has something to do at the latest, µs.
    #[must_use]
    pub fn next_wake(&self) -> u64 {
        self.master.next_wake()
    }

    /// Asks for something: see [`Master::request`]. A stop while the robot moves brings it to rest
    /// first, legs up; an emergency stop does not wait.
    pub fn request(&mut self, request: Request, now: u64) -> bool {
        self.stopping = false;
        let moves = match self.master.state() {
            Safety::Tracking => true,
            Safety::StationKeeping => !self.stand.is_over(now),
            _ => false,
        };
        if request == Request::Stop && moves {
            self.stopping = true;
            self.master.request(Request::KeepStation, now);
            return true;
        }
        self.master.request(request, now)
    }

    /// Reports a fault that the master cannot see: see [`Master::report`].
    pub fn report(&mut self, fault: Fault, now: u64) {
        self.master.report(fault, now);
    }

    /// Once a cycle: whether the operator is still there.
    fn watch_operator(&mut self, now: u64) {
        let Some(heard) = self.operator_heard else { return };
        let silent = now.saturating_sub(heard) > self.settings.operator_timeout_us;
        if silent && self.master.state().permits_torque() {
            self.operator_heard = None;
            self.master.report(Fault::OperatorSilent, now);
        }
    }

    /// From a measurement to forces.
    fn cycle(&mut self, now: u64) -> shapebot_drive::Command {
        self.watch_operator(now);
        let safety = self.master.state();
        let stands = safety == Safety::Rising || !safety.permits_torque();
        if safety == Safety::Rising && self.before != Safety::Rising {
            self.sensing.home(self.master.measurement());
        }
        let measurement = self.master.measurement();
        let (time, cycle) = (measurement.time_us, measurement.cycle);
        let state = self.sensing.step::<R>(measurement, &self.snapshot.target, !stands);
        if safety != self.before {
            self.enter(safety, &state, time);
            self.before = safety;
        }
        let (target, plan_time) = self.wanted(safety, &state, time);
        if stands {
            // Legs may still hold the robot: nothing is to wind up against them.
            self.controller.reset();
        }
        let command = safety.permits_torque().then(|| self.controller.step(&state, &target));
        if command.is_some_and(|command| command.fault) {
            self.master.report(Fault::NotFinite, now);
        }
        self.snapshot =
            Snapshot { cycle, time_us: time, safety, plan_time, state, target, command };
        self.follow_up(safety, plan_time, time, now);
        let mut forces = [0.0; MAX_AXES];
        if let Some(command) = command {
            for (to, force) in forces.iter_mut().zip(&command.actuator) {
                *to = force.to_f32();
            }
        }
        shapebot_drive::Command::from_forces(forces)
    }

    /// What is wanted now, and the time of the plan.
    fn wanted(
        &mut self,
        safety: Safety,
        state: &State<T, N>,
        time: u64,
    ) -> (Target<T, N, NX, NS>, Option<T>) {
        if let (Safety::Tracking, Some(plan)) = (safety, &self.plan) {
            let elapsed = seconds::<T>(time.saturating_sub(self.tracking_since));
            let at = plan.start_time() + elapsed;
            // Torque is held for a period. That it acts a period later is a disturbance to the
            // controller, which makes up for it.
            let ahead = T::from_f64(0.5) * self.balance.period;
            let (position, shape) = plan.motion_at(at);
            // A plan's forces are those without friction, which changes little in half a period.
            let q = R::join(&position[0], &shape[0]);
            let qd = R::join(&(position[1] + position[2] * ahead), &(shape[1] + shape[2] * ahead));
            let force = plan.force_at(at + ahead) - self.robot.dissipative_force(&q, &qd);
            return (Target { position, shape, force }, Some(at));
        }
        let mut target = self.stand.step(self.robot, &self.balance, &self.settings, time);
        if safety == Safety::Balancing {
            target.position[0] = self.here(state, &target.shape[0]);
        }
        (target, None)
    }

    /// The position whose output, with a shape, is the robot's.
    fn here(&self, state: &State<T, N>, shape: &SVector<T, NS>) -> SVector<T, NX> {
        let (qx, qs) = R::split(&state.q);
        qx + self.controller.output_shape() * (qs - shape)
    }

    /// The safety state has changed: the reference goes on from what was wanted, or from where the robot
    /// is if nothing was.
    fn enter(&mut self, safety: Safety, state: &State<T, N>, time: u64) {
        let still = |position, shape| Stand::still(position, shape, time);
        let zero = SVector::from_element(T::zero());
        let target = self.snapshot.target;
        match (self.before, safety) {
            (_, Safety::Tracking) => self.tracking_since = time,
            (_, Safety::Rising) => {
                let (qx, qs) = R::split(&state.q);
                let joints = qs.component_mul(&self.balance.servoed);
                self.stand = still(qx, joints);
            }
            (Safety::Tracking, next) if next.permits_torque() => {
                self.stand = self.stop(target.position, target.shape, None, time);
            }
            (Safety::Balancing, next) if next.permits_torque() => {
                let at = self.here(state, &target.shape[0]);
                let (rates, shape_rates) = R::split(&state.qd);
                let speed = rates + self.controller.output_shape() * shape_rates;
                let goal = self.home_near(&at).filter(|_| next == Safety::StationKeeping);
                let shape = [target.shape[0], zero_shape(), zero_shape()];
                self.stand = self.stop([at, speed, zero], shape, goal, time);
            }
            _ => {}
        }
    }

    fn stop(
        &self,
        position: [SVector<T, NX>; 3],
        shape: [SVector<T, NS>; 3],
        goal: Option<SVector<T, NX>>,
        time: u64,
    ) -> Stand<T, NX, NS> {
        Stand::from_motion(position, shape, goal, &self.balance, &self.settings, time)
    }

    /// Where a plan begins, or where the robot rose, if that is near.
    fn home_near(&self, at: &SVector<T, NX>) -> Option<SVector<T, NX>> {
        let start = self.plan.map(|plan| plan.at(plan.start_time()).position[0]);
        let home = start.unwrap_or(SVector::from_element(T::zero()));
        self.is_near(at, &home).then_some(home)
    }

    fn is_near(&self, a: &SVector<T, NX>, b: &SVector<T, NX>) -> bool {
        let apart = self.robot.output_jacobian_position() * (a - b);
        apart.dot(&apart) <= self.settings.start_position * self.settings.start_position
    }

    /// Whether a plan begins where the robot stands.
    fn is_plan_ready(&self, time: u64) -> bool {
        let Some(plan) = &self.plan else { return false };
        let first = plan.at(plan.start_time());
        let target = &self.snapshot.target;
        let joints = (first.shape[0] - target.shape[0]).component_mul(&self.balance.servoed);
        let limit = self.settings.start_shape;
        let measured = self.here(&self.snapshot.state, &target.shape[0]);
        self.stand.is_over(time)
            && self.is_near(self.stand.goal(), &first.position[0])
            && self.is_near(&measured, &first.position[0])
            && joints.iter().all(|joint| joint.abs() <= limit)
    }

    /// Tells the master about plans, and asks for what was put off.
    fn follow_up(&mut self, safety: Safety, plan_time: Option<T>, time: u64, now: u64) {
        let finished = match (plan_time, &self.plan) {
            (Some(at), Some(plan)) => at >= plan.end_time(),
            _ => false,
        };
        let standing = safety == Safety::StationKeeping;
        self.master.plan(standing && self.is_plan_ready(time), finished);
        if self.stopping && standing && self.stand.is_over(time) {
            self.stopping = false;
            self.master.request(Request::Stop, now);
        }
        if !safety.permits_torque() {
            self.stopping = false;
        }
    }
}

impl<R, T, const N: usize, const NX: usize, const NS: usize> Commanded
    for Runtime<'_, R, T, N, NX, NS>
where
    R: Robot<T, N, NX, NS>,
    T: Stored,
{
    fn request(&mut self, request: Request, now: u64) -> bool {
        Runtime::request(self, request, now)
    }

    fn aim(&mut self, heading: f32) {
        self.master.aim(heading);
    }

    /// From the next cycle on: see [`TUNABLE`](crate::TUNABLE).
    fn set_gain(&mut self, index: u8, value: f32) -> bool {
        let tuned = self.tuning.with(index, value);
        tuned.is_some_and(|tuned| {
            let taken = self.controller.set_gains(tuned.gains()).is_ok();
            if taken {
                self.tuning = tuned;
            }
            taken
        })
    }

    fn watch(&mut self, on: bool, now: u64) {
        self.operator_heard = on.then_some(now);
    }

    fn heard(&mut self, now: u64) {
        if let Some(heard) = &mut self.operator_heard {
            *heard = now;
        }
    }
}

const _: () = assert!(crate::TUNABLE.len() == MAX_GAINS);

fn zero_shape<T: Stored, const NS: usize>() -> SVector<T, NS> {
    SVector::from_element(T::zero())
}
