//! Whatever comes in: no panic, bounded answers, no torque that was not asked for by the rules.

mod common;

use common::{ByHand, drives, enabled, node_id, torques};
use proptest::prelude::*;
use shapebot_bus::Frame;
use shapebot_drive::DataType;
use shapebot_nodes::{
    Channel, Node, NodeFault, NodeKind, NodeSettings, Physical, Plant, Quantity, Reading, Rotors,
};

fn any_frame() -> impl Strategy<Value = Frame> {
    let id = prop_oneof![
        Just(0x000_u16),
        Just(0x080),
        Just(0x601),
        Just(0x201),
        Just(0x77F),
        0..0x800_u16,
    ];
    let data = proptest::collection::vec(any::<u8>(), 0..=8);
    (id, data).prop_map(|(id, data)| Frame::new(id, &data))
}

/// SDO requests with likely commands and objects.
fn any_request() -> impl Strategy<Value = Frame> {
    let command = prop_oneof![
        any::<u8>(),
        Just(0x40),
        Just(0x23),
        Just(0x2F),
        Just(0x2B),
        Just(0x60),
        Just(0x70),
        Just(0x21)
    ];
    let index = prop_oneof![
        Just(0x1008_u16),
        Just(0x1017),
        Just(0x1016),
        Just(0x1400),
        Just(0x1600),
        Just(0x1800),
        Just(0x1A00),
        Just(0x6040),
        Just(0x6060),
        Just(0x6072),
        Just(0x60C2),
        any::<u16>(),
    ];
    (command, index, 0..10_u8, any::<u32>()).prop_map(|(command, index, sub, value)| {
        let [low, high] = index.to_le_bytes();
        let [a, b, c, d] = value.to_le_bytes();
        Frame::new(0x601, &[command, low, high, sub, a, b, c, d])
    })
}

fn all_kinds() -> Vec<Node> {
    let reading = Reading::Quantity { quantity: Quantity::Coordinate(0), scale: 1e-3 };
    let at = |sub| shapebot_drive::object(0x2100, sub);
    let channels = vec![
        Channel { object: at(1), kind: DataType::I16, reading },
        Channel { object: at(2), kind: DataType::U8, reading: Reading::Sequence },
        Channel { object: at(3), kind: DataType::U8, reading: Reading::Health },
    ];
    let imu = NodeSettings { channels, ..NodeSettings::new("imu", node_id(1), NodeKind::Sensor) };
    let legs = NodeSettings::new("legs", node_id(1), NodeKind::Legs { travel_us: 300_000 });
    vec![common::drive(1, 0), Node::new(&imu), Node::new(&legs)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_frames_are_survived_with_few_answers(
        frames in proptest::collection::vec(prop_oneof![any_frame(), any_request()], 0..300),
    ) {
        for mut node in all_kinds() {
            let mut plant = Rotors::new(1, 0.01);
            let (mut time, mut now) = (0, 20_000);
            let mut out = Vec::new();
            node.poll(&mut Physical::new(&mut plant, &mut time, now), &mut out);
            for frame in &frames {
                out.clear();
                now += 150;
                let mut physical = Physical::new(&mut plant, &mut time, now);
                node.receive(frame, &mut physical, &mut out);
                node.poll(&mut physical, &mut out);
                prop_assert!(out.len() <= 16, "{out:?}");
                prop_assert!(plant.torque(0).abs() <= 3.0);
            }
        }
    }

    #[test]
    fn there_is_no_torque_without_operation_enabled(
        commands in proptest::collection::vec((any::<i16>(), any::<u16>()), 1..40),
    ) {
        let mut network = enabled(1);
        for command in commands {
            network.cycle(&[command]);
            let enabled = network.node(0).unwrap().power_state()
                == Some(shapebot_nodes::PowerState::OperationEnabled);
            let torque = torques(&network, 1)[0];
            prop_assert!(enabled || torque == 0.0, "{torque}");
            prop_assert!(torque.abs() <= 1.0, "0x6072 is 1000 per mille");
        }
    }
}

#[test]
fn a_flood_of_sdo_requests_is_answered_one_by_one_in_bounded_memory() {
    let mut network = drives(1);
    network.pass(30_000);
    let mut answers = 0;
    for _ in 0..2000 {
        for _ in 0..4 {
            network.put(0x601, &[0x40, 0x08, 0x10, 0, 0, 0, 0, 0]);
        }
        answers += network.pass(1000).len();
    }
    assert_eq!(answers, 8000);
}

#[test]
fn an_imu_counts_samples_and_shows_its_faults() {
    let mut nodes = all_kinds();
    let imu = nodes.remove(1);
    let bus = shapebot_bus::VirtualBus::new(1_000_000, 0);
    let mut plant = Rotors::new(1, 0.01);
    plant.drive(0, 0.01);
    plant.advance(0.1);
    plant.drive(0, 0.0);
    let angle = plant.motor(0).angle;
    let mut network = shapebot_nodes::Network::new(vec![bus], vec![(0, imu)], plant);
    network.pass(30_000);
    for (index, sub, value, size) in [
        (0x1A00, 1, 0x2100_0110, 4),
        (0x1A00, 2, 0x2100_0208, 4),
        (0x1A00, 3, 0x2100_0308, 4),
        (0x1A00, 0, 3, 1),
        (0x1800, 2, 1, 1),
        (0x1800, 1, 0x4000_0181, 4),
    ] {
        network.write(1, (index, sub), value, size).unwrap();
    }
    network.put(0, &[1, 0]);
    let mut sample = || {
        network.put(0x080, &[]);
        let frames = network.pass(2000);
        let frame = frames.iter().find(|frame| frame.standard_id() == Some(0x181)).unwrap();
        let [low, high, sequence, health] = frame.exactly::<4>().unwrap();
        let time = network.time() as f64 * 1e-6;
        (i16::from_le_bytes([low, high]), sequence, health, time)
    };
    let (first, sequence, health, time) = sample();
    // The rotor goes on with 0.1 rad/s.
    let expected = (angle + 0.1 * (time - 0.002)) * 1e3;
    assert!((f64::from(first) - expected).abs() <= 0.51, "{first}, {expected}");
    assert_eq!((sample().1, health), (sequence.wrapping_add(1), 0));
    network.inject(0, NodeFault::StaleSensor);
    let stale = {
        network.put(0x080, &[]);
        network.pass(2000)
    };
    network.put(0x080, &[]);
    assert_eq!(network.pass(2000), stale, "values and sequence stay");
    network.heal(0);
    network.inject(0, NodeFault::InvalidSensor);
    network.inject(0, NodeFault::Unhealthy(7));
    network.put(0x080, &[]);
    let frames = network.pass(2000);
    let bytes = frames[0].exactly::<4>().unwrap();
    assert_eq!((bytes[0], bytes[1], bytes[3]), (0x00, 0x80, 7));
}

#[test]
fn legs_take_their_time_and_go_down_when_the_master_is_gone() {
    let mut nodes = all_kinds();
    let legs = nodes.remove(2);
    let bus = shapebot_bus::VirtualBus::new(1_000_000, 0);
    let mut network = shapebot_nodes::Network::new(vec![bus], vec![(0, legs)], Rotors::new(0, 1.0));
    network.pass(30_000);
    network.write(1, (0x1016, 1), 0x007F_0064, 4).unwrap();
    network.put(0, &[1, 0]);
    network.put(0x77F, &[5]);
    let state = |network: &mut shapebot_nodes::Network<Rotors>| {
        network.read(1, (0x2001, 1)).unwrap() & 0xFF
    };
    assert_eq!(state(&mut network), 1, "down");
    network.write(1, (0x2000, 1), 1, 1).unwrap();
    for _ in 0..29 {
        network.pass(8000);
        network.put(0x77F, &[5]);
        assert_eq!(state(&mut network), 0, "on the way, {}", network.plant().legs);
    }
    network.pass(20_000);
    network.put(0x77F, &[5]);
    network.pass(20_000);
    assert_eq!(state(&mut network), 2, "up after 300 ms");
    assert_eq!(network.plant().legs, 0.0);
    // No heartbeat for 100 ms: down within 300 ms more.
    let frames = network.pass(100_000);
    assert_eq!(common::emergencies(&frames), [(1, 0x8130)]);
    network.pass(301_000);
    assert_eq!(state(&mut network), 1);
    assert_eq!(network.plant().legs, 1.0);
    network.inject(0, NodeFault::StuckLegs);
    assert_eq!(state(&mut network), 4, "fault");
}
