//! A simulated drive against frames and tables of CiA 301 and CiA 402.

mod common;

use common::{ByHand, drives, emergencies, enabled, node_id, torques};
use shapebot_bus::{Effect, Frame, Select, bits};
use shapebot_nodes::{Motion, Network, NmtState, NodeFault, Plant as _, PowerState, Rotors};

fn power(network: &Network<Rotors>) -> PowerState {
    network.node(0).unwrap().power_state().unwrap()
}

#[test]
fn a_node_boots_and_beats() {
    let mut network = drives(1);
    let frames = network.pass(30_000);
    assert_eq!(frames, [Frame::new(0x701, &[0])], "boot-up message");
    assert_eq!(network.node(0).unwrap().nmt(), NmtState::PreOperational);
    network.write(1, (0x1017, 0), 10, 2).unwrap();
    let frames = network.pass(35_000);
    assert_eq!(frames, [Frame::new(0x701, &[0x7F]); 3], "pre-operational, each 10 ms");
    network.put(0, &[1, 1]);
    assert!(network.pass(10_000).contains(&Frame::new(0x701, &[5])));
    network.put(0, &[2, 0]);
    assert!(network.pass(10_000).contains(&Frame::new(0x701, &[4])));
    // Stopped: no SDO.
    network.put(0x601, &[0x40, 0, 0x10, 0, 0, 0, 0, 0]);
    assert!(network.pass(5000).iter().all(|frame| frame.standard_id() != Some(0x581)));
    // Not for this node.
    network.put(0, &[1, 2]);
    assert!(network.pass(10_000).contains(&Frame::new(0x701, &[4])));
}

/// Statuswords without the bits that the standard leaves to the maker, after each controlword.
#[test]
fn controlwords_lead_through_the_states_of_the_standard() {
    let mut network = drives(1);
    network.pass(30_000);
    network.set_up(1);
    network.put(0, &[1, 0]);
    let steps: [(u16, u16, u16); 14] = [
        (0x0000, 0x4F, 0x40), // switch on disabled
        (0x0007, 0x4F, 0x40), // not without shutdown first
        (0x0006, 0x6F, 0x21), // 2: ready to switch on
        (0x0007, 0x6F, 0x23), // 3: switched on
        (0x000F, 0x6F, 0x27), // 4: operation enabled
        (0x0007, 0x6F, 0x23), // 5: disable operation
        (0x0006, 0x6F, 0x21), // 6: shutdown
        (0x0000, 0x4F, 0x40), // 7: disable voltage
        (0x0006, 0x6F, 0x21),
        (0x000F, 0x6F, 0x27), // 3 and 4 in one step
        (0x0006, 0x6F, 0x21), // 8: shutdown
        (0x000F, 0x6F, 0x27),
        (0x0000, 0x4F, 0x40), // 9: disable voltage
        (0x0002, 0x4F, 0x40), // quick stop from there: nothing
    ];
    for (controlword, mask, expected) in steps {
        network.cycle(&[(0, controlword)]);
        network.cycle(&[(0, controlword)]);
        let word = network.cycle(&[(0, controlword)])[0].unwrap().0;
        assert_eq!(word & mask, expected, "after {controlword:#06x}: {word:#06x}");
    }
}

#[test]
fn torque_that_comes_after_sync_k_acts_at_sync_k_plus_1() {
    let mut network = enabled(1);
    network.cycle(&[(200, 0x0F)]);
    assert_eq!(torques(&network, 1), [0.0], "stored, not acting");
    network.put(0x080, &[]);
    let sync = u64::from(bits::frame_bits(&Frame::new(0x080, &[])));
    let start = network.time();
    network.until(start + sync - 1);
    assert_eq!(torques(&network, 1), [0.0]);
    network.until(start + sync);
    assert_eq!(torques(&network, 1), [0.2], "200 per mille of 1 N·m");
}

#[test]
fn inputs_are_those_at_sync() {
    let mut network = enabled(1);
    for _ in 0..50 {
        network.cycle(&[(100, 0x0F)]);
    }
    network.cycle(&[(0, 0x0F)]);
    network.cycle(&[(0, 0x0F)]);
    // 0.1 N·m on 0.01 kg·m² from the second SYNC to the 52nd.
    let Motion { angle, rate } = network.plant_now().motor(0);
    assert!((rate - 10.0 * 0.1).abs() < 1e-9, "{rate}");
    let (_, position, torque) = network.cycle(&[(0, 0x0F)])[0].unwrap();
    let sync = 1e-6 * f64::from(bits::frame_bits(&Frame::new(0x080, &[])));
    let expected = ((angle + rate * sync) / std::f64::consts::TAU * 4096.0).floor();
    assert_eq!(f64::from(position), expected, "counts at the end of SYNC");
    assert_eq!(torque, 0);
}

#[test]
fn torque_is_limited_by_0x6072_and_the_statusword_says_so() {
    let mut network = enabled(1);
    network.write(1, (0x6072, 0), 300, 2).unwrap();
    for _ in 0..2 {
        network.cycle(&[(-900, 0x0F)]);
    }
    let (word, _, torque) = network.cycle(&[(-900, 0x0F)])[0].unwrap();
    assert_eq!(torques(&network, 1), [-0.3]);
    assert_eq!((torque, word >> 11 & 1), (-300, 1));
}

#[test]
fn no_torque_outside_operation_enabled_or_with_halt() {
    let mut network = enabled(1);
    for controlword in [0x10F, 0x07, 0x06, 0x00] {
        for _ in 0..3 {
            network.cycle(&[(500, 0x0F)]);
        }
        assert_eq!(torques(&network, 1), [0.5]);
        for _ in 0..3 {
            network.cycle(&[(500, controlword)]);
        }
        assert_eq!(torques(&network, 1), [0.0], "{controlword:#x}");
        for controlword in [0x06, 0x07, 0x0F] {
            network.cycle(&[(500, controlword)]);
        }
    }
    network.write(1, (0x6060, 0), 0, 1).unwrap();
    assert_eq!(torques(&network, 1), [0.0], "no mode");
}

#[test]
fn polarity_turns_torque_and_position() {
    let mut network = enabled(1);
    network.write(1, (0x607E, 0), 0b1110_0000, 1).unwrap();
    for _ in 0..20 {
        network.cycle(&[(100, 0x0F)]);
    }
    let (_, position, torque) = network.cycle(&[(100, 0x0F)])[0].unwrap();
    assert_eq!(torques(&network, 1), [-0.1]);
    assert!(position > 0, "{position}");
    assert_eq!(torque, 100);
}

#[test]
fn faults_are_latched_until_bit_7_rises() {
    let mut network = enabled(1);
    for _ in 0..2 {
        network.cycle(&[(500, 0x0F)]);
    }
    network.inject(0, NodeFault::Emergency(0x2310));
    assert_eq!(torques(&network, 1), [0.0]);
    let frames = network.pass(1000);
    assert_eq!(emergencies(&frames), [(1, 0x2310)]);
    assert_eq!(network.read(1, (0x603F, 0)), Ok(0x2310));
    assert_eq!(network.read(1, (0x1001, 0)), Ok(0b11), "generic and current");
    assert_eq!(network.read(1, (0x1003, 1)), Ok(0x2310));
    for controlword in [0x00, 0x06, 0x0F, 0x07] {
        network.cycle(&[(500, controlword)]);
        assert_eq!(power(&network), PowerState::Fault);
    }
    network.cycle(&[(0, 0x80)]);
    network.cycle(&[(0, 0x80)]);
    assert_eq!(power(&network), PowerState::SwitchOnDisabled);
    // Bit 7 stays: the next fault is not reset by it.
    network.inject(0, NodeFault::Emergency(0x4310));
    for _ in 0..5 {
        network.cycle(&[(0, 0x80)]);
    }
    assert_eq!(power(&network), PowerState::Fault);
    network.cycle(&[(0, 0x00)]);
    network.cycle(&[(0, 0x80)]);
    network.cycle(&[(0, 0x80)]);
    assert_eq!(power(&network), PowerState::SwitchOnDisabled);
}

#[test]
fn a_missing_rpdo_is_the_deadline_emergency_0x8250_and_a_fault() {
    let mut network = enabled(1);
    let endpoint = network.master(0);
    let until = network.time();
    network
        .bus(0)
        .unwrap()
        .inject(Select { from: endpoint, ids: 0x201..=0x201, ..Select::default() }, Effect::Drop);
    let mut seen = Vec::new();
    for _ in 0..8 {
        network.put(0x080, &[]);
        network.put(0x201, &[0, 0, 0x0F, 0]);
        let frames = network.pass(2000);
        seen.extend(emergencies(&frames).iter().map(|e| (*e, network.time() - until)));
    }
    assert_eq!(seen.len(), 1, "{seen:?}");
    assert_eq!(seen[0].0, (1, 0x8250));
    assert!(seen[0].1 <= 12_000, "10 ms after the last one: {seen:?}");
    assert_eq!(power(&network), PowerState::Fault);
}

#[test]
fn lost_sync_and_lost_heartbeats_stop_the_drive() {
    let mut network = enabled(1);
    network.write(1, (0x1400, 5), 0, 2).unwrap();
    let frames = network.pass(10_000);
    assert_eq!(emergencies(&frames), [(1, 0x8700)]);
    assert_eq!(power(&network), PowerState::Fault);

    let mut network = enabled(1);
    network.write(1, (0x1006, 0), 0, 4).unwrap();
    network.write(1, (0x1016, 1), 0x007F_0032, 4).unwrap();
    network.put(0x77F, &[5]);
    let mut found = Vec::new();
    for _ in 0..40 {
        network.put(0x201, &[0, 0, 0x0F, 0]);
        found.extend(emergencies(&network.pass(2000)));
    }
    assert_eq!(found, [(1, 0x8130)], "50 ms after the master's last heartbeat");
    assert_eq!(power(&network), PowerState::Fault);
}

#[test]
fn abort_connection_options_are_obeyed() {
    for (option, expected) in [
        (0, PowerState::OperationEnabled),
        (1, PowerState::Fault),
        (2, PowerState::SwitchOnDisabled),
        (3, PowerState::SwitchOnDisabled),
    ] {
        let mut network = enabled(1);
        network.write(1, (0x6007, 0), option, 2).unwrap();
        network.pass(20_000);
        assert_eq!(power(&network), expected, "0x6007 = {option}");
    }
}

#[test]
fn stop_reactions_go_down_the_torque_slope() {
    let mut network = enabled(1);
    // 500 per mille in 10 ms.
    network.write(1, (0x6087, 0), 50_000, 4).unwrap();
    for _ in 0..2 {
        network.cycle(&[(500, 0x0F)]);
    }
    network.cycle(&[(500, 0x02)]);
    network.put(0x080, &[]);
    network.pass(100);
    assert_eq!(power(&network), PowerState::QuickStopActive);
    let mut seen = Vec::new();
    for _ in 0..6 {
        network.put(0x080, &[]);
        network.put(0x201, &[0, 0, 0x02, 0]);
        network.pass(2000);
        seen.push(torques(&network, 1)[0]);
    }
    assert!(seen.windows(2).all(|pair| pair[1] <= pair[0]), "{seen:?}");
    assert!(seen[1] > 0.2 && seen[1] < 0.4, "after about 4 ms: {seen:?}");
    assert_eq!(seen[5], 0.0);
    assert_eq!(power(&network), PowerState::SwitchOnDisabled);
}

#[test]
fn periods_that_disagree_are_a_fault_before_there_is_torque() {
    let mut network = drives(1);
    network.pass(30_000);
    network.set_up(1);
    network.write(1, (0x60C2, 1), 4, 1).unwrap();
    network.put(0, &[1, 0]);
    for controlword in [0x06, 0x07, 0x0F, 0x0F] {
        network.cycle(&[(500, controlword)]);
    }
    assert_eq!(power(&network), PowerState::Fault);
    assert_eq!(torques(&network, 1), [0.0]);
}

#[test]
fn pdos_are_mapped_only_by_the_procedure_of_the_standard() {
    let mut network = drives(1);
    network.pass(30_000);
    network.set_up(1);
    let cases = [
        ((0x1A00, 0), 1, 1, 0x0800_0022),           // in use
        ((0x1800, 1), 0x4000_0182, 4, 0x0800_0022), // in use
        ((0x1A01, 1), 0x6071_0010, 4, 0x0604_0041), // not a transmit object
        ((0x1A01, 1), 0x6064_0010, 4, 0x0604_0041), // wrong length
        ((0x1A01, 1), 0x0005_0008, 4, 0x0604_0041), // gaps are for receive PDOs
        ((0x1A01, 1), 0x7777_0010, 4, 0x0602_0000),
        ((0x1A01, 0), 9, 1, 0x0609_0031),
        ((0x1801, 1), 0x4000_0581, 4, 0x0609_0030), // restricted identifier
        ((0x1801, 2), 252, 1, 0x0609_0030),
        ((0x6060, 0), 8, 1, 0x0609_0030),
        ((0x6041, 0), 0, 2, 0x0601_0002),
        ((0x6040, 0), 0, 4, 0x0607_0012),
        ((0x6064, 1), 0, 4, 0x0609_0011),
    ];
    for (at, value, size, code) in cases {
        assert_eq!(network.write(1, at, value, size), Err(code), "{at:x?} = {value:#x}");
    }
    for sub in 1..=3 {
        network.write(1, (0x1A01, sub), 0x6064_0020, 4).unwrap();
    }
    assert_eq!(network.write(1, (0x1A01, 0), 3, 1), Err(0x0604_0042), "twelve bytes");
    network.write(1, (0x1A01, 0), 2, 1).unwrap();
}

#[test]
fn one_shared_rpdo_feeds_four_drives_through_gaps() {
    let mut network = drives(4);
    network.pass(30_000);
    for node in 1..=4_u8 {
        network.set_up(node);
        network.write(node, (0x1400, 1), 0x8000_0210, 4).unwrap();
        network.write(node, (0x1600, 0), 0, 1).unwrap();
        // INTEGER16 gaps before the own torque and after it.
        for place in 1..=4 {
            let entry = if place == node { 0x6071_0010 } else { 0x0003_0010 };
            network.write(node, (0x1600, place), entry, 4).unwrap();
        }
        network.write(node, (0x1600, 0), 4, 1).unwrap();
        network.write(node, (0x1400, 1), 0x210, 4).unwrap();
        for controlword in [6, 7, 15] {
            network.write(node, (0x6040, 0), controlword, 2).unwrap();
        }
    }
    network.put(0, &[1, 0]);
    network.put(0x210, &[100, 0, 0x9C, 0xFF, 44, 1, 0, 0]);
    network.pass(500);
    network.put(0x080, &[]);
    network.pass(500);
    assert_eq!(torques(&network, 4), [0.1, -0.1, 0.3, 0.0]);
}

#[test]
fn short_and_long_pdos_are_reported() {
    let mut network = enabled(1);
    network.put(0x201, &[0, 0, 0x0F]);
    assert_eq!(emergencies(&network.pass(500)), [(1, 0x8210)]);
    network.put(0x201, &[0, 0, 0x0F, 0, 0]);
    assert_eq!(emergencies(&network.pass(500)), [(1, 0x8220)]);
}

#[test]
fn injected_faults_show_as_they_would() {
    let mut network = enabled(1);
    network.inject(0, NodeFault::FlippedSign);
    network.cycle(&[(100, 0x0F)]);
    network.cycle(&[(100, 0x0F)]);
    assert_eq!(torques(&network, 1), [-0.1]);
    network.heal(0);
    network.inject(0, NodeFault::Saturation(0.05));
    network.cycle(&[(100, 0x0F)]);
    network.cycle(&[(100, 0x0F)]);
    assert_eq!(torques(&network, 1), [0.05]);
    network.inject(0, NodeFault::StuckEncoder);
    let first = network.cycle(&[(100, 0x0F)])[0].unwrap().1;
    for _ in 0..50 {
        assert_eq!(network.cycle(&[(1000, 0x0F)])[0].unwrap().1, first);
    }
    network.inject(0, NodeFault::NoInputs);
    assert_eq!(network.cycle(&[(0, 0x0F)])[0], None);
    network.heal(0);
    assert!(network.cycle(&[(0, 0x0F)])[0].is_some());
    network.inject(0, NodeFault::Missing(shapebot_drive::Object::TARGET_TORQUE));
    assert_eq!(network.read(1, (0x6071, 0)), Err(0x0602_0000));
    network.inject(0, NodeFault::Reset);
    assert_eq!(torques(&network, 1), [0.0]);
    let frames = network.pass(30_000);
    assert!(frames.contains(&Frame::new(0x701, &[0])), "boot-up mid-run");
    network.inject(0, NodeFault::Dead);
    assert!(network.pass(100_000).is_empty());
    assert_eq!(network.node(0).unwrap().id(), node_id(1));
}

#[test]
fn a_drive_that_stays_bus_off_stops_by_itself() {
    let mut network = enabled(2);
    for _ in 0..3 {
        network.cycle(&[(100, 0x0F), (100, 0x0F)]);
    }
    let (bus, endpoint) = network.endpoint(0).unwrap();
    let mut cycles = 0;
    while torques(&network, 2)[0] != 0.0 {
        network.bus(bus).unwrap().force_bus_off(endpoint).unwrap();
        network.cycle(&[(100, 0x0F), (100, 0x0F)]);
        cycles += 1;
        assert!(cycles < 10);
    }
    // Two and a half cycles after the last SYNC, which was one cycle before; the RPDO's deadline of
    // 10 ms would come later.
    assert_eq!(cycles, 2);
    assert_eq!(torques(&network, 2)[1], 0.1);
}

#[test]
fn the_same_seed_gives_the_same_run() {
    let run = || {
        let mut network = enabled(2);
        let bus = network.bus(0).unwrap();
        bus.inject(Select { probability: 0.1, ..Select::default() }, Effect::Corrupt);
        bus.inject(Select { probability: 0.1, ..Select::id(0x080) }, Effect::Jitter(200));
        let mut all = Vec::new();
        for k in 0..100 {
            all.push(network.cycle(&[(k, 0x0F), (-k, 0x0F)]));
        }
        let rate = network.plant_now().motor(0).rate;
        (all, rate.to_bits())
    };
    assert_eq!(run(), run());
}
