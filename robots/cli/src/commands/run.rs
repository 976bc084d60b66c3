//! `shapebot run` and `shapebot drive-sim`: a planned task over the frames of a drive.

use super::plan::{NamedTask, open_task};
use super::simulate::override_task;
use crate::args::{DriveSimArgs, OnDriveArgs, RunArgs};
use crate::drive::{self, Drive};
use crate::failure::{Failure, Outcome};
use crate::output::number;
use crate::robot::{Dynamics, identity};
use shapebot_drive::Jitter;
use shapebot_drive_build::DriveDescription;
use shapebot_experiments::Planned;
#[cfg(target_os = "linux")]
use shapebot_host::{Ending, Socket, signals};
use shapebot_rig::{BusList, Error, Log, OnDrive, Outcome as Followed};
use std::io::{BufWriter, Write};
use std::path::Path;

/// What a task on a drive is made of.
struct Opened {
    task: shapebot_tasks::Task,
    drive: Drive,
    robot: Box<dyn Dynamics>,
    log: Option<Log>,
    /// µs.
    slack: u32,
}

fn opened(args: &OnDriveArgs) -> Outcome<Opened> {
    let NamedTask { robot: source, mut task, .. } = open_task(&args.task)?;
    override_task(&mut task, args.method, &args.set)?;
    let robot = source.dynamics(&[])?;
    let name = args.drive.clone().unwrap_or_else(|| task.robot.value.clone());
    let drive = drive::open(&name, Some(&robot_name(&args.task, &task)))?;
    let log = match &args.log {
        Some(path) => {
            let file = std::fs::File::create(path).map_err(|e| Failure::file("write", path, &e))?;
            Some(Log::new(Box::new(BufWriter::new(file))))
        }
        None => None,
    };
    Ok(Opened { task, drive, robot, log, slack: 1000 * args.slack })
}

/// The task's robot as the tool opens it: a model file stands relative to the task.
fn robot_name(place: &str, task: &shapebot_tasks::Task) -> String {
    let named = &task.robot.value;
    if !named.ends_with(".robot") {
        return named.clone();
    }
    let folder = Path::new(place).parent().unwrap_or(Path::new(""));
    folder.join(named).display().to_string()
}

impl Opened {
    fn with<T>(&self, then: impl FnOnce(&OnDrive<'_>) -> Outcome<T>) -> Outcome<T> {
        let id = identity(self.robot.description(), &[]);
        let motion = self.robot.plan(&self.task, &id)?;
        then(&OnDrive {
            robot: self.robot.robot()?,
            driven: self.robot.driven()?,
            planned: Planned { task: &self.task, motion: &motion, id: &id },
            drive: &self.drive.description,
            slack: self.slack,
        })
    }
}

/// The buses as they were named, at the pace that was asked for.
fn named_buses(text: &str, on: &OnDriveArgs, drive: &DriveDescription) -> Outcome<BusList> {
    let buses = BusList::parse(text, drive).map_err(failure)?;
    buses.slowed(on.slow).map_err(failure)
}

/// Asks for what a loop in real time needs, and says what is not granted.
#[cfg(target_os = "linux")]
fn ask_for_rights(on: &OnDriveArgs) {
    if on.ordinary {
        return;
    }
    for missing in shapebot_host::rights::ask(on.priority) {
        // Nowhere to complain if standard error is closed.
        let _ = writeln!(anstream::stderr().lock(), "{missing}");
    }
}

#[cfg(not(target_os = "linux"))]
const fn ask_for_rights(_: &OnDriveArgs) {}

pub(crate) fn run(args: &RunArgs) -> Outcome {
    let opened = opened(&args.on)?;
    let description = &opened.drive.description;
    let buses = named_buses(&args.bus, &args.on, description)?;
    let log = opened.log.clone();
    opened.with(|on| {
        if !buses.is_virtual() {
            ask_for_rights(&args.on);
        }
        if let Some(path) = &args.operator {
            return attend(on, &buses, log, path, args.time);
        }
        let followed = if buses.is_virtual() {
            on.simulate(log)
        } else {
            let mut wired = buses.open(description, log.as_ref()).map_err(failure)?;
            on.run(&mut wired)
        };
        report(&followed.map_err(failure)?, description.title.as_str(), on)
    })
}

/// Serves an operator until a signal or for so many seconds.
#[cfg(target_os = "linux")]
fn attend(
    on: &OnDrive<'_>,
    buses: &BusList,
    log: Option<Log>,
    path: &Path,
    time: Option<f64>,
) -> Outcome {
    let wired = match buses.is_virtual() {
        true => None,
        false => Some(buses.open(on.drive, log.as_ref()).map_err(failure)?),
    };
    let socket = Socket::bind(path).map_err(Failure::usage)?;
    let mut signals = signals().map_err(Failure::usage)?;
    writeln!(anstream::stdout().lock(), "listening at {}", path.display())?;
    let mut goes_on = until(time);
    let ending = on.attend(wired, log, socket, &mut |now| signals() + usize::from(!goes_on(now)));
    match ending.map_err(failure)? {
        Ending::Stopped => Ok(writeln!(anstream::stdout().lock(), "stopped on the legs")?),
        Ending::AtOnce => Err(Failure::refused("torque was switched off at once")),
        Ending::Panicked => Err(Failure::refused("torque was switched off after a panic")),
    }
}

#[cfg(not(target_os = "linux"))]
fn attend(_: &OnDrive<'_>, _: &BusList, _: Option<Log>, _: &Path, _: Option<f64>) -> Outcome {
    Err(Failure::usage("operators are served on Linux"))
}

pub(crate) fn drive_sim(args: &DriveSimArgs) -> Outcome {
    let opened = opened(&args.on)?;
    let description = &opened.drive.description;
    let buses = named_buses(&args.bus, &args.on, description)?;
    opened.with(|on| {
        let (wired, paths) = buses.open_nodes(description, opened.log.as_ref()).map_err(failure)?;
        let mut stdout = anstream::stdout().lock();
        for path in paths {
            writeln!(stdout, "{path}")?;
        }
        stdout.flush()?;
        ask_for_rights(&args.on);
        on.serve_nodes(wired, &mut until(args.time)).map_err(failure)
    })
}

/// Whether so many seconds have not passed, by a clock in µs.
fn until(seconds: Option<f64>) -> impl FnMut(u64) -> bool {
    let mut start = None;
    move |now| {
        let start = *start.get_or_insert(now);
        seconds.is_none_or(|seconds| (now - start) as f64 * 1e-6 < seconds)
    }
}

fn report(followed: &Followed, drive: &str, on: &OnDrive<'_>) -> Outcome {
    let unit = on.robot.description().output_unit;
    let degrees = |angle: f64| format!("{:.3} deg", angle.to_degrees());
    let metres = |error: f64| format!("{} {unit}", number::metres(error));
    let seen = if followed.is_truth { "of the robot as it is" } else { "as measured" };
    let counters = &followed.counters;
    let lines = [
        ("RMSE against plan", format!("{}, {seen}", metres(followed.plan_rmse))),
        ("largest", metres(followed.plan_max)),
        ("at the end", metres(followed.end_error)),
        ("largest lean", degrees(followed.lean_max)),
        ("largest compensation", degrees(followed.compensation_max)),
        ("largest force", format!("{:.2} N*m or N", followed.force_max)),
        ("cycles on the plan", followed.cycles.to_string()),
        ("inputs missed", counters.missed.to_string()),
        ("malformed or unknown frames", (counters.malformed + counters.unknown).to_string()),
        ("torques limited", counters.limited.to_string()),
        ("SYNC late by at most", format!("{} us", followed.sync.worst_us())),
        ("SYNC late by", histogram(&followed.sync)),
    ];
    let mut stdout = anstream::stdout().lock();
    let bold = anstyle::Style::new().bold();
    writeln!(stdout, "{bold}{drive}{bold:#}")?;
    let width = lines.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, value) in lines {
        writeln!(stdout, "  {name:<width$}  {value}")?;
    }
    Ok(())
}

/// Counts by lateness; empty bins are left out.
fn histogram(sync: &Jitter) -> String {
    let edges = Jitter::EDGES_US.map(|edge| format!("< {edge} us"));
    let names = edges.into_iter().chain(["more".to_owned()]);
    let bins = names.zip(sync.bins()).filter(|(_, count)| **count > 0);
    bins.map(|(name, count)| format!("{name}: {count}")).collect::<Vec<_>>().join(", ")
}

/// What does not fit together is the user's, what the robot does is the robot's.
fn failure(error: Error) -> Failure {
    match error {
        Error::Task(error) => error.into(),
        Error::Late { .. } | Error::Refused(_) | Error::Plan(_) => Failure::refused(error),
        other => Failure::usage(other),
    }
}
