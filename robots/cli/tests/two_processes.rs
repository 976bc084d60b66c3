//! `shapebot run` against `shapebot drive-sim`, two programs in real time on a pseudo-terminal.
#![cfg(unix)]

mod common;

use common::{Run, shapebot, skip};
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};

const TASK: &str = r#"
title = "Half a metre"
robot = "ballbot_planar"
method = "refined"
samples = 301

[motion]
kind = "line"
goal = "0.5 m"
duration = "3 s"
"#;

/// How many times slower time may run before a computer is too busy for these tests.
const PACES: [&str; 3] = ["1", "3", "9"];

/// Most error against the plan, m. A frame that is late costs accuracy: at a pace that the computer keeps it
/// is one or two millimetres.
const BOUND: f64 = 0.01;

/// Lateness that is forgiven, ms of the bus.
const SLACK: &str = "20";

/// Faults that say that a process did not run when it should have.
const LATE: [&str; 5] = ["SyncJitter", "MissedInputs", "ControllerSilent", "8700)", "8250)"];

/// Simulated nodes; they end with this.
struct Nodes {
    program: Child,
    port: String,
}

impl Nodes {
    /// `None`, after a line that says so, where there are no pseudo-terminals.
    fn start(folder: &Path, pace: &str) -> Option<Self> {
        let args = ["drive-sim", "walk.toml", "--bus", "pty", "--slow", pace, "--slack", SLACK];
        let mut program = Command::new(env!("CARGO_BIN_EXE_shapebot"))
            .args(args)
            .current_dir(folder)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut port = String::new();
        BufReader::new(program.stdout.take().unwrap()).read_line(&mut port).unwrap();
        let mut nodes = Self { program, port: port.trim().to_owned() };
        if nodes.port.is_empty() {
            let said = nodes.said();
            assert!(said.contains("pseudo-terminal: "), "{said}");
            skip("pty", said.trim());
            return None;
        }
        Some(nodes)
    }

    /// What they complained of, once they have ended.
    fn said(&mut self) -> String {
        let mut said = String::new();
        self.program.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        said
    }

    /// Stops them; what they complained of.
    fn stop(mut self) -> String {
        let ended = self.program.try_wait().unwrap();
        self.program.kill().unwrap();
        let said = self.said();
        assert!(ended.is_none(), "the nodes ended by themselves: {said}");
        said
    }
}

impl Drop for Nodes {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

/// RMSE against the plan, and error at the end, m.
fn errors(run: &Run) -> [f64; 2] {
    ["RMSE against plan", "at the end"].map(|name| figure(&run.stdout, name))
}

/// Both programs, at the first pace that this computer keeps; `None` where there are no pseudo-terminals.
fn over_a_pseudo_terminal(folder: &Path) -> Option<Run> {
    std::fs::write(folder.join("walk.toml"), TASK).unwrap();
    let mut late = String::new();
    for pace in PACES {
        let nodes = Nodes::start(folder, pace)?;
        let port = nodes.port.clone();
        let args = ["run", "walk.toml", "--bus", &port, "--slow", pace, "--slack", SLACK];
        let run = shapebot(folder, &args, "");
        let nodes = nodes.stop();
        if run.code == 0 && errors(&run).iter().all(|error| *error < BOUND) {
            return Some(run);
        }
        if run.code == 0 {
            late += &format!("time slowed {pace} times: {}", run.stdout);
            continue;
        }
        let is_late = LATE.iter().any(|fault| run.stderr.contains(fault));
        assert!(is_late, "time slowed {pace} times: {}{nodes}", run.stderr);
        late += &format!("time slowed {pace} times: {}", run.stderr);
    }
    panic!("this computer keeps no time:\n{late}");
}

/// The number after a name in the report.
fn figure(report: &str, name: &str) -> f64 {
    let line = report.lines().find_map(|line| line.trim().strip_prefix(name));
    let line = line.unwrap_or_else(|| panic!("no {name} in {report}"));
    line.split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn run_and_drive_sim_balance_and_drive_over_frames() {
    let folder = tempfile::tempdir().unwrap();
    let Some(run) = over_a_pseudo_terminal(folder.path()) else { return };
    let _ = std::io::stdout().write_all(run.stdout.as_bytes());
    let lean = figure(&run.stdout, "largest lean");
    assert!((0.5..10.0).contains(&lean), "{}", run.stdout);
    assert!(figure(&run.stdout, "cycles on the plan") > 1000.0, "{}", run.stdout);
    assert_eq!(figure(&run.stdout, "malformed or unknown frames"), 0.0, "{}", run.stdout);
}

#[test]
fn a_master_without_nodes_says_which_one_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("walk.toml"), TASK).unwrap();
    // The nodes of another drive: no legs, and a node-ID of theirs that is nobody's.
    let other = TASK.replace("ballbot_planar", "cartpole_planar");
    std::fs::write(path.join("other.toml"), other).unwrap();
    let Some(nodes) = Nodes::start(path, "1") else { return };
    let run = shapebot(path, &["run", "other.toml", "--bus", &nodes.port, "--slack", SLACK], "");
    run.fails(1, "Setup of node 0");
}

#[test]
fn virtual_time_is_not_slowed() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("walk.toml"), TASK).unwrap();
    let args = ["run", "walk.toml", "--bus", "virtual", "--slow", "2"];
    shapebot(folder.path(), &args, "").fails(2, "virtual time cannot be slowed");
}
