//! `shapebot run --operator` under `command` and `monitor`: three programs and a socket.
#![cfg(target_os = "linux")]

mod common;

use common::shapebot;
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

const TASK: &str = r#"
title = "Out"
robot = "ballbot_planar"
method = "refined"
samples = 301

[motion]
kind = "line"
goal = "0.3 m"
duration = "2 s"
"#;

/// How long the robot may take to whatever it is asked for; its time may pass slower than ours.
const PATIENCE: Duration = Duration::from_secs(60);

/// A robot on simulated drives; it ends with this.
struct Robot<'f> {
    folder: &'f Path,
    program: Child,
    said: BufReader<ChildStdout>,
}

impl<'f> Robot<'f> {
    fn start(folder: &'f Path) -> Self {
        std::fs::write(folder.join("out.toml"), TASK).unwrap();
        let mut program = Command::new(env!("CARGO_BIN_EXE_shapebot"))
            .args(["run", "out.toml", "--operator", "robot.sock"])
            .current_dir(folder)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = BufReader::new(program.stdout.take().unwrap());
        let mut line = String::new();
        said.read_line(&mut line).unwrap();
        assert_eq!(line, "listening at robot.sock\n");
        Self { folder, program, said }
    }

    fn command(&self, order: &[&str]) -> common::Run {
        let args = [&["command", "ballbot_planar", "--socket", "robot.sock"], order].concat();
        shapebot(self.folder, &args, "")
    }

    /// Orders until it is taken: the state that it needs may be on its way.
    fn order(&self, order: &[&str]) {
        let end = Instant::now() + PATIENCE;
        loop {
            let run = self.command(order);
            if run.code == 0 {
                return;
            }
            let is_early = run.stderr.contains("state does not allow it");
            assert!(is_early && Instant::now() < end, "{order:?}: {}", run.stderr);
        }
    }

    /// What the monitor says in one line.
    fn line(&self) -> String {
        let args = ["monitor", "ballbot_planar", "--socket", "robot.sock", "--for", "0.2"];
        shapebot(self.folder, &args, "").ok().stdout
    }

    fn reaches(&self, state: &str) -> String {
        let end = Instant::now() + PATIENCE;
        loop {
            let line = self.line();
            if line.contains(state) {
                return line;
            }
            assert!(Instant::now() < end, "{state} expected: {line}");
        }
    }

    /// Ends it with SIGTERM; its last line, and whether it says that all is well.
    fn terminate(mut self) -> (String, bool) {
        let pid = self.program.id().to_string();
        assert!(Command::new("kill").arg(&pid).status().unwrap().success());
        let ended = self.program.wait().unwrap();
        let mut line = String::new();
        self.said.read_line(&mut line).unwrap();
        (line, ended.success())
    }
}

impl Drop for Robot<'_> {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

#[test]
fn a_robot_is_started_tuned_given_a_plan_and_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let robot = Robot::start(folder.path());
    robot.reaches("legs down");
    // What the state does not allow, and what is no gain.
    robot.command(&["track"]).fails(1, "the robot's state does not allow it");
    robot.command(&["gain", "position", "5"]).fails(1, "out of bounds");
    robot.command(&["gain", "size", "1"]).fails(2, "`position` (0.6 to 1.25)");
    robot.order(&["start"]);
    robot.order(&["keep-station"]);
    robot.order(&["gain", "position", "0.8"]);
    robot.order(&["watch", "off"]);
    // Another way than the task's: half as far.
    let back = TASK.replace("0.3 m", "-0.15 m");
    std::fs::write(folder.path().join("back.toml"), back).unwrap();
    shapebot(folder.path(), &["plan", "back.toml", "-o", "plans"], "").ok();
    robot.order(&["upload", "plans/back.plan"]);
    robot.order(&["track"]);
    robot.reaches("tracking a plan");
    robot.reaches("keeping station");
    robot.order(&["stop"]);
    robot.reaches("legs down");
    let (line, well) = robot.terminate();
    assert_eq!((line.as_str(), well), ("stopped on the legs\n", true));
    assert!(!folder.path().join("robot.sock").exists());
}

#[test]
fn a_watch_that_ends_without_a_word_brings_the_robot_down() {
    let folder = tempfile::tempdir().unwrap();
    let robot = Robot::start(folder.path());
    robot.order(&["start"]);
    robot.order(&["keep-station"]);
    // One that takes its leave does not.
    let watch = ["monitor", "ballbot_planar", "--socket", "robot.sock", "--watch"];
    let stays = [&watch[..], &["--for", "1.5"]].concat();
    let seen = shapebot(folder.path(), &stays, "").ok().stdout;
    assert!(seen.contains("keeping station") && !seen.contains("fault"), "{seen}");
    std::thread::sleep(Duration::from_secs(1));
    assert!(robot.line().contains("keeping station"));
    let mut monitor = Command::new(env!("CARGO_BIN_EXE_shapebot"))
        .args(watch)
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let (mut line, mut said) = (String::new(), BufReader::new(monitor.stdout.take().unwrap()));
    said.read_line(&mut line).unwrap();
    assert!(line.contains("keeping station"), "{line}");
    // Its signs of life are in nobody's way.
    shapebot(folder.path(), &["plan", "out.toml", "-o", "plans"], "").ok();
    robot.order(&["gain", "position", "1.1"]);
    robot.order(&["upload", "plans/out.plan"]);
    robot.order(&["track"]);
    robot.reaches("tracking a plan");
    monitor.kill().unwrap();
    monitor.wait().unwrap();
    let line = robot.reaches("down after a fault");
    assert!(line.contains("operator is silent"), "{line}");
    let (line, well) = robot.terminate();
    assert!(!well && line.is_empty(), "{line}");
}
