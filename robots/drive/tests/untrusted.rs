//! Whatever is received, at whatever time: no panic, a bounded answer, a safe state.

mod common;

use common::{PLANAR, Run, SPATIAL, description};
use proptest::prelude::*;
use shapebot_drive::safety::{REQUESTS, State};
use shapebot_drive::{Command, Frame, Master, extended};

/// What somebody on the bus may do.
#[derive(Clone, Debug)]
enum Act {
    Receive(usize, u32, bool, Vec<u8>),
    Pass(u64),
    Request(usize),
    Force(f32),
}

/// Identifiers that mean something, and others.
fn identifier() -> impl Strategy<Value = u32> {
    let known = [
        0x000, 0x080, 0x081, 0x181, 0x182, 0x190, 0x191, 0x201, 0x211, 0x290, 0x521, 0x581, 0x582,
        0x591, 0x601, 0x701, 0x702, 0x710, 0x711, 0x77F,
    ];
    prop_oneof![3 => proptest::sample::select(known.to_vec()), 1 => 0_u32..0x2000_0000]
}

fn act() -> impl Strategy<Value = Act> {
    let bytes = proptest::collection::vec(any::<u8>(), 0..9);
    prop_oneof![
        8 => (0_usize..3, identifier(), any::<bool>(), bytes)
            .prop_map(|(bus, id, is_extended, bytes)| Act::Receive(bus, id, is_extended, bytes)),
        4 => prop_oneof![0_u64..3000, Just(2000), 0_u64..10_000_000].prop_map(Act::Pass),
        1 => (0..REQUESTS.len()).prop_map(Act::Request),
        1 => any::<f32>().prop_map(Act::Force),
    ]
}

fn frame(id: u32, is_extended: bool, bytes: &[u8]) -> Frame {
    if is_extended {
        extended(id).and_then(|id| Frame::checked(id, bytes)).unwrap_or(Frame::new(0, bytes))
    } else {
        Frame::new((id & 0x7FF) as u16, bytes)
    }
}

/// Torques of RPDOs with their own drive, and whether the legs are told to retract.
fn check_sent(state: State, sent: &[(usize, Frame)]) {
    for (_, frame) in sent {
        let id = frame.standard_id().expect("11 bits");
        if matches!(id, 0x201 | 0x202) {
            let torque = i16::from_le_bytes([frame.bytes()[0], frame.bytes()[1]]);
            assert!(torque.abs() <= 1796, "{torque}");
            assert!(torque == 0 || state.permits_torque(), "{torque} in {state:?}");
        }
        if id == 0x211 {
            assert_eq!(frame.bytes() == [1], state.retracts_legs(), "{state:?}");
        }
    }
}

fn drive(master: &mut Master<'_>, acts: &[Act], mut now: u64) {
    let mut force = 1.0;
    for act in acts {
        let mut sent = Vec::new();
        match act {
            Act::Receive(bus, id, is_extended, bytes) => {
                master.receive(*bus, &frame(*id, *is_extended, bytes), now);
            }
            Act::Pass(micros) => now += micros,
            Act::Request(index) => {
                master.request(REQUESTS[*index], now);
            }
            Act::Force(wanted) => force = *wanted,
        }
        master.poll(now, &mut |bus, frame| sent.push((bus, frame)));
        if master.inputs_due(now) {
            master.measure(now);
            master.command(&Command::new(&[force, force, force]), now, &mut |bus, frame| {
                sent.push((bus, frame));
            });
        }
        // Two frames for each node, its command, SYNC and heartbeat on two buses.
        assert!(sent.len() <= 48, "{} frames", sent.len());
        check_sent(master.state(), &sent);
        assert!(master.next_wake() < u64::MAX);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn a_master_that_boots(acts in proptest::collection::vec(act(), 1..200)) {
        let description = description("ballbot_planar", &PLANAR);
        let tables = description.tables();
        let table = tables.table();
        drive(&mut Master::new(&table), &acts, 0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(100) })]

    /// From a state in which there is torque.
    #[test]
    fn a_master_that_stands(acts in proptest::collection::vec(act(), 1..200)) {
        let description = description("ballbot_planar", &PLANAR);
        let tables = description.tables();
        let table = tables.table();
        let mut run = Run::new(&description, &table);
        run.forces = vec![5.0];
        run.stand();
        run.pass(10_000);
        let now = run.now();
        drive(&mut run.master, &acts, now);
    }
}

/// Foreign traffic at all of the bus' capacity, with higher priority than the nodes': inputs stop, which
/// is a fault, and nothing worse.
#[test]
fn a_flooded_bus_is_a_fault() {
    let description = description("ballbot3d", &SPATIAL);
    let tables = description.tables();
    let table = tables.table();
    let mut run = Run::new(&description, &table);
    run.stand();
    let begin = run.now();
    let bus = run.network.bus(0).expect("a bus");
    let flooder = bus.attach("flooder");
    let end = begin + 50_000;
    while run.now() < end && !run.master.faults().any() {
        let bus = run.network.bus(0).expect("a bus");
        while bus.waiting(flooder) < 4 {
            bus.send(flooder, Frame::new(0x010, &[0x55; 8])).expect("room");
        }
        run.pass(200);
    }
    assert!(run.master.faults().any(), "{:?}", run.master.counters());
    assert!(run.now() - begin <= 6 * 2000 + 400);
    assert_eq!(run.master.state(), State::FaultDown);
}

/// SDO answers and heartbeats that nobody asked for change nothing.
#[test]
fn replayed_answers_and_spoofed_heartbeats_change_nothing() {
    let description = description("ballbot_planar", &PLANAR);
    let tables = description.tables();
    let table = tables.table();
    let mut run = Run::new(&description, &table);
    run.stand();
    for _ in 0..100 {
        let now = run.now();
        for frame in [
            Frame::new(0x581, &[0x60, 0x17, 0x10, 0, 0, 0, 0, 0]),
            Frame::new(0x581, &[0x80, 0x17, 0x10, 0, 0, 0, 2, 6]),
            Frame::new(0x701, &[5]),
            Frame::new(0x181, &[0x08, 0, 10]),
            Frame::new(0x5FF, &[0; 8]),
        ] {
            run.master.receive(0, &frame, now);
        }
        run.pass(1000);
    }
    assert!(!run.master.faults().any(), "{:?}", run.master.faults());
    assert_eq!(run.master.counters().unexpected, 200);
    assert_eq!(run.master.counters().malformed, 100);
}
