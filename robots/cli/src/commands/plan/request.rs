//! What the user asks to be planned: a task, or a robot with a motion.

use crate::args::{self, PlanArgs, Point};
use crate::failure::{Failure, Outcome};
use crate::robot::{self, Bundled, Dynamics, Source, bundled};
use shapebot_dynamics::Description;
use shapebot_tasks::simulation::{Paper, Simulation};
use shapebot_tasks::{
    Dimension, Method, Motion, Objective, Quantities, Said, Shares, TASKS, Task, parse,
};
use std::path::Path;

const SAMPLES: usize = 501;
const DEGREE: usize = 9;

/// What is to be planned.
pub(super) struct Request {
    /// For the names of files.
    pub(super) name: String,
    /// With its parameters set.
    pub(super) robot: Box<dyn Dynamics>,
    pub(super) task: Task,
}

/// Finds what the user names: a task by its extension or name, everything else is a robot.
pub(super) fn request(args: &PlanArgs) -> Outcome<Request> {
    let subject = &args.subject;
    let mut request = if !subject.ends_with(".toml") && is_robot(subject) {
        of_robot(args)?
    } else {
        let NamedTask { name, robot, task } = open_task(subject)?;
        Request { name, robot: robot.dynamics(&args.parameters.values)?, task }
    };
    let given = is_task(args).then(|| given_motion(args)).flatten();
    if let Some(option) = given {
        let message = format!("{option} is for a robot; `{subject}` is a task, which says that");
        return Err(Failure::usage(message));
    }
    override_task(args, &mut request.task);
    Ok(request)
}

fn is_robot(subject: &str) -> bool {
    subject.ends_with(".robot")
        || Path::new(subject).exists()
        || bundled().any(|robot| robot.name() == subject)
}

fn is_task(args: &PlanArgs) -> bool {
    args.subject.ends_with(".toml") || !is_robot(&args.subject)
}

/// The first option that says what a task says itself.
fn given_motion(args: &PlanArgs) -> Option<&'static str> {
    let options = [
        ("--line", args.line.is_some()),
        ("--bezier", args.bezier.is_some()),
        ("--duration", args.duration.is_some()),
        ("--degree", args.degree.is_some()),
        ("--weights", !args.weights.is_empty()),
    ];
    options.into_iter().find(|(_, given)| *given).map(|(option, _)| option)
}

/// A bundled task and its robot.
pub(crate) fn task(name: &str) -> Outcome<(Source, Task)> {
    let known = || TASKS.iter().map(|(name, _)| *name);
    let text = shapebot_tasks::text(name).ok_or_else(|| Failure::unknown("task", name, known()))?;
    let task = parse(&format!("{name}.toml"), text).map_err(Failure::usage)?;
    let robot = robot::open(&task.robot.value).map_err(|e| e.at(&task.robot.place))?;
    Ok((robot, task))
}

/// A longer file is no task.
const LONGEST_FILE: u64 = 1 << 20;

/// A task with its name and its robot.
pub(crate) struct NamedTask {
    /// For the names of files.
    pub(crate) name: String,
    pub(crate) robot: Source,
    pub(crate) task: Task,
}

/// Opens a task file or a bundled task.
pub(crate) fn open_task(subject: &str) -> Outcome<NamedTask> {
    if subject.ends_with(".toml") {
        return of_file(Path::new(subject));
    }
    if shapebot_tasks::text(subject).is_none() {
        let tasks = TASKS.iter().map(|(name, _)| *name);
        let known = bundled().map(Bundled::name).chain(tasks);
        return Err(Failure::unknown("file, bundled robot or task", subject, known));
    }
    let (robot, task) = task(subject)?;
    Ok(NamedTask { name: subject.to_owned(), robot, task })
}

fn of_file(path: &Path) -> Outcome<NamedTask> {
    let failure = |error| Failure::file("read", path, &error);
    if std::fs::metadata(path).map_err(failure)?.len() > LONGEST_FILE {
        return Err(Failure::usage(format!("{} is too long for a task", path.display())));
    }
    let text = std::fs::read_to_string(path).map_err(failure)?;
    let task = parse(&path.display().to_string(), &text).map_err(Failure::usage)?;
    let named = &task.robot.value;
    // A model file stands relative to the task.
    let beside = path.parent().unwrap_or(Path::new("")).join(named);
    let robot = if named.ends_with(".robot") {
        robot::open(&beside.to_string_lossy())
    } else {
        robot::open(named)
    };
    let robot = robot.map_err(|e| e.at(&task.robot.place))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(NamedTask { name, robot, task })
}

/// A robot with the motion that the options give.
fn of_robot(args: &PlanArgs) -> Outcome<Request> {
    let robot = robot::open(&args.subject)?.dynamics(&args.parameters.values)?;
    let description = robot.description();
    let Some(duration) = args.duration else {
        return Err(Failure::usage("a robot's motion needs --duration SECONDS"));
    };
    let motion = motion(args, duration, description)?;
    let share = |(set, share): &(String, f64)| (said("--weights", set.clone()), *share);
    let shares = match args.weights.as_slice() {
        [] => Shares::Default,
        weights => Shares::Given(weights.iter().map(share).collect()),
    };
    let task = Task {
        title: None,
        robot: said("", args.subject.clone()),
        method: Method::Gain,
        objective: Said::default(),
        samples: said("", SAMPLES),
        standing: Said::default(),
        shares: said("--weights", shares),
        limits: Vec::new(),
        force_limits: Vec::new(),
        motion: said("", motion),
        constraints: Vec::new(),
        simulation: Simulation::default(),
        is_experiment: false,
        paper: Paper::default(),
    };
    let name = description.name.to_owned();
    Ok(Request { name, robot, task })
}

fn motion(args: &PlanArgs, duration: f64, robot: &Description) -> Outcome<Motion> {
    // Numbers on the command line are in the output's own unit.
    let dimension = if robot.output_unit == "rad" { Dimension::Angle } else { Dimension::Length };
    let quantities = |point: &Point| Quantities { values: point.0.clone(), dimension };
    match (&args.line, &args.bezier) {
        (Some(goal), _) => {
            let degree = args.degree.unwrap_or(DEGREE);
            Ok(Motion::Line { goal: said("--line", quantities(goal)), degree, duration })
        }
        (None, Some(points)) => {
            let points = points.0.iter().map(|point| said("--bezier", quantities(point)));
            Ok(Motion::Bezier { points: points.collect(), duration })
        }
        (None, None) => Err(Failure::usage("a robot needs a motion: --line or --bezier")),
    }
}

fn said<T>(place: &str, value: T) -> Said<T> {
    Said { value, place: place.to_owned() }
}

/// Options that go with both.
fn override_task(args: &PlanArgs, task: &mut Task) {
    if let Some(method) = args.method {
        task.method = match method {
            args::Method::Gain => Method::Gain,
            args::Method::Refined => Method::Refined,
        };
    }
    if let Some(objective) = args.objective {
        task.objective = said(
            "--objective",
            match objective {
                args::Objective::Position => Objective::Position,
                args::Objective::Acceleration => Objective::Acceleration,
                args::Objective::Coordinates => Objective::Coordinates,
            },
        );
    }
    if let Some(samples) = args.samples {
        task.samples = said("--samples", samples);
    }
    if let Some(standing) = args.standing {
        task.standing = said("--standing", [standing; 2]);
    }
}
