//! `shapebot robustness`: a task many times at random.

mod summary;

use super::experiments::bar;
use super::plan::{NamedTask, open_task};
use super::simulate::{Done, override_task, write_summary};
use crate::args::{MergeArgs, RobustnessArgs, RobustnessCommand};
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::robot::identity;
use shapebot_experiments::{HEAD, Planned, Row, Runs, Shard, merge};
use std::io::Write;
use std::path::Path;

/// Disturbances whose onset is looked for.
const ONSETS: u64 = 4;

pub(crate) fn run(args: &RobustnessArgs) -> Outcome {
    if let Some(RobustnessCommand::Merge(args)) = &args.command {
        return merged(args);
    }
    let NamedTask { name, robot: source, mut task } =
        open_task(args.task.as_deref().unwrap_or(""))?;
    override_task(&mut task, args.method, &args.set)?;
    if args.replay.is_some_and(|run| run >= args.runs) {
        let message = format!("--replay: runs are counted from 0 to {}", args.runs - 1);
        return Err(Failure::usage(message));
    }
    let robot = source.dynamics(&[])?;
    let id = identity(robot.description(), &[]);
    let planned = robot.plan(&task, &id)?;
    let motion = Planned { task: &task, motion: &planned, id: &id };
    let runs = robot.trials((&name, motion), [args.seed, args.runs])?;
    let Some(run) = args.replay else { return all(args, &*runs) };
    let (row, experiment) = runs.replay(run)?;
    let mut stdout = anstream::stdout().lock();
    write_summary(&mut stdout, &experiment, &task.paper)?;
    writeln!(stdout, "{HEAD}\n{row}")?;
    let Some(folder) = &args.output else { return Ok(()) };
    let name = format!("{name}-{}-{run}", args.seed);
    let (source, task, planned) = (&source, &task, &planned);
    let done = Done { name: &name, source, task, planned, experiment: &experiment };
    for path in done.write(folder, &*robot)? {
        writeln!(stdout, "wrote {}", path.display())?;
    }
    Ok(())
}

/// The runs of a shard, their file and what they say.
fn all(args: &RobustnessArgs, runs: &dyn Runs) -> Outcome {
    let shard = args.shard.map_or(Shard::WHOLE, |[index, count]| Shard { index, count });
    let range = shard.runs(args.runs);
    let progress = bar(range.end - range.start, "runs");
    let rows = runs.rows(shard, &|| progress.inc(1));
    progress.finish_and_clear();
    let rows = rows?;
    if let Some(path) = &args.csv {
        write_rows(path, &rows, shard.index == 1)?;
    }
    let mut stdout = anstream::stdout().lock();
    summary::write(&mut stdout, &rows)?;
    if args.shard.is_none() && !args.no_onset {
        let progress = bar(ONSETS, "places where falls begin");
        let onsets = runs.onsets(&|| progress.inc(1));
        progress.finish_and_clear();
        summary::write_onsets(&mut stdout, &onsets?)?;
    }
    if let Some(path) = &args.csv {
        writeln!(stdout, "wrote {}", path.display())?;
    }
    Ok(())
}

/// The first shard has the head, so that files in a row are one file.
fn write_rows(path: &Path, rows: &[Row], head: bool) -> Outcome {
    let mut text = String::new();
    if head {
        text.push_str(HEAD);
        text.push('\n');
    }
    for row in rows {
        text.push_str(&row.to_string());
        text.push('\n');
    }
    output::write_file(path, text)
}

fn merged(args: &MergeArgs) -> Outcome {
    let read = |path: &std::path::PathBuf| {
        let text = std::fs::read_to_string(path).map_err(|e| Failure::file("read", path, &e))?;
        Ok((path.display().to_string(), text))
    };
    let files = args.files.iter().map(read).collect::<Outcome<Vec<_>>>()?;
    let rows = merge(&files).map_err(Failure::usage)?;
    let mut stdout = anstream::stdout().lock();
    if let Some(path) = &args.csv {
        write_rows(path, &rows, true)?;
    }
    summary::write(&mut stdout, &rows)?;
    if let Some(path) = &args.csv {
        writeln!(stdout, "wrote {}", path.display())?;
    }
    Ok(())
}
