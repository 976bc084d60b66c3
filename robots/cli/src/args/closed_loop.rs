//! What the user may type about closed loops.

use super::{Method, OUTPUT, ParameterArgs};
use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub(crate) struct FolderArgs {
    /// Folder for what is written
    #[arg(short, long, value_name = "DIR", default_value = OUTPUT)]
    pub(crate) output: PathBuf,
}

const SIMULATE_EXAMPLES: &str = "\
Keys of --set are those of a task's [simulation], without quotes around quantities:

Examples:
  shapebot simulate straight_line
  shapebot simulate walk.toml --method gain -o out --plot
  shapebot simulate straight_line --set 'drive.coulomb=2 N m' --set observer=false
  shapebot simulate straight_line --set 'delay=6 ms' --set plant.m_b=80";

#[derive(Args, Debug)]
#[command(after_help = SIMULATE_EXAMPLES)]
pub(crate) struct SimulateArgs {
    /// Task file, or name of a bundled task
    #[arg(value_name = "TASK")]
    pub(crate) task: String,

    /// How the shape trajectory is found: the task's own method if not given
    #[arg(long, value_enum)]
    pub(crate) method: Option<Method>,

    /// A key of the task's `[simulation]` with another value
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,

    /// Folder for the run as CSV, the plan's bytes, and the report
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,

    /// Draw the run, into the output folder or here
    #[arg(long)]
    pub(crate) plot: bool,

    #[command(flatten)]
    pub(crate) parameters: ParameterArgs,
}

const ROBUSTNESS_EXAMPLES: &str = "\
Masses and inertias, friction at the drive and at the floor, delays, noise, bias, encoder steps, slope,
and the start are drawn at random, scaled to the robot. Run k of a seed is always the same.

Examples:
  shapebot robustness straight_line -n 1000
  shapebot robustness straight_line -n 1000 --shard 3/8 --csv part3.csv    one job of an array
  shapebot robustness merge part*.csv --csv all.csv
  shapebot robustness straight_line -n 1000 --replay 17 -o out             run 17 with its record";

#[derive(Args, Debug)]
#[command(after_help = ROBUSTNESS_EXAMPLES)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct RobustnessArgs {
    #[command(subcommand)]
    pub(crate) command: Option<RobustnessCommand>,

    /// Task file, or name of a bundled task
    #[arg(value_name = "TASK", required = true)]
    pub(crate) task: Option<String>,

    /// Number of runs
    #[arg(short = 'n', long = "runs", value_name = "RUNS", default_value_t = 1000,
          value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    pub(crate) runs: u64,

    /// Seed of the draws
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,

    /// Part I of N of the runs; the files of all parts in a row are the file of the whole
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub(crate) shard: Option<[u64; 2]>,

    /// Write one line per run
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,

    /// Make only this run, and show it
    #[arg(long, value_name = "RUN", conflicts_with_all = ["shard", "csv"])]
    pub(crate) replay: Option<u64>,

    /// Leave out where falls begin
    #[arg(long)]
    pub(crate) no_onset: bool,

    /// How the shape trajectory is found: the task's own method if not given
    #[arg(long, value_enum)]
    pub(crate) method: Option<Method>,

    /// A key of the task's `[simulation]` with another value
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,

    /// Folder for a replayed run: CSV, plan and report
    #[arg(short, long, value_name = "DIR", requires = "replay")]
    pub(crate) output: Option<PathBuf>,
}

#[derive(clap::Subcommand, Debug)]
pub(crate) enum RobustnessCommand {
    /// Puts the files of shards together, and refuses gaps and overlaps
    Merge(MergeArgs),
}

#[derive(Args, Debug)]
pub(crate) struct MergeArgs {
    /// Files of shards
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,

    /// Write all runs
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
}

/// `3/8`
fn shard(text: &str) -> Result<[u64; 2], String> {
    let wrong = || format!("`{text}` is not I/N with I from 1 to N");
    let (index, count) = text.split_once('/').ok_or_else(wrong)?;
    let number = |text: &str| text.parse::<u64>().map_err(|_| wrong());
    let (index, count) = (number(index)?, number(count)?);
    if (1..=count).contains(&index) { Ok([index, count]) } else { Err(wrong()) }
}

#[cfg(test)]
mod tests {
    use super::shard;

    #[test]
    fn shards_count_from_one() {
        assert_eq!(shard("3/8"), Ok([3, 8]));
        for wrong in ["0/8", "9/8", "3", "a/8", "3/", "-1/2"] {
            assert!(shard(wrong).is_err(), "{wrong}");
        }
    }
}
