//! `shapebot simulate`: a planned task, followed by a controller on a simulated robot.

mod csv;
mod summary;

use super::experiments::report;
use super::plan::{NamedTask, open_task};
use crate::args::{self, SimulateArgs};
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::plot;
use crate::robot::{Dynamics, Source, identity};
use shapebot_experiments::{Experiment, Planned};
use shapebot_planning::PlannedMotion;
use shapebot_tasks::{Method, Task};
use std::io::Write;
use std::path::{Path, PathBuf};

pub(crate) use summary::write_summary;

pub(crate) fn run(args: &SimulateArgs) -> Outcome {
    let NamedTask { name, robot: source, mut task } = open_task(&args.task)?;
    override_task(&mut task, args.method, &args.set)?;
    let parameters = &args.parameters.values;
    let robot = source.dynamics(parameters)?;
    let (planned, experiment) = simulate(&*robot, &task, parameters)?;
    let mut stdout = anstream::stdout().lock();
    write_summary(&mut stdout, &experiment, &task.paper)?;
    let run = Done {
        name: &name,
        source: &source,
        task: &task,
        planned: &planned,
        experiment: &experiment,
    };
    let mut files = Vec::new();
    if let Some(folder) = &args.output {
        files.extend(run.write(folder, &*robot)?);
    }
    if args.plot {
        let folder = args.output.as_deref().unwrap_or(Path::new(""));
        files.push(run.plot(folder)?);
    }
    for path in files {
        writeln!(stdout, "wrote {}", path.display())?;
    }
    Ok(())
}

/// Changes a task as the options say.
pub(crate) fn override_task(
    task: &mut Task,
    method: Option<args::Method>,
    set: &[String],
) -> Outcome {
    if let Some(method) = method {
        task.method = match method {
            args::Method::Gain => Method::Gain,
            args::Method::Refined => Method::Refined,
        };
    }
    set.iter().try_for_each(|line| {
        if !line.contains('=') {
            return Err(Failure::usage(format!("`--set {line}` is not KEY=VALUE")));
        }
        task.set_simulation("--set", line).map_err(Failure::usage)
    })
}

/// Plans a task and simulates it.
pub(crate) fn simulate(
    robot: &dyn Dynamics,
    task: &Task,
    parameters: &[(String, f64)],
) -> Outcome<(PlannedMotion, Experiment)> {
    let id = identity(robot.description(), parameters);
    let planned = robot.plan(task, &id)?;
    let experiment = robot.simulate(Planned { task, motion: &planned, id: &id })?;
    Ok((planned, experiment))
}

/// A run with what it came from.
pub(crate) struct Done<'a> {
    pub(crate) name: &'a str,
    pub(crate) source: &'a Source,
    pub(crate) task: &'a Task,
    pub(crate) planned: &'a PlannedMotion,
    pub(crate) experiment: &'a Experiment,
}

impl Done<'_> {
    /// Record, plan and report.
    pub(crate) fn write(&self, folder: &Path, robot: &dyn Dynamics) -> Outcome<Vec<PathBuf>> {
        let path = |extension: &str| folder.join(format!("{}.{extension}", self.name));
        let (record, plan, page) = (path("run.csv"), path("plan"), path("html"));
        output::write_file(&record, csv::csv(self.experiment))?;
        output::write_file(&plan, &self.planned.files.binary)?;
        let mut pages = report::Pages::default();
        pages.add_robot(self.source, robot)?;
        pages.add_run(self.experiment, &self.task.paper);
        pages.write(&page)?;
        Ok(vec![record, plan, page])
    }

    fn plot(&self, folder: &Path) -> Outcome<PathBuf> {
        let path = folder.join(format!("{}.svg", self.name));
        output::write_file(&path, plot::run_figure(self.experiment).svg())?;
        Ok(path)
    }
}
