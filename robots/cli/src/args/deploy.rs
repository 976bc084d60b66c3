//! What the user may type about deployment.

use super::ROBOT_HELP;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

const DEPLOY_EXAMPLES: &str = "\
The folder must not exist, be empty, or be one that deploy wrote and nobody edited; src/board.rs and
memory.x of an earlier one are kept.

Examples:
  shapebot deploy my.robot --drive my.toml --target linux -o my_robot
  shapebot deploy ballbot_planar --drive ballbot_planar --target cortex-m --plan out/walk.plan -o firmware";

/// Where the robot's program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DeployTarget {
    /// A process on Linux, over SocketCAN or slcan
    Linux,
    /// A microcontroller with a Cortex-M4F
    CortexM,
}

#[derive(Args, Debug)]
#[command(after_help = DEPLOY_EXAMPLES)]
pub(crate) struct DeployArgs {
    #[arg(value_name = "FILE|ROBOT", help = ROBOT_HELP)]
    pub(crate) robot: String,

    /// Drive description, or name of a bundled one
    #[arg(long, value_name = "FILE|DRIVE")]
    pub(crate) drive: String,

    /// Where the robot's program runs
    #[arg(long, value_enum)]
    pub(crate) target: DeployTarget,

    /// Binary plan that the program has from the start; on a microcontroller its only one
    #[arg(long, value_name = "FILE")]
    pub(crate) plan: Option<PathBuf>,

    /// Folder of the crate
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
}
