//! The loop.

use crate::plans::Plans;
use crate::{Deadlines, Error, Socket};
use shapebot_bus::{BusError, Buses, Frame};
use shapebot_drive::operator::Operator;
use shapebot_drive::safety::{Request, State};
use shapebot_drive::{Command, Fault, Master, Role};
use shapebot_dynamics::Robot;
use shapebot_runtime::Runtime;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Cycles that are sent after the torque was switched off, whatever the legs say.
const LAST_CYCLES: u32 = 10;

/// How a loop ended; errors of buses aside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// As asked for, on the legs.
    Stopped,
    /// The torque was switched off at once: asked for twice, or the robot did not get down in time.
    AtOnce,
    /// After a panic the torque was switched off.
    Panicked,
}

/// A robot's loop: the runtime on its buses, and who commands it.
#[derive(Debug)]
pub struct Service<'a, R, B, const N: usize, const NX: usize, const NS: usize> {
    runtime: Runtime<'a, R, f64, N, NX, NS>,
    buses: B,
    operator: Operator<'static>,
    plans: Plans<'a>,
    socket: Option<Socket>,
    deadlines: Deadlines,
    /// Frames to send; kept, so that the loop need not allocate.
    frames: Vec<(usize, Frame)>,
    /// When an orderly stop has to be done, µs.
    stop_by: Option<u64>,
}

impl<'a, R, B, const N: usize, const NX: usize, const NS: usize> Service<'a, R, B, N, NX, NS>
where
    R: Robot<f64, N, NX, NS>,
    B: Buses,
{
    /// A loop that has not begun.
    #[must_use]
    pub fn new(
        runtime: Runtime<'a, R, f64, N, NX, NS>,
        buses: B,
        plans: Plans<'a>,
        socket: Option<Socket>,
    ) -> Self {
        let operator = Operator::new(runtime.master().table().fingerprint, Plans::store());
        let frames = Vec::with_capacity(64);
        let deadlines = Deadlines::default();
        Self { runtime, buses, operator, plans, socket, deadlines, frames, stop_by: None }
    }

    /// The runtime.
    #[must_use]
    pub const fn runtime(&self) -> &Runtime<'a, R, f64, N, NX, NS> {
        &self.runtime
    }

    /// The buses.
    pub const fn buses(&mut self) -> &mut B {
        &mut self.buses
    }

    /// Whether the loop keeps its times.
    #[must_use]
    pub const fn deadlines(&self) -> &Deadlines {
        &self.deadlines
    }

    /// Works until `signals` counts a signal and the robot is on its legs: see the crate's page. It is
    /// asked in each turn, with the time in µs, how many signals came.
    ///
    /// # Errors
    ///
    /// The bus that failed; the robot's torque is off then as far as its other buses go.
    pub fn run(&mut self, signals: &mut dyn FnMut(u64) -> usize) -> Result<Ending, Error> {
        let worked = catch_unwind(AssertUnwindSafe(|| self.work(signals)));
        match worked {
            Ok(Ok(ending)) => {
                if ending == Ending::AtOnce {
                    self.switch_off();
                }
                Ok(ending)
            }
            Ok(Err(error)) => {
                self.switch_off();
                Err(error.into())
            }
            Err(_) => {
                self.switch_off();
                Ok(Ending::Panicked)
            }
        }
    }

    fn work(&mut self, signals: &mut dyn FnMut(u64) -> usize) -> Result<Ending, BusError> {
        loop {
            let now = self.buses.now();
            match (signals(now), self.stop_by) {
                (0, _) => {}
                (1, None) => self.stop(now),
                (1, Some(limit)) if now < limit => match self.runtime.master().state() {
                    State::Off | State::LegsDown => return Ok(Ending::Stopped),
                    State::FaultDown => return Ok(Ending::AtOnce),
                    _ => {}
                },
                _ => return Ok(Ending::AtOnce),
            }
            self.turn()?;
        }
    }

    /// Begins an orderly stop.
    fn stop(&mut self, now: u64) {
        let safety = &self.runtime.master().table().safety;
        // To rest, and down: each may take as long as legs may take.
        let patience = 2 * u64::from(safety.lower_timeout_us);
        self.stop_by = Some(now + patience);
        self.runtime.request(Request::Stop, now);
    }

    /// Serves what is due, then waits for a frame or the next thing to do.
    fn turn(&mut self) -> Result<(), BusError> {
        let now = self.buses.now();
        let Self { runtime, frames, .. } = self;
        let before = runtime.snapshot().cycle;
        runtime.poll(now, &mut |bus, frame| frames.push((bus, frame)));
        self.send(now)?;
        let snapshot = self.runtime.snapshot();
        if snapshot.cycle != before {
            let period = u64::from(self.runtime.master().table().timing.period_us);
            self.deadlines.add(snapshot.time_us, now, self.buses.now(), period);
            self.serve_operators(now)?;
        }
        let wake = self.runtime.next_wake().max(now + 1);
        if let Some((bus, received)) = self.buses.receive(wake)? {
            self.runtime.receive(bus, &received.frame, received.time);
            let operator = &self.runtime.master().table().operator;
            let is_command = received.frame.standard_id() == Some(operator.command);
            if is_command && bus == usize::from(operator.bus) {
                let frame = received.frame;
                self.order(frame.bytes(), received.time);
            }
        }
        Ok(())
    }

    /// Sends the frames that wait. A bus that takes none, or errors, are a fault of the drive.
    fn send(&mut self, now: u64) -> Result<(), BusError> {
        if let Some(fault) = self.buses.send_all(self.frames.drain(..))? {
            self.runtime.report(fault, now);
        }
        Ok(())
    }

    /// Once a cycle: commands of the socket, an uploaded plan, telemetry.
    fn serve_operators(&mut self, now: u64) -> Result<(), BusError> {
        if let Some(mut socket) = self.socket.take() {
            socket.serve(&mut |bytes| self.order(bytes, now));
            self.socket = Some(socket);
        }
        let state = self.runtime.master().state();
        if let Some(plan) = self.plans.take(self.operator.plans(), state) {
            // Cannot be busy: plans are not taken while one is followed.
            let _ = self.runtime.load(plan);
        }
        if let Some(page) = self.operator.telemetry(self.runtime.master(), &self.runtime.tuned()) {
            let operator = &self.runtime.master().table().operator;
            self.frames.push((operator.bus.into(), Frame::new(operator.telemetry, &page)));
            if let Some(socket) = &mut self.socket {
                socket.tell(&page);
            }
        }
        self.send(now)
    }

    /// An operator's command.
    fn order(&mut self, bytes: &[u8], now: u64) {
        // Telemetry tells why one is refused; plans are looked for in each cycle.
        let _ = self.operator.receive(bytes, &mut self.runtime, now);
    }

    /// Torque off and legs down, by the master alone: the controller may be what failed. Until the legs
    /// are down or have had their time.
    fn switch_off(&mut self) {
        let now = self.buses.now();
        self.frames.clear();
        let master = self.runtime.master_mut();
        master.report(Fault::Process, now);
        master.request(Request::EmergencyStop, now);
        let end = now + u64::from(master.table().safety.lower_timeout_us);
        let first = master.counters().cycles;
        while self.buses.now() < end {
            let now = self.buses.now();
            let master = self.runtime.master_mut();
            let frames = &mut self.frames;
            let mut out = |bus, frame| frames.push((bus, frame));
            master.poll(now, &mut out);
            if master.inputs_due(now) {
                let _ = master.measure(now);
                master.command(&Command::new(&[]), now, &mut out);
            }
            let told = master.counters().cycles.wrapping_sub(first) >= LAST_CYCLES;
            let done = told && is_down(master);
            let wake = master.next_wake().max(now + 1).min(end);
            // One bus that fails does not keep the others from being told.
            let _ = self.buses.send_all(self.frames.drain(..));
            if done {
                return;
            }
            match self.buses.receive(wake) {
                Ok(Some((bus, received))) => {
                    self.runtime.master_mut().receive(bus, &received.frame, received.time);
                }
                Ok(None) => {}
                // Without waiting the loop would spin.
                Err(_) => std::thread::sleep(std::time::Duration::from_micros(200)),
            }
        }
    }
}

/// Whether the legs are down; a robot without legs has none to wait for.
fn is_down(master: &Master<'_>) -> bool {
    let has_legs = master.table().nodes.iter().any(|node| node.role == Role::Legs);
    !has_legs || master.legs().is_some_and(|legs| legs.is_down())
}
