//! Shell commands in user-mode Linux with vcan0 up.
#![allow(dead_code, reason = "each test file uses its own part")]

use shapebot_drive_build::{DriveDescription, Source};
use shapebot_dynamics::LagrangianSystem as _;
use shapebot_generated::ballbot_planar::BallbotPlanar;
use shapebot_tests::copies::build_folder;
use shapebot_tests::environment::{root, skip};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A planar ballbot goes half a metre.
pub(crate) const TASK: &str = r#"
title = "Half a metre"
robot = "ballbot_planar"
method = "refined"
samples = 301

[motion]
kind = "line"
goal = "0.5 m"
duration = "3 s"
"#;

/// The planar ballbot's drive from a description.
pub(crate) fn drive(text: &str) -> DriveDescription {
    let source = Source::parse("drive", text).unwrap_or_else(|errors| panic!("{errors}"));
    let robot = BallbotPlanar::<f64>::from_model();
    source.check(robot.description()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// A new folder for what a test writes.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = build_folder(&format!("vcan/{name}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Runs shell commands with vcan0 up in a folder of their own. `None`, after a line that says so, where
/// user-mode Linux is missing.
pub(crate) fn on_vcan(folder: &Path, commands: &str) -> Option<Output> {
    let script = folder.join("commands.sh");
    std::fs::write(&script, commands).expect("the commands");
    let program = root().join("tests/vcan/vcan");
    let output = Command::new(program).arg("run").arg(folder).arg(&script).output();
    let output = match output {
        Ok(output) => output,
        Err(error) => {
            skip("vcan", &error.to_string());
            return None;
        }
    };
    if output.status.code() == Some(77) {
        skip("vcan", String::from_utf8_lossy(&output.stderr).trim());
        return None;
    }
    Some(output)
}

/// Whether user-mode Linux is here; says so if not.
pub(crate) fn user_mode_linux() -> bool {
    let program = root().join("tests/vcan/vcan");
    let check = Command::new(program).arg("check").output();
    let lacking = match &check {
        Ok(output) if output.status.success() => return true,
        Ok(output) => String::from_utf8_lossy(&output.stderr).into_owned(),
        Err(error) => error.to_string(),
    };
    skip("vcan", lacking.trim());
    false
}

/// Whether can-utils are here; says so if not.
pub(crate) fn can_utils() -> bool {
    let here = Command::new("cansend").output().is_ok();
    if !here {
        skip("vcan", "no candump and cansend (Debian: can-utils)");
    }
    here
}
