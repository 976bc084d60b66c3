//! Firmware on an emulated Cortex-M4F balances and drives the simulated ballbot over slcan, in lockstep.

use shapebot_bus::slcan::codec::{Decoder, Reply, Token, encode, reply};
use shapebot_drive::Frame;
use shapebot_drive::operator::{Order, Page, command};
use shapebot_drive::safety::{Request, State};
use shapebot_drive_build::Source;
use shapebot_dynamics::ShapeAccelerated as _;
use shapebot_generated::ballbot3d::{Ballbot3d, DESCRIPTION};
use shapebot_planner::value::{PlanView, RobotId, Sizes, encode_values, encoded_values_len};
use shapebot_rig::{Stage, World, network};
use shapebot_sim::{Plant, Scenario};
use shapebot_tests::copies::build_folder;
use shapebot_tests::emulator::{board, firmware};
use shapebot_tests::environment::say;
use std::io::{Read as _, Write as _};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// The firmware's tick, µs.
const TICK: u64 = 200;

/// Longest wait for the emulator's answer to a tick.
const PATIENCE: Duration = Duration::from_secs(20);

/// A line of 1 m in 4 s.
const TASK: &str = "robot = \"ballbot3d\"\nsamples = 401\nmethod = \"refined\"\n[motion]\n\
                    kind = \"line\"\ngoal = \"1, 0 m\"\nduration = \"4 s\"\n";

type View<'a> = PlanView<'a, f64, 2, 2, 4>;

/// The plan in double precision.
fn plan() -> Vec<u8> {
    let task = shapebot_tasks::parse("line.toml", TASK).unwrap();
    let id = RobotId::of(&DESCRIPTION);
    let robot = Ballbot3d::<f64>::from_model();
    shapebot_planning::plan(&robot, &task, &id).unwrap_or_else(|e| panic!("{e:?}")).files.binary
}

/// The same in single precision, with its length ahead.
fn in_memory(plan: &View<'_>) -> Vec<u8> {
    let sizes = Sizes { positions: 2, shapes: 2, forces: 4 };
    let nodes = plan.nodes();
    let step = (plan.end_time() - plan.start_time()) / (nodes - 1) as f64;
    let time = |node: usize| plan.start_time() + step * node as f64;
    let value = |node: usize, index: usize| {
        let state = plan.at(time(node));
        let motion = state.position.iter().flatten().chain(state.shape.iter().flatten());
        *motion.chain(&state.force).nth(index).unwrap()
    };
    let mut file = vec![0; encoded_values_len::<f32>(&sizes, nodes)];
    let id = RobotId::of(&DESCRIPTION);
    encode_values::<f32>(&id, &sizes, nodes, time, value, &mut file).unwrap();
    [&u32::try_from(file.len()).unwrap().to_le_bytes()[..], &file].concat()
}

/// The emulator, ended whatever happens.
struct Emulator(Child);

impl Drop for Emulator {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A serial line of the emulator.
struct Line {
    stream: UnixStream,
    decoder: Decoder,
}

impl Line {
    /// Asks for the flags; the frames that come before the answer.
    fn frames(&mut self) -> Vec<Frame> {
        let (mut frames, mut buffer, start) = (Vec::new(), [0; 512], Instant::now());
        loop {
            let count =
                self.stream.read(&mut buffer).unwrap_or_else(|e| panic!("serial line: {e}"));
            assert!(count > 0 && start.elapsed() < PATIENCE, "the emulator has ended");
            for byte in &buffer[..count] {
                let Some(Token::Line(line)) = self.decoder.push(*byte) else { continue };
                match reply(&line) {
                    Ok(Reply::Frame(frame, _)) => frames.push(frame),
                    Ok(Reply::Status(0)) => return frames,
                    other => panic!("{line:?}: {other:?}"),
                }
            }
        }
    }
}

/// Starts the firmware with a plan in its memory; its two lines.
fn start(program: &PathBuf, folder: &Path, plan: &[u8]) -> (Emulator, [Line; 2]) {
    std::fs::create_dir_all(folder).unwrap();
    let file = folder.join("plan.bin");
    std::fs::write(&file, plan).unwrap();
    let mut qemu = board(program);
    let loader = format!("loader,addr=0x21000000,force-raw=on,file={}", file.display());
    qemu.args(["-device", &loader]).stdout(Stdio::null());
    let listeners = ["drive", "body"].map(|bus| {
        let path = folder.join(bus);
        let _ = std::fs::remove_file(&path);
        qemu.arg("-chardev").arg(format!("socket,id={bus},path={}", path.display()));
        qemu.arg("-serial").arg(format!("chardev:{bus}"));
        UnixListener::bind(&path).unwrap()
    });
    let emulator = Emulator(qemu.spawn().unwrap());
    let lines = listeners.map(|listener| {
        let (stream, _) = listener.accept().unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        Line { stream, decoder: Decoder::default() }
    });
    (emulator, lines)
}

/// Simulation and firmware.
struct Bench<'a> {
    world: World<'a, Ballbot3d<f64>, 4, 2, 2>,
    lines: [Line; 2],
    state: State,
    fingerprint: u32,
    /// Bus and identifiers of commands and telemetry.
    operator: (usize, u16, u16),
    sequence: u8,
    now: u64,
    /// Largest lean since it was last set to zero, rad.
    lean: f64,
    /// Orders to send with the next tick.
    orders: Vec<Frame>,
}

impl Bench<'_> {
    /// A tick of simulation, then one of the firmware.
    fn tick(&mut self) {
        self.now += TICK;
        let mut inbox: [Vec<u8>; 2] = Default::default();
        while let Some((bus, received)) = self.world.receive(self.now) {
            inbox[bus].extend(encode(&received.frame, None).as_bytes());
        }
        for order in self.orders.drain(..) {
            inbox[self.operator.0].extend(encode(&order, None).as_bytes());
        }
        for (line, mut bytes) in self.lines.iter_mut().zip(inbox) {
            bytes.extend(b"F\r");
            line.stream.write_all(&bytes).unwrap();
        }
        for bus in 0..2 {
            for frame in self.lines[bus].frames() {
                if bus == self.operator.0 && frame.standard_id() == Some(self.operator.2) {
                    self.page(&frame);
                }
                self.world.send(bus, &frame).unwrap();
            }
        }
        let q = self.world.truth().unwrap().q;
        self.lean = self.lean.max(q[2].abs()).max(q[3].abs());
    }

    fn page(&mut self, frame: &Frame) {
        if let Some(Page::Status { state, fault, .. }) = Page::decode(frame.bytes()) {
            assert_eq!(fault, 0, "fault {fault} in {:?} at {} µs", self.state, self.now);
            self.state = State::of(state).unwrap();
        }
    }

    fn order(&mut self, order: Order) {
        self.sequence += 1;
        let bytes = command::encode(order, self.sequence, self.fingerprint);
        self.orders.push(Frame::new(self.operator.1, &bytes));
    }

    fn reach(&mut self, state: State, seconds: u64) {
        let end = self.now + seconds * 1_000_000;
        while self.state != state {
            assert!(self.now < end, "{:?} instead of {state:?} after {seconds} s", self.state);
            self.tick();
        }
    }

    /// Orders, and gets there.
    fn go(&mut self, request: Request, state: State, seconds: u64) {
        self.order(Order::Ask(request));
        self.reach(state, seconds);
    }

    fn stay(&mut self, seconds: u64) {
        let (state, end) = (self.state, self.now + seconds * 1_000_000);
        while self.now < end {
            self.tick();
            assert_eq!(self.state, state, "at {} µs", self.now);
        }
    }

    /// Where the robot is on the floor, m.
    fn place(&mut self, robot: &Ballbot3d<f64>) -> [f64; 2] {
        let q = self.world.truth().unwrap().q;
        robot.output(&[q[0], q[1]].into(), &[q[2], q[3]].into()).into()
    }
}

#[test]
fn firmware_balances_and_drives_the_simulated_ballbot() {
    let Some(program) = firmware("shapebot-balance", "balance") else { return };
    let file = plan();
    let view = View::open_any(&file).unwrap();
    let text = shapebot_drives::text("ballbot3d").unwrap();
    let description = Source::parse("ballbot3d.toml", text).unwrap().check(&DESCRIPTION).unwrap();
    let robot = Ballbot3d::<f64>::from_model();
    let scenario = Scenario::default();
    let plant = Plant::new(&robot, &robot, &scenario, 0.0005).unwrap();
    let world = network(&description, &robot, &plant, 1).unwrap();
    let (_emulator, lines) = start(&program, &build_folder("lockstep"), &in_memory(&view));
    let tables = description.tables();
    let table = tables.table();
    let to = table.operator;
    let mut bench = Bench {
        world,
        lines,
        state: State::Off,
        fingerprint: table.fingerprint,
        operator: (usize::from(to.bus), to.command, to.telemetry),
        sequence: 0,
        now: 0,
        lean: 0.0,
        orders: Vec::new(),
    };
    bench.order(Order::Hello);
    bench.reach(State::LegsDown, 5);
    bench.stay(1);
    bench.go(Request::Start, State::Balancing, 5);
    bench.go(Request::KeepStation, State::StationKeeping, 1);
    bench.stay(2);
    let standing = (bench.lean, bench.place(&robot));
    bench.lean = 0.0;
    bench.go(Request::Track, State::Tracking, 1);
    bench.reach(State::StationKeeping, 6);
    let driving = bench.lean;
    bench.stay(2);
    let place = bench.place(&robot);
    bench.go(Request::Stop, State::LegsDown, 5);
    let error = (place[0] - 1.0).hypot(place[1]);
    let drift = standing.1[0].hypot(standing.1[1]);
    say(&format!(
        "firmware over slcan, {:.1} s: standing {:.2}° of lean and {:.1} mm off, driving 1 m in 4 s \
         {:.2}° of lean, {:.1} mm from its end",
        bench.now as f64 * 1e-6,
        standing.0.to_degrees(),
        drift * 1e3,
        driving.to_degrees(),
        error * 1e3
    ));
    assert!(standing.0.to_degrees() < 1.0 && drift < 0.02, "{standing:?}");
    assert!(driving.to_degrees() > 0.5 && driving.to_degrees() < 6.0, "{driving}");
    assert!(error < 0.02, "{place:?}");
}
