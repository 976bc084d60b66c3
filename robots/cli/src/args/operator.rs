//! What the user may type as a robot's operator.

use clap::{ArgAction, Args, Subcommand};
use shapebot_runtime::TUNABLE;
use std::path::PathBuf;

/// Where the robot is listened to and spoken to.
#[derive(Args, Debug)]
pub(crate) struct LinkArgs {
    /// Drive description (TOML), or name of a bundled drive
    #[arg(value_name = "DRIVE")]
    pub(crate) drive: String,

    /// Port of the operator's bus: can0, or the path of a serial adapter that speaks slcan
    #[arg(long, value_name = "PORT", required_unless_present = "socket")]
    pub(crate) bus: Option<String>,

    /// Socket of a robot on this computer
    #[arg(long, value_name = "PATH", conflicts_with = "bus")]
    pub(crate) socket: Option<PathBuf>,
}

const MONITOR_EXAMPLES: &str = "\
Redraws a page in a terminal, else writes a line each second.

Examples:
  shapebot monitor ballbot3d --socket robot.sock
  shapebot monitor my_drive.toml --bus can0 --for 10";

#[derive(Args, Debug)]
#[command(after_help = MONITOR_EXAMPLES)]
pub(crate) struct MonitorArgs {
    #[command(flatten)]
    pub(crate) link: LinkArgs,

    /// Has the robot lower its legs when it does not hear this monitor for half a second
    #[arg(long)]
    pub(crate) watch: bool,

    /// Ends after so many seconds
    #[arg(long = "for", value_name = "SECONDS", value_parser = seconds)]
    pub(crate) time: Option<f64>,
}

/// A time in seconds.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    let time: f64 = text.parse().map_err(|_| "expected a number".to_owned())?;
    if (0.0..=1e9).contains(&time) { Ok(time) } else { Err("expected 0 or more".to_owned()) }
}

/// A gain's number by its name.
fn gain(name: &str) -> Result<u8, String> {
    let found = (0..).zip(&TUNABLE).find(|(_, tunable)| tunable.name == name);
    found.map(|(index, _)| index).ok_or_else(|| {
        let all = TUNABLE
            .map(|tunable| format!("`{}` ({} to {})", tunable.name, tunable.low, tunable.high));
        format!("expected {}", all.join(", "))
    })
}

fn on_or_off(text: &str) -> Result<bool, String> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err("expected `on` or `off`".to_owned()),
    }
}

const COMMAND_EXAMPLES: &str = "\
Waits until the robot has taken the command; exit code 1 if it refused.

Examples:
  shapebot command ballbot3d --socket robot.sock start
  shapebot command ballbot3d --socket robot.sock upload plans/walk.plan
  shapebot command ballbot3d --socket robot.sock gain position 0.8
  shapebot command my_drive.toml --bus can0 e-stop";

#[derive(Args, Debug)]
#[command(after_help = COMMAND_EXAMPLES)]
pub(crate) struct CommandArgs {
    #[command(flatten)]
    pub(crate) link: LinkArgs,

    #[command(subcommand)]
    pub(crate) order: OrderArgs,
}

#[derive(Clone, Debug, PartialEq, Subcommand)]
pub(crate) enum OrderArgs {
    /// Enable the drives, rise and balance
    Start,
    /// Lower the legs while balancing, then torque off
    Stop,
    /// Legs down and torque off at once
    #[command(name = "e-stop")]
    EStop,
    /// Leave the state after a fault
    Reset,
    /// Balance; the position is free
    Balance,
    /// Hold the position
    KeepStation,
    /// Follow the plan
    Track,
    /// Turn to the heading
    Yaw,
    /// Sets the heading to turn to
    Heading {
        /// Degrees
        #[arg(allow_hyphen_values = true)]
        degrees: f32,
    },
    /// Sets a gain to a factor of the designed one, within its bounds
    Gain {
        /// Its name
        #[arg(value_parser = gain)]
        name: u8,
        /// The factor
        #[arg(allow_hyphen_values = true)]
        factor: f32,
    },
    /// Makes the operator's silence a fault from now on, or no more: see `monitor --watch`
    Watch {
        /// Whether it is
        #[arg(action = ArgAction::Set, value_parser = on_or_off, value_name = "on|off")]
        on: bool,
    },
    /// Sends a plan file, to be followed at the next `track`
    Upload {
        /// Binary plan file
        file: PathBuf,
    },
}
