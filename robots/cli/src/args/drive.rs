//! What the user may type about drives.

use clap::Args;
use std::path::PathBuf;

const DRIVE_EXAMPLES: &str = "\
Checks a drive description and prints bus loads, times of a cycle and resolutions; without a name, lists the
bundled ones. -o writes Rust tables and codecs, a DBC file for each bus, the report and the SDO set-up.

Examples:
  shapebot drive
  shapebot drive ballbot3d
  shapebot drive my_drive.toml --robot my.robot -o out";

#[derive(Args, Debug)]
#[command(after_help = DRIVE_EXAMPLES)]
pub(crate) struct DriveArgs {
    /// Drive description (TOML), or name of a bundled drive
    #[arg(value_name = "DRIVE")]
    pub(crate) drive: Option<String>,

    /// Model file or bundled robot that is driven, instead of the one that the description names
    #[arg(long, value_name = "FILE|ROBOT")]
    pub(crate) robot: Option<String>,

    /// Folder for what is generated
    #[arg(short, long, value_name = "DIR", requires = "drive")]
    pub(crate) output: Option<PathBuf>,
}
