//! Logs against lines of can-utils, and replay.

use std::path::Path;

use shapebot_bus::candump::{self, Direction, Entry};
use shapebot_bus::{Bus, Frame, Recorded, Replay, VirtualBus};

/// Lines in the forms that the manual of candump and log2asc show.
const LOG: &str = "\
(1436509052.249713) vcan0 044#2A366C2BBA
(1436509052.449847) vcan0 0F6#7ADFE07BD2 R
(1436509052.650004) can0 12345678#1122.33 T
(1436509052.850000) can0 123#R
(1436509052.850001) can0 123#R8
(1436509053.000000) can0 20000004#000C000000000000
";

fn read(text: &str) -> Result<Vec<Entry>, candump::LogError> {
    candump::read(Path::new("drive.log"), text.as_bytes())
}

#[test]
fn lines_of_can_utils_are_read() {
    let entries = read(LOG).unwrap();
    assert_eq!(entries.len(), 6);
    assert_eq!(entries[0].time, 1_436_509_052_249_713);
    assert_eq!(entries[0].interface, "vcan0");
    assert_eq!(entries[0].frame, Some(Frame::new(0x044, &[0x2A, 0x36, 0x6C, 0x2B, 0xBA])));
    assert_eq!(entries[1].direction, Some(Direction::Received));
    let id = shapebot_drive::extended(0x1234_5678).unwrap();
    assert_eq!(entries[2].frame, Frame::checked(id, &[0x11, 0x22, 0x33]));
    let id = shapebot_drive::standard(0x123).unwrap();
    assert_eq!(entries[3].frame, Frame::remote(id, 0));
    assert_eq!(entries[4].frame, Frame::remote(id, 8));
    assert_eq!(entries[5].frame, None, "an error frame");
}

#[test]
fn what_is_written_is_what_was_read() {
    let entries = read(LOG).unwrap();
    let again: Vec<String> = entries.iter().map(Entry::to_string).collect();
    let lines: Vec<&str> = LOG.lines().collect();
    assert_eq!(again[..2], lines[..2]);
    assert_eq!(
        again[2],
        lines[2].replace('.', "").replace("1436509052650004", "1436509052.650004")
    );
    assert_eq!(again[3..5], lines[3..5]);
}

#[test]
fn errors_say_file_line_and_what() {
    let cases = [
        ("12.5 can0 1#", "drive.log:2: a time such as (0000000012.345678) expected"),
        ("(1.5) can0 123#00", "drive.log:2: a time such as (0000000012.345678) expected"),
        ("(1.000005) can0", "drive.log:2: `(time) interface identifier#data` expected"),
        ("(1.000005) can0 123", "drive.log:2: `identifier#data` expected"),
        ("(1.000005) can0 800#00", "drive.log:2: the identifier has too many bits"),
        ("(1.000005) can0 12#00", "drive.log:2: an identifier of three or eight digits expected"),
        ("(1.000005) can0 123#0", "drive.log:2: pairs of hexadecimal digits expected"),
        ("(1.000005) can0 123#0011223344556677FF", "drive.log:2: more than eight bytes"),
        ("(1.000005) can0 123##1001122", "drive.log:2: a CAN FD frame, which is not supported"),
        ("(1.000005) can0 123#00 X", "drive.log:2: `R` or `T` expected after the frame"),
    ];
    for (line, expected) in cases {
        let error = read(&format!("(0.000000) can0 123#\n{line}\n")).unwrap_err();
        assert_eq!(error.to_string(), expected);
    }
    let long = format!("(0.000000) can0 123#{}\n", "0".repeat(10_000));
    assert!(read(&long).unwrap_err().to_string().contains("longer than"));
}

#[test]
fn a_recorded_bus_plays_again() {
    let mut bus = VirtualBus::new(1_000_000, 0);
    let ids = ["master", "drive"].map(|name| bus.attach(name));
    let bus = std::sync::Arc::new(std::sync::Mutex::new(bus));
    let [master, mut drive] = ids.map(|id| shapebot_bus::Port::new(bus.clone(), id));
    let mut master = Recorded::new(master, Vec::new(), "can0");
    master.send(&Frame::new(0x080, &[])).unwrap();
    drive.send(&Frame::new(0x181, &[0x37, 0x12])).unwrap();
    let received = master.receive(1000).unwrap().unwrap();
    let (_, log) = master.into_parts();
    let text = String::from_utf8(log).unwrap();
    assert_eq!(text.lines().count(), 2);
    assert!(text.starts_with("(0000000000.000000) can0 080# T\n"), "{text}");
    let mut replay = Replay::new(read(&text).unwrap());
    assert_eq!(replay.receive(100).unwrap(), None, "not before its time");
    assert_eq!(replay.receive(1000).unwrap(), Some(received));
    assert!(replay.is_over());
}
