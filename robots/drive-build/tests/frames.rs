//! Emitted tables and codecs, compiled, against tables computed by hand.

mod common;

use common::description;
use shapebot_drive::{Frame, Object, SdoStep, sdo};

#[allow(dead_code, unreachable_pub, reason = "codecs of all frames, of which the tests use some")]
mod plain {
    include!("golden/ballbot3d.rs.txt");
}

#[allow(dead_code, unreachable_pub, reason = "codecs of all frames, of which the tests use some")]
mod shared {
    include!("golden/ballbot3d_1khz.rs.txt");
}

use plain::ballbot3d::{DRIVE, frames};

/// The compiled table is the one that is made at run time.
#[test]
fn compiled_tables_are_those_of_the_description() {
    for (name, compiled) in
        [("ballbot3d", &DRIVE), ("ballbot3d_1khz", &shared::ballbot3d_1khz::DRIVE)]
    {
        let description = description(name).unwrap_or_else(|errors| panic!("{errors}"));
        let tables = description.tables();
        assert_eq!(tables.table(), *compiled, "{name}");
    }
}

/// By hand: torque −299 is 0xFED5, controlword 15 is 0x000F; node 2 listens to 0x200 + 2.
#[test]
fn commands_have_these_bytes() {
    let command = frames::BackRpdo1 { force: -299, controlword: 0x000F };
    assert_eq!(command.encode(), Frame::new(0x202, &[0xD5, 0xFE, 0x0F, 0x00]));
    assert_eq!(frames::BackRpdo1::decode(&command.encode()), Some(command));
    let legs = frames::LegsRpdo1 { legs_command: 1 };
    assert_eq!(legs.encode(), Frame::new(0x211, &[1]));
    let both = shared::ballbot3d_1khz::frames::Shared191 { force_theta_x: 299, force_theta_y: -2 };
    assert_eq!(both.encode(), Frame::new(0x191, &[0x2B, 0x01, 0xFE, 0xFF]));
}

/// By hand: one count of torque is 1/1000 of 1 N·m at each of two motors, behind 105.8/6.335; one count
/// of position is 2π/16384 behind the same ratio; node 2 turns the other way.
#[test]
fn inputs_have_these_values() {
    let frame = Frame::new(0x182, &[0x37, 0x16, 10, 0, 0x00, 0x40, 0x00, 0x00]);
    let input = frames::BackTpdo1::decode(&frame).expect("a frame of this PDO");
    let expected = frames::BackTpdo1 {
        statusword: 0x1637,
        mode_display: 10,
        error_register: 0,
        position: 16384,
    };
    assert_eq!(input, expected);
    assert_eq!(input.encode(), frame);
    let radians = input.position as f32 * frames::BackTpdo1::POSITION_SCALE;
    let by_hand = -std::f32::consts::TAU * 6.335 / 105.8;
    assert!((radians - by_hand).abs() < 1e-6, "{radians}");
    let force = frames::FrontRpdo1::FORCE_SCALE;
    assert!((force - 2.0 * 105.8 / 6.335 / 1000.0).abs() < 1e-8, "{force}");
    // IMU: 0x03E8 = 1000 counts of 20 µrad, −1000 of 20 µrad, π in counts of 100 µrad, sound, sample 7.
    let imu = Frame::new(0x190, &[0xE8, 0x03, 0x18, 0xFC, 0xB8, 0x7A, 0, 7]);
    let input = frames::ImuTpdo1::decode(&imu).expect("a frame of this PDO");
    let expected =
        frames::ImuTpdo1 { phi_x: 1000, phi_y: -1000, heading: 31416, health: 0, sequence: 7 };
    assert_eq!(input, expected);
    assert_eq!(frames::ImuTpdo1::PHI_X_SCALE, 2e-5);
    // Wrong length, wrong identifier.
    assert_eq!(frames::ImuTpdo1::decode(&Frame::new(0x190, &[0; 7])), None);
    assert_eq!(frames::ImuTpdo1::decode(&Frame::new(0x191, &[0; 8])), None);
}

/// The whole set-up of node `front`, as bytes, by hand from CiA 301 and 402.
#[test]
fn set_up_has_these_frames() {
    let node = DRIVE.nodes[0];
    let requests: Vec<Vec<u8>> = node
        .setup
        .iter()
        .map(|step| match *step {
            SdoStep::Write { object, kind, value } => {
                sdo::download(node.id, object, kind, value).bytes().to_vec()
            }
            SdoStep::Expect { object, .. } => sdo::upload(node.id, object).bytes().to_vec(),
        })
        .collect();
    #[rustfmt::skip]
    let by_hand: [[u8; 8]; 43] = [
        [0x40, 0x00, 0x10, 0, 0, 0, 0, 0],          // device type
        [0x40, 0x18, 0x10, 4, 0, 0, 0, 0],          // serial number
        [0x23, 0x05, 0x10, 0, 0x80, 0, 0, 0],       // SYNC on 0x80
        [0x23, 0x06, 0x10, 0, 0xD0, 0x07, 0, 0],    // each 2000 us
        [0x2F, 0xC2, 0x60, 1, 2, 0, 0, 0],          // 2
        [0x2F, 0xC2, 0x60, 2, 0xFD, 0, 0, 0],       // times 10^-3 s
        [0x40, 0x06, 0x10, 0, 0, 0, 0, 0],          // both read back
        [0x40, 0xC2, 0x60, 1, 0, 0, 0, 0],
        [0x40, 0xC2, 0x60, 2, 0, 0, 0, 0],
        [0x23, 0x16, 0x10, 1, 0xFA, 0, 0x7F, 0],    // master 127 within 250 ms
        [0x2B, 0x17, 0x10, 0, 0x64, 0, 0, 0],       // own heartbeat each 100 ms
        [0x40, 0x76, 0x60, 0, 0, 0, 0, 0],          // rated torque
        [0x2B, 0x72, 0x60, 0, 0x04, 0x07, 0, 0],    // at most 1796 per mille: 30 * 6.335 / 105.8 N*m
        [0x2B, 0x07, 0x60, 0, 1, 0, 0, 0],          // connection lost: fault
        [0x2B, 0x5A, 0x60, 0, 0, 0, 0, 0],
        [0x2B, 0x5B, 0x60, 0, 0, 0, 0, 0],
        [0x2B, 0x5C, 0x60, 0, 0, 0, 0, 0],
        [0x2B, 0x5D, 0x60, 0, 1, 0, 0, 0],
        [0x2B, 0x5E, 0x60, 0, 0, 0, 0, 0],
        [0x2F, 0x60, 0x60, 0, 10, 0, 0, 0],         // cyclic synchronous torque
        [0x23, 0x00, 0x14, 1, 0x01, 0x02, 0, 0x80], // RPDO 1 off
        [0x2F, 0x00, 0x14, 2, 1, 0, 0, 0],          // synchronous
        [0x2F, 0x00, 0x16, 0, 0, 0, 0, 0],
        [0x23, 0x00, 0x16, 1, 0x10, 0, 0x71, 0x60], // target torque, 16 bits
        [0x23, 0x00, 0x16, 2, 0x10, 0, 0x40, 0x60], // controlword, 16 bits
        [0x2F, 0x00, 0x16, 0, 2, 0, 0, 0],
        [0x2B, 0x00, 0x14, 5, 10, 0, 0, 0],         // deadline 10 ms
        [0x23, 0x00, 0x14, 1, 0x01, 0x02, 0, 0],    // on
        [0x23, 0x01, 0x14, 1, 0x01, 0x03, 0, 0x80], // RPDO 2 to 4 off
        [0x23, 0x02, 0x14, 1, 0x01, 0x04, 0, 0x80],
        [0x23, 0x03, 0x14, 1, 0x01, 0x05, 0, 0x80],
        [0x23, 0x00, 0x18, 1, 0x81, 0x01, 0, 0xC0], // TPDO 1 off, no remote requests
        [0x2F, 0x00, 0x18, 2, 1, 0, 0, 0],
        [0x2F, 0x00, 0x1A, 0, 0, 0, 0, 0],
        [0x23, 0x00, 0x1A, 1, 0x10, 0, 0x41, 0x60], // statusword
        [0x23, 0x00, 0x1A, 2, 0x08, 0, 0x61, 0x60], // mode display
        [0x23, 0x00, 0x1A, 3, 0x08, 0, 0x01, 0x10], // error register
        [0x23, 0x00, 0x1A, 4, 0x20, 0, 0x64, 0x60], // position, 32 bits
        [0x2F, 0x00, 0x1A, 0, 4, 0, 0, 0],
        [0x23, 0x00, 0x18, 1, 0x81, 0x01, 0, 0x40], // on
        [0x23, 0x01, 0x18, 1, 0x81, 0x02, 0, 0xC0], // TPDO 2 to 4 off
        [0x23, 0x02, 0x18, 1, 0x81, 0x03, 0, 0xC0],
        [0x23, 0x03, 0x18, 1, 0x81, 0x04, 0, 0xC0],
    ];
    assert_eq!(requests, by_hand);
}

/// Gaps in a shared PDO: the drive of the second field skips the first one, an INTEGER16.
#[test]
fn shared_frames_are_mapped_with_gaps() {
    let drive = shared::ballbot3d_1khz::DRIVE;
    let left = drive.nodes.iter().find(|node| node.name == "left").expect("a node");
    let mapped = |sub| {
        let wanted = Object::receive_mapping(2, sub);
        left.setup.iter().find_map(|step| match step {
            SdoStep::Write { object, value, .. } if *object == wanted && *value > 2 => Some(*value),
            _ => None,
        })
    };
    assert_eq!((mapped(1), mapped(2)), (Some(0x0003_0010), Some(0x6071_0010)));
    let polarity = |name: &str| {
        let node = drive.nodes.iter().find(|node| node.name == name).expect("a node");
        node.setup.iter().find_map(|step| match step {
            SdoStep::Write { object: Object::POLARITY, value, .. } => Some(*value),
            _ => None,
        })
    };
    assert_eq!((polarity("left"), polarity("right")), (Some(0), Some(0xE0)));
}
