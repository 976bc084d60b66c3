//! DBC files, read by somebody else's parser.

mod common;

use can_dbc::{Dbc, NumericValue, Signal, ValueType};
use common::{description, names};
use shapebot_drive::Frame;

fn number(value: NumericValue) -> f64 {
    match value {
        NumericValue::Uint(value) => value as f64,
        NumericValue::Int(value) => value as f64,
        NumericValue::Double(value) => value,
    }
}

/// The value of a little-endian signal in a frame, as its DBC line says.
fn value(signal: &Signal, frame: &Frame) -> f64 {
    let bytes = frame.bytes().iter().rev().fold(0_u64, |all, byte| all << 8 | u64::from(*byte));
    let raw = bytes >> signal.start_bit & ((1 << signal.size) - 1);
    let raw = match signal.value_type {
        ValueType::Signed if raw >> (signal.size - 1) == 1 => raw as i64 - (1 << signal.size),
        _ => raw as i64,
    };
    raw as f64 * signal.factor + signal.offset
}

/// Every PDO of every bundled description decodes to the same values through its DBC file and through
/// the tables.
#[test]
fn all_signals_have_the_values_of_the_tables() {
    for name in names() {
        let description = description(name).unwrap_or_else(|errors| panic!("{errors}"));
        let mut checked = 0;
        for bus in 0..description.buses.len() {
            let text = description.dbc(bus).expect("a bus");
            let dbc =
                Dbc::try_from(text.as_str()).unwrap_or_else(|error| panic!("{name}: {error:?}"));
            for message in description.messages().iter().filter(|message| message.bus == bus) {
                let read = dbc.messages.iter().find(|read| read.name == message.name);
                let read = read.unwrap_or_else(|| panic!("{name}: no {}", message.name));
                assert_eq!(read.id, can_dbc::MessageId::Standard(message.cob_id));
                assert_eq!(read.size, message.bytes as u64);
                let frame = Frame::new(
                    message.cob_id,
                    &[0x81, 0xFE, 0x13, 0xC4, 0x7A, 0x80, 0x05, 0x9D][..message.bytes],
                );
                assert_eq!(read.signals.len(), message.signals.len());
                for (signal, own) in read.signals.iter().zip(&message.signals) {
                    assert_eq!((&signal.name, &signal.unit), (&own.name, &own.unit));
                    let ours = own.kind.decode(&frame.bytes()[own.byte..]) as f64 * own.scale;
                    let theirs = value(signal, &frame);
                    assert!(
                        (ours - theirs).abs() <= 1e-12 * ours.abs(),
                        "{} {ours} {theirs}",
                        own.name
                    );
                    let bounds = number(signal.min)..=number(signal.max);
                    assert!(bounds.contains(&theirs), "{} {theirs} {bounds:?}", own.name);
                    checked += 1;
                }
            }
        }
        assert!(checked >= 8, "{name}: {checked}");
    }
}

/// By hand: −299 counts at the pair along x are −299 · 2 · 105.8/6.335/1000 N·m.
#[test]
fn a_torque_has_the_value_worked_out_by_hand() {
    let description = description("ballbot3d_1khz").unwrap_or_else(|errors| panic!("{errors}"));
    let text = description.dbc(0).expect("a bus");
    let dbc = Dbc::try_from(text.as_str()).expect("a DBC file");
    let message =
        dbc.messages.iter().find(|message| message.name == "shared_191").expect("a frame");
    let frame = Frame::new(0x191, &[0xD5, 0xFE, 0, 0]);
    let found = value(&message.signals[0], &frame);
    assert!((found + 299.0 * 2.0 * 105.8 / 6.335 / 1000.0).abs() < 1e-6, "{found}");
    assert_eq!(message.signals[0].unit, "N*m");
}
