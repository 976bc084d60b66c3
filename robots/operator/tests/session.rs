//! A client against the operator's end of a master, over a socket in real time.
#![cfg(unix)]

use shapebot_drive::Master;
use shapebot_drive::crc::crc32;
use shapebot_drive::operator::stream::{self, LONGEST, Reader};
use shapebot_drive::operator::{Commanded, Operator, Order, PlanStore, Refusal, Tuned};
use shapebot_drive::safety::Request;
use shapebot_drive_build::{DriveDescription, read};
use shapebot_dynamics::{Actuator, Coordinate, Description, Role};
use shapebot_operator::{Client, Error, SocketLink, line, state, view};
use std::io::{ErrorKind, Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

const COORDINATES: [Coordinate; 2] = [
    Coordinate {
        name: "theta",
        unit: "rad",
        role: Role::Position,
        actuated: true,
        lower: -200.0,
        upper: 200.0,
    },
    Coordinate {
        name: "phi",
        unit: "rad",
        role: Role::Shape,
        actuated: false,
        lower: -0.5,
        upper: 0.5,
    },
];

fn description() -> DriveDescription {
    let model = Description {
        name: "ballbot_planar",
        summary: "",
        coordinates: &COORDINATES,
        position_count: 1,
        shape_sets: &[],
        actuators: &[Actuator { name: "tau", unit: "N*m", limit: 60.0 }],
        parameters: &[],
        outputs: &[],
        output_unit: "m",
        frames: &[],
        points: &[],
        geometry: &[],
        friction: &[],
    };
    let text = shapebot_drives::text("ballbot_planar").expect("a bundled drive");
    read("ballbot_planar", text, &model).unwrap_or_else(|errors| panic!("{errors}"))
}

/// What was set.
const TUNED: Tuned = Tuned { factors: [0.75, 1.0, 1.0, 1.0], watch: true };

/// A master with one gain of 0 to 2.
struct Robot<'m, 't>(&'m mut Master<'t>);

impl Commanded for Robot<'_, '_> {
    fn request(&mut self, request: Request, now: u64) -> bool {
        self.0.request(request, now)
    }

    fn aim(&mut self, heading: f32) {
        self.0.aim(heading);
    }

    fn set_gain(&mut self, index: u8, value: f32) -> bool {
        index == 0 && (0.0..=2.0).contains(&value)
    }

    fn watch(&mut self, _on: bool, _now: u64) {}

    fn heard(&mut self, _now: u64) {}
}

/// A robot none of whose nodes answer, with its operator's end, until it is told to end.
fn robot(drive: &DriveDescription, mut stream: UnixStream, end: &AtomicBool) -> Vec<u8> {
    let tables = drive.tables();
    let table = tables.table();
    let mut master = Master::new(&table);
    let (mut active, mut pending) = (vec![0; 4096], vec![0; 4096]);
    let store = PlanStore::new(&mut active, &mut pending);
    let mut operator = Operator::new(table.fingerprint, store);
    let mut reader = Reader::default();
    stream.set_nonblocking(true).unwrap();
    let mut now = 0;
    while !end.load(Ordering::Relaxed) {
        now += u64::from(table.timing.period_us);
        master.poll(now, &mut |_, _| ());
        let mut bytes = [0; 256];
        match stream.read(&mut bytes) {
            Ok(count) => {
                for byte in &bytes[..count] {
                    if let Some((frame, len)) = reader.push(*byte) {
                        let _ = operator.receive(&frame[..len], &mut Robot(&mut master), now);
                    }
                }
            }
            Err(error) => assert_eq!(error.kind(), ErrorKind::WouldBlock, "{error}"),
        }
        if let Some(page) = operator.telemetry(&master, &TUNED) {
            let mut record = [0; LONGEST];
            let used = stream::encode(&page, &mut record);
            let _ = stream.write(&record[..used]);
        }
        std::thread::sleep(Duration::from_micros(200));
    }
    operator.plans().pending().unwrap_or_default().to_vec()
}

/// A client at work on such a robot; gives the plan that the robot has then.
fn with_robot(work: impl FnOnce(&mut Client<SocketLink>, &DriveDescription)) -> Vec<u8> {
    let drive = description();
    let (here, there) = UnixStream::pair().unwrap();
    let end = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let robot = scope.spawn(|| robot(&drive, there, &end));
        let mut client = Client::new(SocketLink::new(here), drive.fingerprint);
        let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            work(&mut client, &drive);
        }));
        end.store(true, Ordering::Relaxed);
        let plan = robot.join().unwrap();
        if let Err(panic) = done {
            std::panic::resume_unwind(panic);
        }
        plan
    })
}

/// A file with the ends of a plan file.
fn plan(len: usize) -> Vec<u8> {
    let mut file: Vec<u8> =
        b"SBPL".iter().copied().chain((0..=255).cycle()).take(len - 4).collect();
    let crc = crc32(&file).to_le_bytes();
    file.extend(crc);
    file
}

#[test]
fn orders_are_confirmed_or_refused() {
    with_robot(|client, _| {
        client.order(Order::Gain(0, 1.5)).expect("within its bounds");
        let bounds = client.order(Order::Gain(0, 2.5));
        assert!(matches!(bounds, Err(Error::Refused(Refusal::Bounds))), "{bounds:?}");
        let start = client.order(Order::Ask(Request::Start));
        assert!(matches!(start, Err(Error::Refused(Refusal::State))), "{start:?}");
        client.order(Order::Gain(0, 0.5)).expect("a refusal does not end the session");
    });
}

#[test]
fn plans_arrive_as_they_were_sent() {
    let file = plan(1003);
    let mut seen = 0;
    let received = with_robot(|client, _| {
        client.upload(&file, &mut |bytes| seen = bytes).expect("room enough");
        let long = client.upload(&plan(5000), &mut |_| ());
        assert!(matches!(long, Err(Error::Refused(Refusal::Plan))), "{long:?}");
        client.upload(&file, &mut |bytes| seen = bytes).expect("after a refusal");
    });
    assert!(seen >= file.len());
    assert_eq!(received, file);
}

#[test]
fn an_emergency_stop_needs_no_session_and_is_seen() {
    with_robot(|client, drive| {
        client.order(Order::Ask(Request::EmergencyStop)).unwrap();
        let mut down = false;
        for _ in 0..50 {
            client.listen(Duration::from_millis(20)).unwrap();
            let status = client.telemetry().status;
            down |= status.is_some_and(|status| status.fault.is_some_and(|(fault, _)| fault == 23));
        }
        assert!(down, "{:?}", client.telemetry());
        assert!(line(client.telemetry()).contains("emergency stop"));
        let page = view(client.telemetry(), drive, &["position", "velocity"]);
        assert!(page.contains("watch        armed") && !page.contains("velocity"), "{page}");
        for part in ["theta", "emergency stop", "N·m", "SYNC late by", state(10), "position 75 %"]
        {
            assert!(page.contains(part), "no `{part}` in\n{page}");
        }
    });
}

#[test]
fn silence_is_told_apart_from_refusal() {
    let (here, _there) = UnixStream::pair().unwrap();
    let silent = Client::new(SocketLink::new(here), 1).order(Order::Ask(Request::Balance));
    assert!(matches!(silent, Err(Error::Silent(_))), "{silent:?}");
    let drive = description();
    let (here, there) = UnixStream::pair().unwrap();
    let end = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| robot(&drive, there, &end));
        let mut other = Client::new(SocketLink::new(here), drive.fingerprint ^ 1);
        let refused = other.order(Order::Ask(Request::Balance));
        end.store(true, Ordering::Relaxed);
        assert!(matches!(refused, Err(Error::Refused(Refusal::Checksum))), "{refused:?}");
    });
}
