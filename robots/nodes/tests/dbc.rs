//! The DBC files of the bundled drives, read by Python's `cantools`.
#![cfg(unix)]

mod descriptions;
mod peers;

use std::fmt::Write as _;
use std::process::Command;

use shapebot_bus::candump::Entry;
use shapebot_bus::{Frame, Random};
use shapebot_drive_build::{DriveDescription, Message};

/// What `dbc.py` prints for a frame: each number is its count times the value of one count.
fn line(message: &Message, bytes: &[u8]) -> (String, Vec<f64>) {
    let mut signals: Vec<_> = message.signals.iter().collect();
    signals.sort_by_key(|signal| signal.name.clone());
    let mut text = format!("{:03x} {}", message.cob_id, message.name);
    let mut values = Vec::new();
    for signal in signals {
        let _ = write!(text, " {}", signal.name);
        #[expect(clippy::cast_precision_loss, reason = "counts have 32 bits")]
        values.push(signal.kind.decode(&bytes[signal.byte..]) as f64 * signal.scale);
    }
    (text, values)
}

/// Frames with random data for all messages of a bus, and what they hold.
fn frames(description: &DriveDescription, bus: usize) -> Vec<(Frame, String, Vec<f64>)> {
    let mut random = Random::new(5);
    let messages = description.messages();
    let here = messages.iter().filter(|message| message.bus == bus);
    let each = here.flat_map(|message| std::iter::repeat_n(message, 20));
    let mut frames = Vec::new();
    for message in each {
        let bytes = random.bits().to_le_bytes();
        let bytes = &bytes[..message.bytes];
        let (text, values) = line(message, bytes);
        frames.push((Frame::new(message.cob_id, bytes), text, values));
    }
    frames
}

#[test]
fn cantools_decodes_the_frames_of_every_bundled_drive_to_the_same_values() {
    let Some(python) = peers::python() else { return };
    let folder = peers::root().join("target/peers/can");
    std::fs::create_dir_all(&folder).unwrap();
    let mut compared = 0;
    for (name, _) in shapebot_drives::DRIVES {
        let description = descriptions::description(name);
        for bus in 0..description.buses.len() {
            let frames = frames(&description, bus);
            let entry = |frame: Frame| {
                let interface = "can0".to_owned();
                Entry { time: 0, interface, frame: Some(frame), direction: None }.to_string() + "\n"
            };
            let log: String = frames.iter().map(|(frame, _, _)| entry(*frame)).collect();
            let (dbc, path) =
                (folder.join(format!("{name}{bus}.dbc")), folder.join(format!("{name}{bus}.log")));
            std::fs::write(&dbc, description.dbc(bus).unwrap()).unwrap();
            std::fs::write(&path, log).unwrap();
            let output = Command::new(&python)
                .env("PYTHONDONTWRITEBYTECODE", "1")
                .arg(peers::script("dbc.py"))
                .args([dbc, path])
                .output()
                .unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            let text = String::from_utf8(output.stdout).unwrap();
            assert_eq!(text.lines().count(), frames.len(), "{name} {bus}");
            for (said, (_, expected, values)) in text.lines().zip(&frames) {
                let plain = |word: &str| word.split('=').next().unwrap_or_default().to_owned();
                let names: Vec<String> = said.split(' ').map(plain).collect();
                assert_eq!(names.join(" "), *expected, "{name}");
                let said: Vec<f64> = said
                    .split(' ')
                    .filter_map(|word| word.split_once('='))
                    .map(|(_, number)| number.parse().unwrap())
                    .collect();
                assert_eq!(said.len(), values.len());
                for (said, value) in said.iter().zip(values) {
                    assert!((said - value).abs() <= 1e-12 * value.abs(), "{name}: {said}, {value}");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 1000, "{compared}");
}
