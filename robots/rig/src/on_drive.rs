//! Robots of any size on their drives.

use crate::{DriveSim, Error, Job, Outcome, Script};
#[cfg(target_os = "linux")]
use crate::{Paced, hold_unless_driven, log_to, network};
use shapebot_bus::Wired;
#[cfg(target_os = "linux")]
use shapebot_drive::Role;
use shapebot_drive_build::DriveDescription;
use shapebot_experiments::{AnyRobot, Driven, Planned, SizedRobot, Subject, circumstances};
#[cfg(target_os = "linux")]
use shapebot_host::{Ending, Socket};
use shapebot_sim::Plant;
use std::io::Write;
use std::sync::{Arc, Mutex};

/// Step of the simulated plant, s.
const PLANT_STEP: f64 = 0.0005;

/// A log that several buses write to.
#[derive(Clone)]
pub struct Log(Arc<Mutex<Box<dyn Write + Send>>>);

impl Log {
    /// Into a writer.
    #[must_use]
    pub fn new(to: Box<dyn Write + Send>) -> Self {
        Self(Arc::new(Mutex::new(to)))
    }
}

impl Write for Log {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().map_err(|_| std::io::ErrorKind::Other)?.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.0.lock().map_err(|_| std::io::ErrorKind::Other)?.flush()
    }
}

/// A planned task of a robot on its drive.
#[derive(Clone, Copy)]
pub struct OnDrive<'a> {
    /// The robot.
    pub robot: &'a AnyRobot,
    /// Its gains, and what takes its place in simulation.
    pub driven: Driven<'a>,
    /// The task with its plan.
    pub planned: Planned<'a>,
    /// Its drive.
    pub drive: &'a DriveDescription,
    /// Lateness that both sides forgive in real time beyond what the drive allows, µs.
    pub slack: u32,
}

/// Runs a method with the robot at its own sizes: those of which a drive has telemetry.
macro_rules! sized {
    ($on:ident.$method:ident($($argument:expr),*)) => {
        match $on.robot {
            AnyRobot::P1S1(robot) => $on.$method(&**robot $(, $argument)*),
            AnyRobot::P1S2(robot) => $on.$method(&**robot $(, $argument)*),
            AnyRobot::P1S3(robot) => $on.$method(&**robot $(, $argument)*),
            AnyRobot::P1S4(robot) => $on.$method(&**robot $(, $argument)*),
            AnyRobot::P2S2(robot) => $on.$method(&**robot $(, $argument)*),
            AnyRobot::P2S4(robot) => $on.$method(&**robot $(, $argument)*),
            AnyRobot::P2S6(robot) => $on.$method(&**robot $(, $argument)*),
            AnyRobot::P3S3(robot) => $on.$method(&**robot $(, $argument)*),
            other => Err(Error::TooLarge { coordinates: other.description().coordinates.len() }),
        }
    };
}

impl OnDrive<'_> {
    /// Through the task over simulated buses in virtual time, from power-up to rest on the legs.
    ///
    /// # Errors
    ///
    /// Parts that do not fit each other; a state that is not reached.
    pub fn simulate(&self, log: Option<Log>) -> Result<Outcome, Error> {
        sized!(self.simulate_sized(log))
    }

    /// Through the task over real buses.
    ///
    /// # Errors
    ///
    /// Those of [`Self::simulate`]; errors of the buses.
    pub fn run(&self, buses: &mut Wired) -> Result<Outcome, Error> {
        sized!(self.run_sized(buses))
    }

    /// As an operator says, over the bus and a socket, until `signals` counts a signal: see
    /// [`Job::attend`]. On these buses, or with simulated nodes in this process.
    ///
    /// # Errors
    ///
    /// Those of [`Self::run`].
    #[cfg(target_os = "linux")]
    pub fn attend(
        &self,
        buses: Option<Wired>,
        log: Option<Log>,
        socket: Socket,
        signals: &mut dyn FnMut(u64) -> usize,
    ) -> Result<Ending, Error> {
        sized!(self.attend_sized(buses, log, socket, signals))
    }

    /// The other side: simulated nodes over a plant on real buses, until `go_on` says no.
    ///
    /// # Errors
    ///
    /// Those of [`Self::run`].
    pub fn serve_nodes(
        &self,
        buses: Wired,
        go_on: &mut dyn FnMut(u64) -> bool,
    ) -> Result<(), Error> {
        sized!(self.serve_nodes_sized(buses, go_on))
    }

    fn job<'r, R>(&'r self, robot: &'r R) -> Job<'r, R> {
        let Planned { motion, id, .. } = self.planned;
        let plan = motion.files.binary.as_slice();
        let (design, description) = (self.driven.design, self.drive);
        let script = Script { slack: self.slack, ..Script::default() };
        Job { robot, id, design, description, plan, script }
    }

    fn subject<'r, const N: usize, const NX: usize, const NS: usize>(
        &'r self,
        model: &'r SizedRobot<N, NX, NS>,
    ) -> Subject<'r, N, NX, NS> {
        Subject { model, design: self.driven.design, plants: self.driven.plants }
    }

    fn simulate_sized<const N: usize, const NX: usize, const NS: usize>(
        &self,
        robot: &SizedRobot<N, NX, NS>,
        log: Option<Log>,
    ) -> Result<Outcome, Error> {
        let (system, scenario) = circumstances(self.subject(robot), self.planned.task)?;
        let plant = Plant::new(&*system, &robot, &scenario, PLANT_STEP)?;
        self.job(&robot).simulate(&plant, log, &mut |_| ())
    }

    fn run_sized<const N: usize, const NX: usize, const NS: usize>(
        &self,
        robot: &SizedRobot<N, NX, NS>,
        buses: &mut Wired,
    ) -> Result<Outcome, Error> {
        self.job(&robot).run(buses, &mut |_| ())
    }

    #[cfg(target_os = "linux")]
    fn attend_sized<const N: usize, const NX: usize, const NS: usize>(
        &self,
        robot: &SizedRobot<N, NX, NS>,
        buses: Option<Wired>,
        log: Option<Log>,
        socket: Socket,
        signals: &mut dyn FnMut(u64) -> usize,
    ) -> Result<Ending, Error> {
        if let Some(buses) = buses {
            return self.job(&robot).attend(buses, Some(socket), signals);
        }
        let (system, scenario) = circumstances(self.subject(robot), self.planned.task)?;
        let plant = Plant::new(&*system, &robot, &scenario, PLANT_STEP)?;
        let mut world = network(self.drive, &robot, &plant, 1)?;
        if let Some(log) = log {
            log_to(&mut world, self.drive, log);
        }
        let legs = self.drive.nodes.iter().any(|node| node.role == Role::Legs);
        let world = Paced::new(world, |world| {
            if !legs {
                hold_unless_driven(world);
            }
        });
        self.job(&robot).attend(world, Some(socket), signals)
    }

    fn serve_nodes_sized<const N: usize, const NX: usize, const NS: usize>(
        &self,
        robot: &SizedRobot<N, NX, NS>,
        buses: Wired,
        go_on: &mut dyn FnMut(u64) -> bool,
    ) -> Result<(), Error> {
        /// Longest time between two looks at `go_on`, µs.
        const TURN: u64 = 20_000;
        let (system, scenario) = circumstances(self.subject(robot), self.planned.task)?;
        let plant = Plant::new(&*system, &robot, &scenario, PLANT_STEP)?;
        let nodes = DriveSim::new(self.drive, &robot, &plant, buses)?;
        let mut nodes = nodes.forgiving(self.slack.into());
        while go_on(nodes.now()) {
            nodes.run(nodes.now() + TURN)?;
        }
        Ok(())
    }
}
