//! The bus in virtual time against the rules of ISO 11898-1.

use std::sync::{Arc, Mutex};

use proptest::prelude::*;
use shapebot_bus::{
    Bus, BusError, Effect, EndpointId, ErrorState, Event, EventKind, Frame, Limits, Port, Select,
    VirtualBus, bits,
};

const MBIT: u32 = 1_000_000;

fn bus_of(count: usize) -> (VirtualBus, Vec<EndpointId>) {
    let mut bus = VirtualBus::new(MBIT, 1);
    let ids = (0..count).map(|k| bus.attach(&format!("node {k}"))).collect();
    (bus, ids)
}

fn taken(bus: &mut VirtualBus, id: EndpointId) -> Vec<(u32, u64)> {
    std::iter::from_fn(|| bus.take(id)).map(|r| (r.frame.raw_id(), r.time)).collect()
}

/// Everything that happens on a bus, kept.
fn record(bus: &mut VirtualBus) -> Arc<Mutex<Vec<Event>>> {
    let events = Arc::new(Mutex::new(Vec::new()));
    let sink = Arc::clone(&events);
    bus.observe(move |event| sink.lock().unwrap().push(*event));
    events
}

#[test]
fn frames_arrive_after_exactly_their_bits() {
    // Identifier 0 without data: 34 bits, 6 stuff bits, 10 bits to the end of frame (see `bits`).
    let (mut bus, ids) = bus_of(2);
    bus.send(ids[0], Frame::new(0, &[])).unwrap();
    bus.send(ids[0], Frame::new(0, &[])).unwrap();
    bus.advance(1000);
    // The second one starts after three bits of intermission.
    assert_eq!(taken(&mut bus, ids[1]), [(0, 50), (0, 103)]);
    assert_eq!(bus.busy(), 106);
}

#[test]
fn bit_rates_scale_the_time() {
    let mut bus = VirtualBus::new(250_000, 0);
    let [a, b] = ["a", "b"].map(|name| bus.attach(name));
    bus.send(a, Frame::new(0, &[])).unwrap();
    bus.advance(1000);
    assert_eq!(taken(&mut bus, b), [(0, 200)]);
}

#[test]
fn the_lowest_identifier_wins_whoever_asked_first() {
    let (mut bus, ids) = bus_of(4);
    for (k, id) in [(0, 0x701), (1, 0x181), (2, 0x080)] {
        bus.send(ids[k], Frame::new(id, &[])).unwrap();
    }
    bus.advance(1000);
    let order: Vec<u32> = taken(&mut bus, ids[3]).iter().map(|(id, _)| *id).collect();
    assert_eq!(order, [0x080, 0x181, 0x701]);
}

#[test]
fn a_frame_on_the_wire_is_not_interrupted() {
    let (mut bus, ids) = bus_of(3);
    bus.send(ids[0], Frame::new(0x701, &[0; 8])).unwrap();
    bus.advance(20);
    bus.send(ids[1], Frame::new(0x001, &[])).unwrap();
    bus.advance(1000);
    let order: Vec<u32> = taken(&mut bus, ids[2]).iter().map(|(id, _)| *id).collect();
    assert_eq!(order, [0x701, 0x001]);
}

#[test]
fn data_frames_win_against_remote_and_standard_against_extended() {
    let id = shapebot_drive::standard(0x155).unwrap();
    let data = Frame::new(0x155, &[1]);
    let remote = Frame::remote(id, 1).unwrap();
    let wide = shapebot_drive::extended(0x155 << 18).unwrap();
    let extended = Frame::checked(wide, &[1]).unwrap();
    assert!(bits::arbitration(&data) < bits::arbitration(&remote));
    assert!(bits::arbitration(&remote) < bits::arbitration(&extended));
}

#[test]
fn two_senders_of_one_identifier_collide_until_both_are_bus_off() {
    let (mut bus, ids) = bus_of(3);
    let events = record(&mut bus);
    bus.send(ids[0], Frame::new(0x181, &[1])).unwrap();
    bus.send(ids[1], Frame::new(0x181, &[2])).unwrap();
    bus.advance(10_000);
    let events = events.lock().unwrap();
    let errors = events.iter().filter(|e| matches!(e.kind, EventKind::Error { .. })).count();
    // The transmit error counter grows by 8: 256 after 32 tries.
    assert_eq!(errors, 32);
    let off = events.iter().filter(|e| matches!(e.kind, EventKind::BusOff(_))).count();
    assert_eq!(off, 2);
    assert_eq!(taken(&mut bus, ids[2]), []);
    assert_eq!(bus.health(ids[2]).unwrap().receive_errors, 32);
}

#[test]
fn two_senders_of_one_frame_send_it_together() {
    let (mut bus, ids) = bus_of(3);
    for k in [0, 1] {
        bus.send(ids[k], Frame::new(0x181, &[7])).unwrap();
    }
    bus.advance(1000);
    assert_eq!(taken(&mut bus, ids[2]).len(), 1);
    assert_eq!(bus.waiting(ids[0]) + bus.waiting(ids[1]), 0);
}

#[test]
fn corrupted_frames_are_sent_again_and_counted() {
    let (mut bus, ids) = bus_of(2);
    let events = record(&mut bus);
    bus.inject(Select { limit: 3, ..Select::id(0x181) }, Effect::Corrupt);
    bus.send(ids[0], Frame::new(0x181, &[1, 2, 3])).unwrap();
    bus.advance(10_000);
    assert_eq!(taken(&mut bus, ids[1]).len(), 1);
    let errors =
        events.lock().unwrap().iter().filter(|e| matches!(e.kind, EventKind::Error { .. })).count();
    assert_eq!(errors, 3);
    // 3 × 8 − 1 at the sender; 3 − 1 at the receiver.
    assert_eq!(bus.health(ids[0]).unwrap().transmit_errors, 23);
    assert_eq!(bus.health(ids[1]).unwrap().receive_errors, 2);
}

#[test]
fn bus_off_after_32_errors_and_back_after_128_times_11_recessive_bits() {
    let (mut bus, ids) = bus_of(2);
    let events = record(&mut bus);
    bus.inject(Select { limit: 32, ..Select::default() }, Effect::Corrupt);
    bus.send(ids[0], Frame::new(0x181, &[])).unwrap();
    bus.advance(2700);
    let off = events.lock().unwrap().last().copied().unwrap();
    assert!(matches!(off.kind, EventKind::BusOff(id) if id == ids[0]), "{off:?}");
    assert!(matches!(bus.send(ids[0], Frame::new(1, &[])), Err(BusError::BusOff)));
    assert_eq!(bus.health(ids[0]).unwrap().state, ErrorState::BusOff);
    // The sequence that ends the last error frame counts; 127 of 11 µs remain.
    let back = off.time + 3 + 127 * 11;
    bus.advance(back - 1);
    assert_eq!(bus.health(ids[0]).unwrap().state, ErrorState::BusOff);
    bus.advance(back + 1);
    assert_eq!(bus.health(ids[0]).unwrap().state, ErrorState::Active);
    bus.send(ids[0], Frame::new(0x181, &[])).unwrap();
    bus.advance(back + 1000);
    assert_eq!(taken(&mut bus, ids[1]).len(), 1);
}

#[test]
fn bus_off_lasts_where_no_recovery_is_set() {
    let mut bus = VirtualBus::new(MBIT, 0);
    let a = bus.attach_with("a", Limits { recover: false, ..Limits::default() });
    bus.attach("b");
    bus.force_bus_off(a).unwrap();
    bus.advance(1_000_000);
    assert_eq!(bus.health(a).unwrap().state, ErrorState::BusOff);
    bus.restart(a).unwrap();
    assert_eq!(bus.health(a).unwrap().state, ErrorState::Active);
}

#[test]
fn a_node_alone_is_not_acknowledged_and_stays_error_passive() {
    let (mut bus, ids) = bus_of(1);
    bus.send(ids[0], Frame::new(0x181, &[])).unwrap();
    bus.advance(100_000);
    let health = bus.health(ids[0]).unwrap();
    assert_eq!((health.state, health.transmit_errors), (ErrorState::Passive, 128));
    assert_eq!(bus.waiting(ids[0]), 1);
    // Somebody comes: the frame gets through.
    let late = bus.attach("late");
    bus.advance(101_000);
    assert_eq!(taken(&mut bus, late).len(), 1);
}

#[test]
fn faults_do_what_they_say() {
    let send = |bus: &mut VirtualBus, id: EndpointId| {
        for k in 0..3 {
            bus.send(id, Frame::new(0x181, &[k])).unwrap();
        }
    };
    let bytes = |bus: &mut VirtualBus, id| -> Vec<u8> {
        std::iter::from_fn(|| bus.take(id)).map(|r| r.frame.bytes()[0]).collect()
    };
    let only = |to| Select { to: Some(to), limit: 1, ..Select::default() };
    let cases: [(Effect, &[u8]); 5] = [
        (Effect::Drop, &[1, 2]),
        (Effect::Reorder, &[1, 0, 2]),
        (Effect::Delay(5000), &[1, 2, 0]),
        (Effect::Duplicate, &[0, 0, 1, 2]),
        (Effect::Alter([0x80; 8]), &[0x80, 1, 2]),
    ];
    for (effect, expected) in cases {
        let (mut bus, ids) = bus_of(3);
        bus.inject(only(ids[1]), effect.clone());
        send(&mut bus, ids[0]);
        bus.advance(20_000);
        assert_eq!(bytes(&mut bus, ids[1]), expected, "{effect:?}");
        let others: &[u8] = if effect == Effect::Duplicate { &[0, 0, 1, 2] } else { &[0, 1, 2] };
        assert_eq!(bytes(&mut bus, ids[2]), others, "{effect:?}");
        assert_eq!(bus.faults_made(), 1);
    }
}

#[test]
fn jitter_is_bounded_and_repeats_with_its_seed() {
    let run = |seed| {
        let mut bus = VirtualBus::new(MBIT, seed);
        let [a, b] = ["a", "b"].map(|name| bus.attach(name));
        bus.inject(Select::id(0x080), Effect::Jitter(100));
        for k in 1..=50 {
            bus.advance(k * 1000);
            bus.send(a, Frame::new(0x080, &[])).unwrap();
        }
        bus.advance(60_000);
        taken(&mut bus, b)
    };
    let first = run(7);
    assert_eq!(first, run(7));
    assert_ne!(first, run(8));
    let late: Vec<u64> = first.iter().zip(1..).map(|((_, time), k)| time - k * 1000).collect();
    let exact = u64::from(bits::frame_bits(&Frame::new(0x080, &[])));
    assert!(late.iter().all(|late| (exact..=exact + 100).contains(late)), "{late:?}");
    assert!(late.iter().max().unwrap() - late.iter().min().unwrap() > 50);
}

#[test]
fn a_flood_is_bounded_and_cannot_stop_lower_identifiers() {
    let (mut bus, ids) = bus_of(3);
    let mut refused = 0;
    let mut syncs = 0;
    for cycle in 0..100 {
        for k in 0..100_u16 {
            let id = 0x200 + k;
            refused += usize::from(bus.send(ids[0], Frame::new(id, &[0xFF; 8])).is_err());
        }
        bus.send(ids[1], Frame::new(0x080, &[])).unwrap();
        bus.advance((cycle + 1) * 1000);
        assert!(bus.waiting(ids[0]) <= 64);
        // One frame of the flood at most is before SYNC: 135 µs, then SYNC itself.
        let got = taken(&mut bus, ids[0]);
        let sync = got.iter().find(|(id, _)| *id == 0x080).expect("SYNC got through");
        assert!(sync.1 - cycle * 1000 <= 135 + 55, "{sync:?} in cycle {cycle}");
        syncs += got.len();
    }
    assert_eq!(syncs, 100);
    assert!(refused > 0);
    assert!(bus.busy() > 95 * bus.now() / 100, "{} of {}", bus.busy(), bus.now());
    // Nobody took what node 2 received: 256 frames are kept, the others counted.
    assert_eq!(taken(&mut bus, ids[2]).len(), 256);
    assert!(bus.health(ids[2]).unwrap().overruns > 300);
}

#[test]
fn ports_share_a_bus() {
    let mut bus = VirtualBus::new(MBIT, 0);
    let ids = ["a", "b"].map(|name| bus.attach(name));
    let bus = Arc::new(Mutex::new(bus));
    let [mut a, mut b] = ids.map(|id| Port::new(Arc::clone(&bus), id));
    a.send(&Frame::new(0x123, &[1])).unwrap();
    let received = b.receive(1000).unwrap().unwrap();
    assert_eq!(received.frame, Frame::new(0x123, &[1]));
    assert!(b.receive(1000).unwrap().is_none());
    assert_eq!(b.now(), 1000);
}

fn any_frame() -> impl Strategy<Value = Frame> {
    let data = proptest::collection::vec(any::<u8>(), 0..=8);
    (0..0x800_u16, data).prop_map(|(id, data)| Frame::new(id, &data))
}

/// Stuff bits taken out again, as a receiver does it; `None` for six equal bits in a row.
fn unstuffed(wire: &[bool]) -> Option<Vec<bool>> {
    let (mut plain, mut run, mut last, mut skip) = (Vec::new(), 0, true, false);
    for bit in wire {
        run = if *bit == last { run + 1 } else { 1 };
        last = *bit;
        if run > 5 {
            return None;
        }
        if !skip {
            plain.push(*bit);
        }
        skip = run == 5;
    }
    Some(plain)
}

proptest! {
    #[test]
    fn stuffing_stays_below_the_worst_case_and_is_undone_by_a_receiver(frame in any_frame()) {
        let length = frame.len() as u32;
        prop_assert!(bits::bus_bits(&frame) <= bits::worst_case_bits(length));
        let wire = bits::stuffed(&frame);
        let stuff = bits::stuff_bits(&frame);
        prop_assert_eq!(wire.len() as u32, 34 + 8 * length + stuff);
        let plain = unstuffed(&wire).unwrap();
        prop_assert_eq!(plain.len() as u32, 34 + 8 * length);
        // A receiver that runs the CRC over data and CRC ends at zero.
        let rest = plain.iter().fold(0_u16, |crc, bit| {
            let feedback = *bit != (crc & 0x4000 != 0);
            ((crc << 1) & 0x7FFF) ^ if feedback { 0x4599 } else { 0 }
        });
        prop_assert_eq!(rest, 0);
    }

    #[test]
    fn all_frames_get_through_in_order_whatever_is_corrupted(
        frames in proptest::collection::vec(any_frame(), 1..40),
        seed in any::<u64>(),
    ) {
        let mut bus = VirtualBus::new(MBIT, seed);
        let [a, b] = ["a", "b"].map(|name| bus.attach(name));
        bus.inject(Select { probability: 0.2, ..Select::default() }, Effect::Corrupt);
        for frame in &frames {
            bus.send(a, *frame).unwrap();
            while bus.waiting(a) > 0 {
                let next = bus.next_event().unwrap();
                bus.advance(next);
            }
        }
        let got: Vec<Frame> = std::iter::from_fn(|| bus.take(b)).map(|r| r.frame).collect();
        prop_assert_eq!(got, frames);
    }
}
