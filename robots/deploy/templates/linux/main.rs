//! The robot's program on Linux: `--help` shows what it takes.

use robot::{CONTROL, DRIVE, PLAN, ROBOT};
use shapebot_host::Robotics;
use std::process::ExitCode;

fn main() -> ExitCode {
    shapebot_host::main(Robotics { robot: &ROBOT, control: &CONTROL, drive: &DRIVE, plan: PLAN })
}
