//! Bundled drives, robots and tasks.
#![allow(dead_code, reason = "each test uses its part")]

use shapebot_drive_build::{DriveDescription, Source};
use shapebot_dynamics::{Description, Robot};
use shapebot_planner::value::RobotId;

/// A bundled drive for a model.
pub(crate) fn drive(name: &str, model: &Description) -> DriveDescription {
    let source = Source::parse(name, shapebot_drives::text(name).unwrap()).unwrap();
    source.check(model).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The plan file of a task's text.
pub(crate) fn plan<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    text: &str,
) -> Vec<u8>
where
    R: Robot<f64, N, NX, NS>,
{
    let task = shapebot_tasks::parse("task.toml", text).unwrap();
    let id = RobotId::of(robot.description());
    shapebot_planning::plan(robot, &task, &id).unwrap_or_else(|e| panic!("{e:?}")).files.binary
}

/// The paper's straight line along the first axis, refined.
pub(crate) fn line(robot: &str, goal: &str, duration: &str) -> String {
    format!(
        "robot = \"{robot}\"\nsamples = 501\nmethod = \"refined\"\n[motion]\nkind = \"line\"\n\
         goal = \"{goal} m\"\nduration = \"{duration} s\"\n"
    )
}
