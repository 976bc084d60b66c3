//! What the user may type.

use clap::builder::styling::{AnsiColor, Styles};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold())
    .placeholder(AnsiColor::Cyan.on_default());

const EXIT_CODES: &str = "\
Exit codes: 0 done, 1 the model or the plan was refused, 2 wrong usage or input.";

/// Symbolic-to-code toolchain for balancing robots.
///
/// Without a command: plans the task of Nagarajan and Hollis, Table II, by both methods, simulates all
/// bundled experiments, prints both tables and writes motions, plots and the report.
#[derive(Debug, Parser)]
#[command(name = "shapebot", version, styles = STYLES, after_help = EXIT_CODES, after_long_help = TOP_EXAMPLES)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,

    /// Folder for motions, plots and the report.
    #[arg(short, long, value_name = "DIR", default_value = OUTPUT)]
    pub(crate) output: PathBuf,
}

const OUTPUT: &str = "shapebot-out";

const TOP_EXAMPLES: &str = "\
Examples:
  shapebot                                  Table II and the closed loops of all experiments
  shapebot check my.robot                   what is wrong with a model, what is proved about it
  shapebot plan ballbot3d --line 2,0 --duration 5 --svg plan.svg
  shapebot plan walk.toml -o plans          a task file
  shapebot simulate walk.toml --plot        the plan, followed by a controller on a simulated robot
  shapebot robustness walk.toml -n 1000     the same with everything uncertain drawn at random
  shapebot inspect plans/walk.plan          a plan file: whole, unaltered, for which robot
  shapebot eval my.robot < states.jsonl     dynamics of given states

Exit codes: 0 done, 1 the model or the plan was refused, 2 wrong usage or input.";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Lists the bundled robots
    Robots,
    /// Checks a model and shows what is proved about it
    Check(CheckArgs),
    /// Prints the derived equations of motion
    Derive(DeriveArgs),
    /// Writes the specialised Rust code of a model
    Emit(EmitArgs),
    /// Plans a motion
    Plan(Box<PlanArgs>),
    /// Lets a controller follow a planned task on a simulated robot
    Simulate(SimulateArgs),
    /// Plans and simulates all bundled experiments, and writes the report
    Experiments(FolderArgs),
    /// Simulates a task many times at random
    Robustness(RobustnessArgs),
    /// Plans the task of Table II for its four systems by both methods
    Table(FolderArgs),
    /// Verifies a plan file, and converts it
    Inspect(InspectArgs),
    /// Takes a robot through a task over the frames of its drive
    Run(RunArgs),
    /// Simulates a robot and its drive on buses in real time
    DriveSim(DriveSimArgs),
    /// Checks a drive description and shows what its buses carry
    Drive(DriveArgs),
    /// Shows the telemetry of a running robot
    Monitor(MonitorArgs),
    /// Gives a running robot an order
    #[command(name = "command")]
    Order(CommandArgs),
    /// Writes a stand-alone crate that controls a robot over CAN
    Deploy(DeployArgs),
    /// Evaluates dynamics: JSON lines in, JSON lines out
    Eval(EvalArgs),
    /// Explains a diagnostic code, or lists all of them
    Explain(ExplainArgs),
}

mod closed_loop;
mod deploy;
mod drive;
mod operator;
mod run;

pub(crate) use closed_loop::{
    FolderArgs, MergeArgs, RobustnessArgs, RobustnessCommand, SimulateArgs,
};
pub(crate) use deploy::{DeployArgs, DeployTarget};

pub(crate) use drive::DriveArgs;
pub(crate) use operator::{CommandArgs, LinkArgs, MonitorArgs, OrderArgs};
pub(crate) use run::{DriveSimArgs, OnDriveArgs, RunArgs};

const ROBOT_HELP: &str = "Model file, or name of a bundled robot";

const CHECK_EXAMPLES: &str = "\
Examples:
  shapebot check my.robot
  shapebot check ballbot3d_arms";

#[derive(Args, Debug)]
#[command(after_help = CHECK_EXAMPLES)]
pub(crate) struct CheckArgs {
    #[arg(value_name = "FILE|ROBOT", help = ROBOT_HELP)]
    pub(crate) robot: String,
}

/// Form of printed equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Readable text
    Text,
    /// LaTeX
    Latex,
    /// JSON
    Json,
}

const DERIVE_EXAMPLES: &str = "\
Examples:
  shapebot derive ballbot_planar
  shapebot derive my.robot --format latex > equations.tex";

#[derive(Args, Debug)]
#[command(after_help = DERIVE_EXAMPLES)]
pub(crate) struct DeriveArgs {
    #[arg(value_name = "FILE|ROBOT", help = ROBOT_HELP)]
    pub(crate) robot: String,

    /// Form of the equations
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
}

const EMIT_EXAMPLES: &str = "\
Examples:
  shapebot emit my.robot -o src/generated
  shapebot emit my.robot --bake -o src/generated   parameters folded in";

#[derive(Args, Debug)]
#[command(after_help = EMIT_EXAMPLES)]
pub(crate) struct EmitArgs {
    #[arg(value_name = "FILE|ROBOT", help = ROBOT_HELP)]
    pub(crate) robot: String,

    /// Fold the model's own parameter values into the code
    #[arg(long)]
    pub(crate) bake: bool,

    /// Folder for the code
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
}

const EXPLAIN_EXAMPLES: &str = "\
Examples:
  shapebot explain            all codes
  shapebot explain E0301      one code";

#[derive(Args, Debug)]
#[command(after_help = EXPLAIN_EXAMPLES)]
pub(crate) struct ExplainArgs {
    /// Code of a diagnostic; all are listed without one
    #[arg(value_name = "CODE")]
    pub(crate) code: Option<String>,
}

const EVAL_EXAMPLES: &str = "\
Input, one line per state: {\"q\": [...], \"qd\": [...], \"qdd\": [...], \"tau\": [...]}
q = [q_x, q_s] in SI units; qd and qdd may be left out where no requested field reads them; tau has one
entry per actuator and is zero if left out. Other keys are ignored, blank lines skipped.

Fields: M C Cqd G Gamma GammaP dM_dq dCqd_dq dCqd_dqd dG_dq dGamma_dqs dGamma_dqsd dGamma_dqsdd
dGammaP_dqs kinetic potential qdd_fd K0_qs. Matrices are lists of rows, dM_dq[k] is dM/dq_k,
qdd_fd = M^-1 (B tau - C qd - G). Gamma and what follows from it exist for shape-accelerated robots.

Examples:
  shapebot eval ballbot3d < states.jsonl > dynamics.jsonl
  shapebot eval my.robot --fields M,G --param m_b=80 < states.jsonl";

#[derive(Args, Debug)]
#[command(after_help = EVAL_EXAMPLES)]
pub(crate) struct EvalArgs {
    #[arg(value_name = "FILE|ROBOT", help = ROBOT_HELP)]
    pub(crate) robot: String,

    /// Fields to print, in this order; all by default
    #[arg(long, value_name = "FIELD,...", value_delimiter = ',')]
    pub(crate) fields: Vec<String>,

    #[command(flatten)]
    pub(crate) parameters: ParameterArgs,
}

#[derive(Args, Debug)]
pub(crate) struct ParameterArgs {
    /// Value of a parameter in SI units, instead of the model's own
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = assignment, allow_hyphen_values = true)]
    pub(crate) values: Vec<(String, f64)>,
}

/// What the optimisation makes small.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Objective {
    /// Squared error of the output position
    Position,
    /// Squared error of the acceleration (Eq. 33)
    Acceleration,
    /// Squared error of the position coordinates
    Coordinates,
}

/// How the shape trajectory is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Method {
    /// The constant gain of Algorithm 1
    Gain,
    /// The refined planner
    Refined,
}

const PLAN_EXAMPLES: &str = "\
Examples:
  shapebot plan ballbot3d --line 2,0 --duration 5 --method refined --standing 1 --svg plan.svg
  shapebot plan ballbot3d_arms --line 1,1 --duration 6 --weights phi=0.5,alpha_l=0.5
  shapebot plan my.robot --bezier '0,0 0,0 1,0 1,1 1,1' --duration 10 --csv plan.csv
  shapebot plan walk.toml -o plans --plot   a task file
  shapebot plan arms_waving                 a bundled task";

#[derive(Args, Debug)]
#[command(after_help = PLAN_EXAMPLES)]
#[command(group = clap::ArgGroup::new("motion").args(["line", "bezier"]))]
pub(crate) struct PlanArgs {
    /// Model file, task file, or name of a bundled robot or task
    #[arg(value_name = "FILE|ROBOT|TASK")]
    pub(crate) subject: String,

    /// Straight line from the origin to this output position, rest to rest
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    pub(crate) line: Option<Point>,

    /// Bézier curve with these control points
    #[arg(long, value_name = "X,Y X,Y ...", value_parser = points, allow_hyphen_values = true)]
    pub(crate) bezier: Option<Points>,

    /// Duration in seconds
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(crate) duration: Option<f64>,

    /// Degree of the line's timing polynomial, 9 if not given
    #[arg(long, conflicts_with = "bezier")]
    pub(crate) degree: Option<usize>,

    /// Number of samples, both ends included; 501 or the task's own if not given
    #[arg(long)]
    pub(crate) samples: Option<usize>,

    /// Contributions of shape sets to the acceleration, 1 in sum; sets not named rest. By default the
    /// set without an actuator does it all, or else the smallest shape is sought
    #[arg(long, value_name = "SET=C,...", value_delimiter = ',', value_parser = assignment)]
    pub(crate) weights: Vec<(String, f64)>,

    /// What the optimisation of a gain plan makes small: position if not given
    #[arg(long, value_enum)]
    pub(crate) objective: Option<Objective>,

    /// How the shape trajectory is found: gain, or the task's own, if not given
    #[arg(long, value_enum)]
    pub(crate) method: Option<Method>,

    /// Standing before and after the motion in which a refined plan may lean already
    #[arg(long, value_name = "SECONDS")]
    pub(crate) standing: Option<f64>,

    /// Folder for the plan as CSV, JSON and bytes, and its report
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,

    /// Draw the plan, into the output folder or here
    #[arg(long)]
    pub(crate) plot: bool,

    /// Write the motion as CSV
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,

    /// Write the plan as JSON
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,

    /// Write a plot
    #[arg(long, value_name = "FILE")]
    pub(crate) svg: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) parameters: ParameterArgs,
}

const INSPECT_EXAMPLES: &str = "\
A plan file has a version, a checksum, and the name and fingerprint of its robot: a CRC of the names and
values of the robot's parameters. It is refused if it was cut or altered, or if its robot is another.

Examples:
  shapebot inspect plans/walk.plan
  shapebot inspect walk.csv --robot my.robot --param m_b=80
  shapebot inspect walk.csv -o walk.plan    conversion, by the name's ending: csv, json or plan";

/// Forms of a plan file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PlanForm {
    /// Comma-separated values, one row per sample
    Csv,
    /// The same as JSON
    Json,
    /// The binary form that a controller evaluates in place
    Plan,
}

#[derive(Args, Debug)]
#[command(after_help = INSPECT_EXAMPLES)]
pub(crate) struct InspectArgs {
    /// Plan as CSV, JSON or bytes, as `shapebot plan -o` writes it
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,

    /// Robot that the plan has to be for: the bundled one of the plan's name if not given
    #[arg(long, value_name = "FILE|ROBOT")]
    pub(crate) robot: Option<String>,

    /// Write the plan in the form that the file's ending or --format says
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Form of the output
    #[arg(long, value_enum, requires = "output")]
    pub(crate) format: Option<PlanForm>,

    #[command(flatten)]
    pub(crate) parameters: ParameterArgs,
}

/// A point of the output space.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Point(pub(crate) Vec<f64>);

/// Several points of the output space.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Points(pub(crate) Vec<Point>);

fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{text}` is not a finite number")),
    }
}

fn point(text: &str) -> Result<Point, String> {
    text.split(',').map(number).collect::<Result<_, _>>().map(Point)
}

fn points(text: &str) -> Result<Points, String> {
    text.split_whitespace().map(point).collect::<Result<_, _>>().map(Points)
}

fn assignment(text: &str) -> Result<(String, f64), String> {
    let (name, value) =
        text.split_once('=').ok_or_else(|| format!("`{text}` is not NAME=VALUE"))?;
    Ok((name.trim().to_owned(), number(value)?))
}

#[cfg(test)]
mod tests {
    use super::{Cli, Point, Points, assignment, point, points};
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn points_are_lists_of_finite_numbers() {
        assert_eq!(point("2,-0.5"), Ok(Point(vec![2.0, -0.5])));
        assert_eq!(
            points("0,0  1,2"),
            Ok(Points(vec![Point(vec![0.0, 0.0]), Point(vec![1.0, 2.0])]))
        );
        assert!(point("2,x").is_err() && point("nan").is_err() && point("").is_err());
    }

    #[test]
    fn assignments_need_a_name_and_a_number() {
        assert_eq!(assignment("m_b=70.3"), Ok(("m_b".to_owned(), 70.3)));
        assert!(assignment("m_b").is_err() && assignment("m_b=1e999").is_err());
    }
}
