//! `shapebot deploy`: a stand-alone crate for a robot and its drive.

use crate::args::{DeployArgs, DeployTarget};
use crate::failure::{Failure, Outcome};
use crate::robot;
use shapebot_deploy::{Error, Request, Target, Text, deploy, write};
use std::io::Write;
use std::path::Path;

pub(crate) fn run(args: &DeployArgs) -> Outcome {
    let text = robot::open(&args.robot)?.text()?;
    // Bytes that are no text are refused with their place, as any other mistake of a model.
    let model = String::from_utf8_lossy(&text.bytes);
    let (name, drive) = drive(&args.drive)?;
    let target = match args.target {
        DeployTarget::Linux => Target::Linux,
        DeployTarget::CortexM => Target::CortexM,
    };
    let plan = args.plan.as_deref().map(super::operator::read_plan).transpose()?;
    let request = Request {
        model: Text { name: &text.name, text: &model },
        drive: Text { name: &name, text: &drive },
        target,
        plan: plan.as_deref(),
    };
    let files = deploy(&request).map_err(refused)?;
    write(&files, &args.output).map_err(Failure::usage)?;
    let mut stdout = anstream::stdout().lock();
    let (count, folder) = (files.iter().count(), args.output.display());
    writeln!(stdout, "wrote {count} files to {folder}: {folder}/README.md says how to go on")?;
    Ok(())
}

/// Name and text of a drive description: a file, or a bundled one.
fn drive(name: &str) -> Outcome<(String, String)> {
    let path = Path::new(name);
    if name.ends_with(".toml") || path.exists() {
        let text = std::fs::read_to_string(path);
        let text = text.map_err(|error| Failure::file("read", path, &error))?;
        return Ok((name.to_owned(), text));
    }
    match shapebot_drives::text(name) {
        Some(text) => Ok((format!("{name}.toml"), text.to_owned())),
        None => {
            let known = shapebot_drives::DRIVES.iter().map(|(name, _)| *name);
            Err(Failure::unknown("file or bundled drive", name, known))
        }
    }
}

/// A wrong drive description is wrong input, as a wrong task is; what the model does not allow is refused.
fn refused(error: Error) -> Failure {
    match error {
        Error::Drive(errors) => Failure::usage(errors),
        other => Failure::refused(other),
    }
}
