//! What the user may type to run a robot on its drive.

use super::Method;
use clap::Args;
use std::path::PathBuf;

/// A task on a drive.
#[derive(Args, Debug)]
pub(crate) struct OnDriveArgs {
    /// Task file, or name of a bundled task
    #[arg(value_name = "TASK")]
    pub(crate) task: String,

    /// Drive description (TOML), or name of a bundled drive: that of the robot's name if not given
    #[arg(long, value_name = "DRIVE")]
    pub(crate) drive: Option<String>,

    /// How the shape trajectory is found: the task's own method if not given
    #[arg(long, value_enum)]
    pub(crate) method: Option<Method>,

    /// A key of the task's `[simulation]` with another value
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,

    /// Writes all frames as candump does
    #[arg(long, value_name = "FILE")]
    pub(crate) log: Option<PathBuf>,

    /// Time on the buses runs N times slower, for computers that other work holds up; both ends alike
    #[arg(long, value_name = "N", default_value_t = 1, requires = "bus", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) slow: u32,

    /// Lateness in ms that both ends forgive beyond what the drive allows, for computers that keep no time
    #[arg(long, value_name = "MS", default_value_t = 0, requires = "bus", value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub(crate) slack: u32,

    /// Priority of SCHED_FIFO in real time, 1 to 99
    #[arg(long, value_name = "N", default_value_t = 80, value_parser = clap::value_parser!(u8).range(1..=99))]
    pub(crate) priority: u8,

    /// Neither SCHED_FIFO nor locked memory
    #[arg(long, conflicts_with = "priority")]
    pub(crate) ordinary: bool,
}

const RUN_EXAMPLES: &str = "\
Takes the robot through the task: set-up of the drives, rising, standing, the plan, standing, legs down.
Without --bus the drives are simulated in this process, and time is that of the simulated buses; for an
operator it passes like real time.

Examples:
  shapebot run straight_line
  shapebot run table2_ballbot3d --drive ballbot3d_1khz --log frames.log
  shapebot run straight_line --bus drive=can0,body=can1
  shapebot run straight_line --bus /dev/pts/3,/dev/pts/4 --slow 5
  shapebot run straight_line --operator robot.sock                        an operator says when
  shapebot run straight_line --bus can0,can1 --operator robot.sock";

#[derive(Args, Debug)]
#[command(after_help = RUN_EXAMPLES)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    pub(crate) on: OnDriveArgs,

    /// A port for each of the drive's buses: can0, or the path of a serial adapter that speaks slcan
    #[arg(long, value_name = "PORTS", default_value = "virtual")]
    pub(crate) bus: String,

    /// Waits for an operator's commands, on the bus and on this socket, instead of beginning at once
    #[arg(long, value_name = "PATH")]
    pub(crate) operator: Option<PathBuf>,

    /// Ends after so many seconds of waiting for an operator
    #[arg(long = "for", value_name = "SECONDS", value_parser = super::operator::seconds, requires = "operator")]
    pub(crate) time: Option<f64>,
}

const DRIVE_SIM_EXAMPLES: &str = "\
Simulated drives, sensors and legs over a simulated robot, in real time: the other end of `shapebot run`. The
task says what the robot is and what happens to it. `pty` makes a pseudo-terminal and prints its path.

Examples:
  shapebot drive-sim straight_line --bus pty,pty
  shapebot drive-sim straight_line --bus vcan0,vcan1 --for 60";

#[derive(Args, Debug)]
#[command(after_help = DRIVE_SIM_EXAMPLES)]
pub(crate) struct DriveSimArgs {
    #[command(flatten)]
    pub(crate) on: OnDriveArgs,

    /// A port for each of the drive's buses: vcan0, the path of a serial port, or pty
    #[arg(long, value_name = "PORTS")]
    pub(crate) bus: String,

    /// Ends after so many seconds
    #[arg(long = "for", value_name = "SECONDS", value_parser = super::operator::seconds)]
    pub(crate) time: Option<f64>,
}
