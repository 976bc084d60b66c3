//! Python's `canopen` and `python-can` against the simulated drive and our logs.
//!
//! `tests/peers/can/setup.sh` installs them; without them the tests skip with one line, or fail if the
//! environment variable `SHAPEBOT_REQUIRE` lists `canopen`. Where no pseudo-terminal can be opened they do
//! as well; that is called `pty`.
#![cfg(unix)]

mod common;
mod peers;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use shapebot_bus::candump::{self, Entry};
use shapebot_bus::serial::Serial;
use shapebot_bus::slcan::Adapter;
use shapebot_bus::{Bus as _, Effect, Frame, Select};
use shapebot_nodes::{Attached, PowerState, Rotors};

use common::ByHand as _;
use peers::{python, root, script, skip};

/// A new pseudo-terminal, or a line that says that there are none.
fn terminal() -> Option<Serial> {
    let opened = Serial::pseudo_terminal();
    opened.inspect_err(|error| skip("pty", &error.to_string())).ok()
}

#[test]
fn base_node_402_of_python_canopen_drives_the_simulated_drive_over_slcan() {
    let Some(python) = python() else { return };
    let Some(terminal) = terminal() else { return };
    let path = terminal.path().to_owned();
    let adapter = Adapter::new(terminal, "adapter");
    let rotors = Rotors::new(1, 0.01);
    let mut nodes = Attached::new(adapter, vec![common::drive(1, 0)], rotors);
    let mut peer = Command::new(python)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .arg(script("base_node.py"))
        .arg(path)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let end = Instant::now() + Duration::from_secs(60);
    let mut most = 0.0_f64;
    while peer.try_wait().unwrap().is_none() {
        nodes.run(nodes.now() + 1000).unwrap();
        most = most.max(nodes.plant().torque(0).abs());
        if Instant::now() > end {
            peer.kill().unwrap();
        }
    }
    let output = peer.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}\n{errors}");
    assert!(text.ends_with("done\n"), "{text}");
    assert_eq!(text.matches("holds:").count(), 26, "{text}");
    assert!((most - 0.5).abs() < 1e-12, "500 per mille of 1 N·m: {most}");
    assert_eq!(nodes.plant().torque(0), 0.0);
    let state = nodes.node(0).unwrap().power_state();
    assert_eq!(state, Some(PowerState::SwitchOnDisabled));
    assert_eq!(nodes.lost(), 0);
}

/// A shared buffer to write a log to.
#[derive(Clone, Default)]
struct Shared(std::sync::Arc<std::sync::Mutex<Vec<u8>>>);

impl std::io::Write for Shared {
    fn write(&mut self, buffer: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().write(buffer)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn python_can_reads_the_log_of_a_bus_and_we_read_what_it_writes() {
    let Some(python) = python() else { return };
    let mut network = common::drives(2);
    let log = Shared::default();
    let bus = network.bus(0).unwrap();
    bus.observe(candump::observer(log.clone(), "can0"));
    bus.inject(Select { limit: 1, ..Select::id(0x581) }, Effect::Corrupt);
    network.pass(30_000);
    network.set_up(1);
    let wide = shapebot_drive::extended(0x1234_5678).unwrap();
    // python-can's writer leaves out the length of remote frames.
    for frame in [Frame::checked(wide, &[1, 2]), Frame::remote(wide, 0)] {
        network.send(0, &frame.unwrap()).unwrap();
    }
    network.pass(1000);
    let log = log.0.lock().unwrap().clone();
    let entries = candump::read(Path::new("written"), &log[..]).unwrap();
    assert!(entries.len() > 40 && entries.iter().any(|entry| entry.frame.is_none()));

    let folder = root().join("target/peers/can");
    std::fs::create_dir_all(&folder).unwrap();
    let (ours, theirs) = (folder.join("ours.log"), folder.join("theirs.log"));
    std::fs::write(&ours, &log).unwrap();
    let output = Command::new(python)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .arg(script("logs.py"))
        .args([&ours, &theirs])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let expected: Vec<String> = entries.iter().map(line).collect();
    assert_eq!(text.lines().collect::<Vec<_>>(), expected);

    let again = std::fs::read(&theirs).unwrap();
    let again = candump::read(&theirs, &again[..]).unwrap();
    // python-can writes a direction with each frame, which was not known.
    let plain = |entry: &Entry| (entry.time, entry.frame);
    assert_eq!(
        again.iter().map(plain).collect::<Vec<_>>(),
        entries.iter().map(plain).collect::<Vec<_>>()
    );
}

/// What `logs.py` prints for an entry.
fn line(entry: &Entry) -> String {
    let (seconds, micros) = (entry.time / 1_000_000, entry.time % 1_000_000);
    let time = format!("{seconds}.{micros:06} {}", entry.interface);
    // python-can keeps of an error frame only that it was one.
    let Some(frame) = entry.frame else {
        return format!("{seconds}.{micros:06} None error extended 0 0 ");
    };
    let kind = if frame.is_remote() { "remote" } else { "data" };
    let wide = if frame.standard_id().is_some() { "standard" } else { "extended" };
    let data: String = frame.bytes().iter().map(|byte| format!("{byte:02x}")).collect();
    format!("{time} {kind} {wide} {:x} {} {data}", frame.raw_id(), frame.len())
}

/// A master by hand behind an adapter, in real time.
struct Hand(Adapter<Serial>);

impl common::ByHand for Hand {
    fn time(&self) -> u64 {
        self.0.now()
    }

    fn put(&mut self, id: u16, bytes: &[u8]) {
        self.0.send(&Frame::new(id, bytes)).unwrap();
    }

    fn until(&mut self, time: u64) -> Vec<Frame> {
        let bus = &mut self.0;
        std::iter::from_fn(|| bus.receive(time).unwrap()).map(|received| received.frame).collect()
    }

    /// A Python program answers within some milliseconds.
    fn pass(&mut self, micros: u64) -> Vec<Frame> {
        self.until(self.time() + 10 * micros)
    }
}

/// The peer for a master of ours: what `node402.py` does for frames written by hand.
#[test]
fn a_node_made_of_python_canopen_is_enabled_and_driven() {
    let Some(python) = python() else { return };
    let Some(terminal) = terminal() else { return };
    let mut peer = Command::new(python)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .arg(script("node402.py"))
        .arg(terminal.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut hand = Hand(Adapter::new(terminal, "adapter"));
    let (mut booted, mut enabled) = (false, false);
    let end = Instant::now() + Duration::from_secs(20);
    while !booted && Instant::now() < end && peer.try_wait().unwrap().is_none() {
        booted = hand.pass(1000).iter().any(|frame| *frame == Frame::new(0x701, &[0]));
    }
    if booted {
        hand.pass(20_000);
        hand.set_up(1);
        hand.put(0x000, &[1, 1]);
        hand.pass(5000);
        for (torque, controlword) in [(0_i16, 0x06), (0, 0x07), (0, 0x0F), (250, 0x0F), (250, 0x0F)]
        {
            let [a, b] = torque.to_le_bytes();
            hand.put(0x201, &[a, b, controlword, 0]);
            hand.put(0x080, &[]);
            hand.pass(3000);
        }
        hand.put(0x080, &[]);
        let last = hand.pass(3000);
        let tpdo = last.iter().find(|frame| frame.standard_id() == Some(0x181));
        let [word, _, _, _, _, _, low, high] =
            tpdo.and_then(Frame::exactly::<8>).unwrap_or_default();
        enabled = word & 0x6F == 0x27 && i16::from_le_bytes([low, high]) == 250;
    }
    drop(peer.stdin.take());
    let output = peer.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}\n{}", String::from_utf8_lossy(&output.stderr));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(enabled, "operation enabled with torque 250: {text}\n{errors}");
    assert!(text.ends_with("torque: 250\n"), "{text}");
    let states = "SWITCH ON DISABLED, READY TO SWITCH ON, SWITCHED ON, OPERATION ENABLED";
    assert!(text.contains(states), "{text}");
}
