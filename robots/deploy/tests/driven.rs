//! A deployed program on Linux drives a simulated robot over a pseudo-terminal, under an operator.
#![cfg(target_os = "linux")]

mod common;

use common::{build_folder, cargo, deployed_on};
use shapebot_bus::serial::Serial;
use shapebot_deploy::Target;
use shapebot_drive::operator::Order;
use shapebot_drive::safety::{Request, State};
use shapebot_drive_build::{DriveDescription, Source};
use shapebot_dynamics::LagrangianSystem as _;
use shapebot_generated::ballbot_planar::BallbotPlanar;
use shapebot_operator::{Client, Error, SocketLink};
use shapebot_planner::value::RobotId;
use shapebot_rig::{BusList, DriveSim};
use shapebot_sim::{Plant, Scenario};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};

type Robot = BallbotPlanar<f64>;

const NAME: &str = "ballbot_planar";

/// Half a metre, refined.
const TASK: &str = "robot = \"ballbot_planar\"\nsamples = 301\nmethod = \"refined\"\n[motion]\n\
                    kind = \"line\"\ngoal = \"0.5 m\"\nduration = \"3 s\"\n";

/// Lateness that is forgiven: a shared computer keeps no better time. Of the drive's limits, ms and cycles.
const TIMES: &str = "[timing]\njitter = \"40 ms\"\nmissed-fault = 20\n";
const CYCLES: &str = "[safety]\nstale-fault = 20\nsilent-fault = 20\n";
const SLACK: u64 = 40_000;

/// How long anything may take.
const PATIENCE: Duration = Duration::from_secs(20);

/// Where the ball is at last, m, and how far it leaned at most, rad.
struct End {
    ball: f64,
    lean: f64,
}

/// Simulated nodes on a pseudo-terminal, whose path is sent, until they are told to end.
fn nodes(drive: &DriveDescription, path: &mpsc::Sender<String>, end: &AtomicBool) -> End {
    let robot = Robot::from_model();
    let scenario = Scenario::default();
    let plant = Plant::new(&robot, &robot, &scenario, 0.0005).expect("a plant");
    let list = BusList::parse("pty", drive).expect("one bus");
    let opened = list.open_nodes(drive, None::<&Vec<u8>>);
    let (wired, paths) = opened.expect("a pseudo-terminal");
    let mut nodes = DriveSim::new(drive, &robot, &plant, wired).expect("nodes").forgiving(SLACK);
    path.send(paths[0].clone()).expect("somebody who waits");
    let mut lean = 0.0_f64;
    while !end.load(Ordering::Relaxed) {
        nodes.run(nodes.now() + 5_000).expect("the bus");
        // On its legs it may lean as it likes.
        lean = lean.max(if nodes.body().extension() < 0.5 { nodes.body().lean() } else { 0.0 });
    }
    End { ball: nodes.body().output()[0], lean }
}

/// The deployed program; it ends with this.
struct Program(Child);

impl Program {
    fn start(folder: &Path, port: &str) -> Self {
        let binary = build_folder("deployed").join("release/ballbot-planar-robot");
        let child = Command::new(binary)
            .args(["--socket", "robot.sock", "--bus", &format!("main={port}")])
            .current_dir(folder)
            .stderr(Stdio::piped())
            .spawn();
        Self(child.expect("the deployed program"))
    }

    /// Ends it with SIGTERM: whether it says that all is well, and what it said.
    fn terminate(mut self) -> (bool, String) {
        let asked = Command::new("kill").arg(self.0.id().to_string()).status();
        assert!(asked.expect("kill").success());
        let (mut said, mut errors) = (String::new(), self.0.stderr.take().expect("a pipe"));
        std::io::Read::read_to_string(&mut errors, &mut said).expect("text");
        (self.0.wait().expect("its end").success(), said)
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// An operator, who asks again while a state is on its way.
struct Operator(Client<SocketLink>);

impl Operator {
    fn connect(path: &Path, fingerprint: u32) -> Self {
        let end = Instant::now() + PATIENCE;
        loop {
            match SocketLink::open(path) {
                Ok(link) => return Self(Client::new(link, fingerprint)),
                Err(error) => assert!(Instant::now() < end, "{error}"),
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn ask(&mut self, request: Request) {
        let end = Instant::now() + PATIENCE;
        while let Err(error) = self.0.order(Order::Ask(request)) {
            assert!(matches!(error, Error::Refused(_)), "{request:?}: {error}");
            assert!(Instant::now() < end, "{request:?}: {error}, {:?}", self.0.telemetry().status);
        }
    }

    fn reaches(&mut self, state: State) {
        let end = Instant::now() + PATIENCE;
        loop {
            self.0.listen(Duration::from_millis(50)).expect("telemetry");
            let status = self.0.telemetry().status;
            if status.is_some_and(|status| status.state == state as u8) {
                return;
            }
            assert!(Instant::now() < end, "{state:?} expected: {status:?}");
        }
    }
}

fn plan(robot: &Robot) -> Vec<u8> {
    let task = shapebot_tasks::parse("task.toml", TASK).expect("a task");
    let id = RobotId::of(robot.description());
    let planned = shapebot_planning::plan(robot, &task, &id);
    planned.unwrap_or_else(|error| panic!("{error:?}")).files.binary
}

#[test]
fn the_deployed_program_balances_and_drives_a_simulated_robot() {
    if let Err(error) = Serial::pseudo_terminal() {
        return common::skip("pty", &error.to_string());
    }
    let robot = Robot::from_model();
    let text = shapebot_drives::text(NAME).expect("a drive");
    let text = text.replace("[timing]\n", TIMES).replace("[safety]\n", CYCLES);
    let source = Source::parse(NAME, &text).unwrap_or_else(|errors| panic!("{errors}"));
    let drive = source.check(robot.description()).unwrap_or_else(|errors| panic!("{errors}"));
    let folder = deployed_on(NAME, &text, Target::Linux, Some(&plan(&robot)));
    let Some(_) = cargo(folder.path(), &["build", "--release", "--offline", "--quiet"]) else {
        return;
    };
    let (end, (path, paths)) = (AtomicBool::new(false), mpsc::channel());
    let (robot_end, (well, said)) = std::thread::scope(|scope| {
        let nodes = scope.spawn(|| nodes(&drive, &path, &end));
        let port = paths.recv().expect("a port");
        let driven = std::panic::catch_unwind(|| driven(folder.path(), &port, drive.fingerprint));
        end.store(true, Ordering::Relaxed);
        let robot_end = nodes.join().expect("the nodes");
        (robot_end, driven.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    });
    assert!(well && said.contains("stopped in state LegsDown"), "{said}");
    let End { ball, lean } = robot_end;
    let summary =
        format!("{said}ball at {ball:.4} m, lean of at most {:.2} deg", lean.to_degrees());
    common::say(&summary);
    assert!((ball - 0.5).abs() < 0.01, "{summary}");
    assert!((0.5..10.0).contains(&lean.to_degrees()), "{summary}");
}

/// From power-up to the end of the plan, and down.
fn driven(folder: &Path, port: &str, fingerprint: u32) -> (bool, String) {
    let program = Program::start(folder, port);
    let mut operator = Operator::connect(&folder.join("robot.sock"), fingerprint);
    operator.reaches(State::LegsDown);
    operator.ask(Request::Start);
    operator.reaches(State::Balancing);
    operator.ask(Request::KeepStation);
    operator.ask(Request::Track);
    operator.reaches(State::Tracking);
    operator.reaches(State::StationKeeping);
    std::thread::sleep(Duration::from_secs(1));
    // SIGTERM brings it down on its legs.
    program.terminate()
}
