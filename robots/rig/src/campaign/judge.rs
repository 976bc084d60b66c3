//! A fault injected, and how it went.

use crate::campaign::{Case, Checkpoint, Expect, Injection, Subject, Verdict, Violation, balances};
use crate::{Error, World, network, serve};
use shapebot_bus::{Buses as _, Effect, Select};
use shapebot_drive::legs::{COMMAND, LegsCommand};
use shapebot_drive::safety::{Request, State};
use shapebot_drive::{FaultRecord, Role};
use shapebot_dynamics::Robot;
use shapebot_nodes::{NodeFault, PowerState};
use shapebot_runtime::Runtime;

/// Cycles within which a fault has to be noticed, and what the controller's turn may take of the next.
const CYCLES: f64 = 5.5;
/// How far a tolerated fault may lead the lean astray, rad.
const ASTRAY: f64 = 0.035;
/// How long a run goes on if nothing is noticed, µs.
const QUIET: u64 = 600_000;
/// The longest run, µs.
const LONGEST: u64 = 3_500_000;
/// How long a run goes on with the robot down, µs: legs have come down, and what an operator asks for is
/// refused.
const DOWN: u64 = 450_000;

/// Lets a copy of a checkpoint run on with a fault, injected `phase` microseconds later.
///
/// # Errors
///
/// Errors of the buses, which buses in virtual time have none of.
pub fn inject<R, const N: usize, const NX: usize, const NS: usize>(
    subject: &Subject<'_, R, N, NX, NS>,
    checkpoint: &Checkpoint<'_, R, N, NX, NS>,
    case: &Case,
    phase: u64,
) -> Result<Verdict, Error>
where
    R: Robot<f64, N, NX, NS>,
{
    let runtime = checkpoint.runtime.clone();
    let world = match case.injection {
        Injection::Swapped(a, b) => {
            let mut other = subject.description.clone();
            let ids = [a, b].map(|index| other.simulated.get(index).map(|node| node.id));
            for (index, id) in [(a, ids[1]), (b, ids[0])] {
                if let (Some(node), Some(id)) = (other.simulated.get_mut(index), id) {
                    node.id = id;
                }
            }
            network(&other, subject.robot, subject.plant, 1)?
        }
        _ => checkpoint.world.clone(),
    };
    let mut trial = Trial::new(subject, case, runtime, world);
    trial.run(phase)?;
    Ok(trial.verdict(checkpoint))
}

struct Trial<'t, 'a, R, const N: usize, const NX: usize, const NS: usize> {
    subject: &'t Subject<'a, R, N, NX, NS>,
    case: &'t Case,
    runtime: Runtime<'t, R, f64, N, NX, NS>,
    world: World<'t, R, N, NX, NS>,
    state: State,
    injected: u64,
    /// First SYNC after the injection, µs.
    effect: Option<u64>,
    noticed: Option<(FaultRecord, u64)>,
    /// End of the last state that permits torque, and of the last that retracts legs, µs.
    torque_until: Option<u64>,
    legs_until: Option<u64>,
    legs_told: Option<u64>,
    down_since: Option<u64>,
    asked: usize,
    astray: f64,
    cycle: u32,
    violations: Vec<Violation>,
}

impl<'t, 'a, R, const N: usize, const NX: usize, const NS: usize> Trial<'t, 'a, R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
{
    fn new(
        subject: &'t Subject<'a, R, N, NX, NS>,
        case: &'t Case,
        runtime: Runtime<'t, R, f64, N, NX, NS>,
        world: World<'t, R, N, NX, NS>,
    ) -> Self {
        let state = runtime.master().state();
        Self {
            subject,
            case,
            runtime,
            world,
            state,
            injected: 0,
            effect: None,
            noticed: None,
            torque_until: None,
            legs_until: None,
            legs_told: None,
            down_since: None,
            asked: 0,
            astray: 0.0,
            cycle: 0,
            violations: Vec::new(),
        }
    }

    fn run(&mut self, phase: u64) -> Result<(), Error> {
        let start = self.world.now() + phase;
        while self.world.now() < start {
            serve(&mut self.runtime, &mut self.world, start)?;
        }
        self.injected = self.world.now();
        self.state = self.runtime.master().state();
        self.cycle = self.runtime.master().counters().cycles;
        if self.state == State::FaultDown {
            self.down_since = Some(self.injected);
        }
        self.world.plant_now().mechanism_mut().watch_lean();
        let had = self.runtime.master().faults().first();
        self.strike()?;
        while !self.is_over() {
            let end = self.world.now() + 1000;
            let before = self.runtime.master().state();
            serve(&mut self.runtime, &mut self.world, end)?;
            self.watch(before, had);
            self.ask();
        }
        Ok(())
    }

    fn since(&self) -> u64 {
        self.world.now() - self.injected
    }

    fn is_over(&self) -> bool {
        let since = self.since();
        let blocked = matches!(self.case.expect, Expect::Blocked)
            || matches!(self.case.injection, Injection::Swapped(..));
        let quiet = match self.case.expect {
            _ if blocked => 2_500_000,
            Expect::Within(micros) => QUIET.max(micros + 50_000),
            _ => QUIET,
        };
        match self.down_since {
            _ if since >= LONGEST => true,
            Some(down) => self.world.now() >= down + DOWN,
            None => since >= quiet && (self.noticed.is_none() || !balances(self.state_now())),
        }
    }

    fn state_now(&self) -> State {
        self.runtime.master().state()
    }

    fn strike(&mut self) -> Result<(), Error> {
        let (now, period) = (self.injected, u64::from(self.subject.table.timing.period_us));
        match &self.case.injection {
            Injection::Node(index, fault) => self.world.inject(*index, *fault),
            Injection::AfterReset(index, fault) => {
                self.world.inject(*index, *fault);
                self.world.inject(*index, NodeFault::Reset);
            }
            Injection::Wire { bus, ids, from, to, cycles, probability, effect } => {
                let from = from.and_then(|node| self.world.endpoint(node)).map(|(_, at)| at);
                let receives = matches!(
                    effect,
                    Effect::Drop | Effect::Delay(_) | Effect::Reorder | Effect::Alter(_)
                );
                let master = self.world.master(*bus).filter(|_| from.is_some() && receives);
                let to = to.and_then(|node| self.world.endpoint(node)).map(|(_, at)| at).or(master);
                // All frames of a cycle, however late: not a cycle more.
                let lasts = |cycles| now + u64::from(cycles) * period - period / 2;
                let until = cycles.map_or(u64::MAX, lasts);
                let select = Select {
                    ids: ids.clone(),
                    from,
                    to,
                    after: now,
                    until,
                    probability: *probability,
                    ..Select::default()
                };
                let effect = effect.clone();
                if let Some(wire) = self.world.bus(*bus) {
                    wire.inject(select, effect);
                }
            }
            Injection::BusOff { bus, node } => {
                let at = match node {
                    Some(node) => self.world.endpoint(*node).map(|(_, at)| at),
                    None => self.world.master(*bus),
                };
                if let (Some(at), Some(wire)) = (at, self.world.bus(*bus)) {
                    wire.force_bus_off(at)?;
                }
            }
            Injection::Stall(micros) => {
                let end = now + micros;
                let mut late = Vec::new();
                while let Some(received) = self.world.receive(end) {
                    late.push(received);
                }
                for (bus, received) in late {
                    self.runtime.receive(bus, &received.frame, end);
                }
            }
            Injection::EmergencyStop => {
                self.runtime.request(Request::EmergencyStop, now);
            }
            Injection::Spoof(bus, frames) => {
                if let Some(wire) = self.world.bus(*bus) {
                    let stranger = wire.attach("stranger");
                    for frame in frames {
                        wire.send(stranger, *frame)?;
                    }
                }
            }
            Injection::Swapped(..) => {}
        }
        // What the injection itself changed.
        self.watch(self.state, None);
        Ok(())
    }

    /// What must hold at any time.
    fn watch(&mut self, before: State, had: Option<FaultRecord>) {
        let now = self.world.now();
        let master = self.runtime.master();
        let state = master.state();
        let commanded =
            (0..self.subject.table.axes.len()).any(|axis| master.torque_counts(axis) != 0);
        if self.effect.is_none() && master.counters().cycles > self.cycle {
            self.effect = Some(now);
        }
        if self.noticed.is_none() && master.faults().first() != had {
            self.noticed = master.faults().first().map(|record| (record, record.at_us));
        }
        if before.permits_torque() && !state.permits_torque() {
            self.torque_until = Some(now);
        }
        if before.retracts_legs() && !state.retracts_legs() {
            self.legs_until = Some(now);
        }
        if state == State::FaultDown && self.down_since.is_none() {
            self.down_since = Some(now);
        }
        if self.down_since.is_some() && state != State::FaultDown {
            self.report(Violation::Enabled(state));
        }
        if commanded && !state.permits_torque() {
            self.report(Violation::Commanded { state, at: self.since() });
        }
        if self.case.expect == Expect::Blocked && (balances(state) || state == State::Enabling) {
            self.report(Violation::NotBlocked(state));
        }
        self.watch_motors(state);
        self.watch_legs();
        self.watch_lean();
    }

    fn watch_motors(&mut self, state: State) {
        let (now, timing) = (self.world.now(), self.subject.table.timing);
        let period = u64::from(timing.period_us);
        let grace = match self.case.reaches_drives {
            true => 2 * period + 500,
            // The drive's own deadline for commands, or its heartbeat consumer.
            false => 250_000,
        };
        let mut motor = 0;
        for index in 0..self.subject.table.nodes.len() {
            let node = self.subject.table.nodes.get(index);
            let Some(drive) = node.and_then(|node| node.motor) else { continue };
            let torque = self.world.plant().torque(motor);
            let limit = f64::from(drive.torque_per_count) * f64::from(drive.torque_limit);
            if torque.abs() > limit * (1.0 + 1e-5) || torque.is_nan() {
                self.report(Violation::Torque { motor, torque, limit, at: self.since() });
            }
            let power = self.world.node(index).and_then(|node| node.power_state());
            if torque != 0.0 {
                if let Some(power) = power.filter(|power| *power != PowerState::OperationEnabled) {
                    self.report(Violation::NotEnabled { motor, state: power, at: self.since() });
                }
                let ended = self.torque_until.filter(|_| !state.permits_torque());
                let after = ended.map_or(0, |ended| now - ended);
                if after > grace {
                    self.report(Violation::TorqueRemains { motor, after });
                }
            }
            motor += 1;
        }
    }

    fn watch_legs(&mut self) {
        let Some(ended) = self.legs_until.filter(|_| self.legs_told.is_none()) else { return };
        let legs = self.subject.table.nodes.iter().position(|node| node.role == Role::Legs);
        let command = legs
            .and_then(|index| self.world.node(index))
            .map(|node| node.dictionary().get(COMMAND));
        if command == Some(LegsCommand::Lower as i64) {
            self.legs_told = Some(self.world.now() - ended);
        }
    }

    /// The lean beside what is wanted, once a cycle.
    fn watch_lean(&mut self) {
        let snapshot = self.runtime.snapshot();
        if snapshot.command.is_none() {
            return;
        }
        let state = self.world.plant().mechanism().state();
        for lean in self.subject.table.safety.lean {
            let at = usize::from(*lean);
            let truth = state.q.get(at).copied().unwrap_or(0.0);
            let wanted = at.checked_sub(NX).and_then(|at| snapshot.target.shape[0].get(at));
            self.astray = self.astray.max((truth - wanted.copied().unwrap_or(0.0)).abs());
        }
    }

    fn report(&mut self, violation: Violation) {
        let same = |other: &&Violation| {
            std::mem::discriminant(*other) == std::mem::discriminant(&violation)
        };
        // One of each kind says enough.
        if self.violations.iter().find(same).is_none() {
            self.violations.push(violation);
        }
    }

    /// An impatient operator, who resets nothing.
    fn ask(&mut self) {
        const ASKED: [Request; 5] =
            [Request::Start, Request::KeepStation, Request::Track, Request::Balance, Request::Yaw];
        let now = self.world.now();
        let due = match self.down_since {
            Some(down) => now >= down + 40_000 * (self.asked as u64 + 1),
            None => {
                let waits = matches!(self.state_now(), State::LegsDown);
                waits && self.since() >= 40_000 * (self.asked as u64 + 1)
            }
        };
        if due {
            let request = ASKED.get(self.asked % ASKED.len()).copied();
            let request = match self.down_since {
                Some(_) => request,
                None => Some(Request::Start),
            };
            self.asked += 1;
            if let Some(request) = request {
                self.runtime.request(request, now);
            }
        }
    }

    fn verdict(mut self, checkpoint: &Checkpoint<'_, R, N, NX, NS>) -> Verdict {
        let period = f64::from(self.subject.table.timing.period_us);
        let cycles = self.noticed.map(|(_, at)| {
            let effect = self.effect.unwrap_or(self.injected);
            at.saturating_sub(effect) as f64 / period
        });
        self.judge_notice(cycles);
        self.judge_legs();
        Verdict {
            checkpoint: checkpoint.name.clone(),
            case: self.case.name.clone(),
            state: self.state,
            expect: self.case.expect,
            noticed: self.noticed.map(|(record, _)| record),
            cycles: cycles.filter(|_| balances(self.state)),
            legs_us: self.legs_told.filter(|_| self.case.reaches_legs),
            touchdown: self
                .world
                .plant()
                .mechanism()
                .touchdown()
                .filter(|_| self.noticed.is_some()),
            end: self.state_now(),
            violations: self.violations,
        }
    }

    fn judge_notice(&mut self, cycles: Option<f64>) {
        // Where the robot lowers its legs after a fault already, nothing new has to be said.
        if !balances(self.state) || self.state == State::FaultLowering {
            return;
        }
        match (self.case.expect, self.noticed, cycles) {
            // A stop that was under way may have ended before.
            (Expect::Cycles | Expect::Within(_), None, _)
                if self.down_since.is_none() && self.state != State::LegsLowering =>
            {
                self.report(Violation::NotNoticed);
            }
            (Expect::Cycles, _, Some(cycles)) if cycles > CYCLES => {
                self.report(Violation::Late { cycles });
            }
            (Expect::Within(micros), Some((_, at)), _) if at > self.injected + micros => {
                let period = f64::from(self.subject.table.timing.period_us);
                self.report(Violation::Late { cycles: (at - self.injected) as f64 / period });
            }
            (Expect::Tolerated, Some((record, _)), _) => {
                self.report(Violation::NotTolerated(record.fault));
            }
            (Expect::Tolerated, None, _) if self.astray > ASTRAY => {
                self.report(Violation::Lean(self.astray));
            }
            _ => {}
        }
    }

    fn judge_legs(&mut self) {
        let exists = self.subject.table.nodes.iter().any(|node| node.role == Role::Legs);
        if self.legs_until.is_none() || !exists || !self.case.reaches_legs {
            return;
        }
        // A cycle, and the frame's own time among others.
        let most = u64::from(self.subject.table.timing.period_us) + 500;
        if self.legs_told.is_none_or(|after| after > most) {
            self.report(Violation::Legs { after: self.legs_told });
        }
    }
}
