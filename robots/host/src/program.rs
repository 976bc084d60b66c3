//! A robot's program.

use crate::plans::Plans;
use crate::{Ending, Error, HELP, Options, Service, Socket, ports, rights};
use shapebot_bus::Wired;
use shapebot_control::Gains;
use shapebot_drive::DriveTable;
use shapebot_dynamics::Robot;
use shapebot_dynamics::control::ControlDesign;
use shapebot_planner::value::{PlanView, RobotId};
use shapebot_runtime::{Runtime, Settings};
use signal_hook::consts::{SIGINT, SIGTERM};
use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What makes a program one for a robot.
#[derive(Clone, Copy, Debug)]
pub struct Robotics<'a, R> {
    /// Its dynamics.
    pub robot: &'a R,
    /// Its gains.
    pub control: &'a ControlDesign,
    /// Its drive.
    pub drive: &'a DriveTable<'a>,
    /// The plan that it has unless the command line names another one.
    pub plan: Option<&'static [u8]>,
}

/// Reads the command line, runs the loop and says on standard error what happened.
pub fn main<R, const N: usize, const NX: usize, const NS: usize>(
    robotics: Robotics<'_, R>,
) -> ExitCode
where
    R: Robot<f64, N, NX, NS>,
{
    let options = match Options::parse(std::env::args().skip(1)) {
        Ok(Some(options)) => options,
        Ok(None) => {
            let _ = writeln!(io::stdout(), "{}: {HELP}", robotics.drive.name);
            return ExitCode::SUCCESS;
        }
        Err(error) => return failed(&error),
    };
    match run(robotics, &options) {
        Ok(Ending::Stopped) => ExitCode::SUCCESS,
        Ok(Ending::AtOnce | Ending::Panicked) => ExitCode::from(1),
        Err(error) => failed(&error),
    }
}

fn say(text: &str) {
    // Nowhere to complain if standard error is closed.
    let _ = writeln!(io::stderr(), "{text}");
}

fn failed(error: &Error) -> ExitCode {
    say(&format!("error: {error}"));
    ExitCode::from(if matches!(error, Error::Usage(_)) { 2 } else { 1 })
}

fn run<R, const N: usize, const NX: usize, const NS: usize>(
    robotics: Robotics<'_, R>,
    options: &Options,
) -> Result<Ending, Error>
where
    R: Robot<f64, N, NX, NS>,
{
    let Robotics { robot, control, drive, plan } = robotics;
    let mut signals = signals()?;
    let mut gains = Gains::from_design(robot, control)?;
    gains.period = f64::from(drive.timing.period_us) * 1e-6;
    let mut runtime = Runtime::new(robot, drive, &gains, &Settings::default())?;
    let id = RobotId::of(robot.description());
    let mut plans = Plans::new(id);
    match (&options.plan, plan) {
        (Some(path), _) => runtime.load(plans.read(path)?)?,
        (None, Some(bytes)) => runtime.load(PlanView::open(bytes, &id)?)?,
        (None, None) => {}
    }
    let socket = options.socket.as_deref().map(Socket::bind).transpose()?;
    let ports = ports::open(drive, options)?;
    let mut service = Service::new(runtime, ports, plans, socket);
    if let Some(priority) = options.priority {
        rights::ask(priority).iter().for_each(|missing| say(&missing.to_string()));
    }
    let ending = service.run(&mut |_| signals());
    report(&service, ending.as_ref().ok());
    ending
}

/// Watches for SIGTERM and SIGINT from now on; gives what counts them.
///
/// # Errors
///
/// [`Error::Io`].
pub fn signals() -> Result<impl FnMut() -> usize, Error> {
    let flag = Arc::new(AtomicBool::new(false));
    for signal in [SIGTERM, SIGINT] {
        let watched = signal_hook::flag::register(signal, Arc::clone(&flag));
        watched.map_err(|source| Error::Io { place: "signals".to_owned(), source })?;
    }
    let mut count = 0;
    Ok(move || {
        count += usize::from(flag.swap(false, Ordering::Relaxed));
        count
    })
}

fn report<R, const N: usize, const NX: usize, const NS: usize>(
    service: &Service<'_, R, Wired, N, NX, NS>,
    ending: Option<&Ending>,
) where
    R: Robot<f64, N, NX, NS>,
{
    let how = match ending {
        Some(Ending::Stopped) => "stopped",
        Some(Ending::AtOnce) => "switched off at once",
        Some(Ending::Panicked) => "switched off after a panic",
        None => "switched off: a bus failed",
    };
    let master = service.runtime().master();
    say(&format!("{how} in state {:?}", master.state()));
    say(&format!(
        "{}; SYNC late by at most {} us",
        service.deadlines(),
        master.jitter().worst_us()
    ));
    if let Some(fault) = master.faults().first() {
        let node = fault.node.and_then(|node| master.table().nodes.get(usize::from(node)));
        let node = node.map_or("no node", |node| node.name);
        say(&format!("first fault: {:?} ({node})", fault.fault));
    }
    if let Some((node, step)) = master.failed_step() {
        let name = master.table().nodes.get(usize::from(node)).map_or("", |node| node.name);
        say(&format!("set-up of `{name}` failed at step {step} of its list in can/setup.txt"));
    }
}
