//! Drives: what the user names, checked against the robot that it drives.

use crate::failure::{Failure, Outcome};
use crate::robot;
use shapebot_drive_build::{DriveDescription, Source as DriveSource};
use shapebot_drives::DRIVES;
use std::path::Path;

/// A drive that fits its robot.
pub(crate) struct Drive {
    pub(crate) description: DriveDescription,
}

/// Opens a drive: a path or a name that ends in `.toml` is a file, everything else a bundled drive. The
/// robot is the one that it names, a path being relative to the drive's file, unless `given`.
pub(crate) fn open(name: &str, given: Option<&str>) -> Outcome<Drive> {
    let path = Path::new(name);
    let is_file = name.ends_with(".toml") || path.exists();
    let text = if is_file {
        std::fs::read_to_string(path).map_err(|e| Failure::file("read", path, &e))?
    } else {
        let known = || DRIVES.iter().map(|(name, _)| *name);
        let text = shapebot_drives::text(name);
        text.ok_or_else(|| Failure::unknown("file or bundled drive", name, known()))?.to_owned()
    };
    let drive = DriveSource::parse(name, &text).map_err(Failure::usage)?;
    let beside = path.parent().unwrap_or(Path::new("")).join(drive.robot());
    let source = match given {
        Some(given) => robot::open(given)?,
        None if is_file && beside.exists() => robot::open(&beside.display().to_string())?,
        None => robot::open(drive.robot())?,
    };
    let robot = source.dynamics(&[])?;
    let description = drive.check(robot.description()).map_err(Failure::usage)?;
    Ok(Drive { description })
}
