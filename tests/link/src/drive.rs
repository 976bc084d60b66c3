//! The CANopen master and the bus.

use crate::{unknown, with_bytes};
use core::hint::black_box;
use shapebot_bus::slcan::codec::{Decoder, Token, command, encode, reply};
use shapebot_drive::safety::Request;
use shapebot_drive::{
    Command, CommandTable, DataType, DriveTable, Fault, Frame, Master, NodeId, OperatorTable,
    Outputs, Pdo, Readings, SafetyTable, Timing, YawTable,
};

/// An example of tables.
pub(crate) fn tables() -> DriveTable<'static> {
    let timing = Timing {
        period_us: 0,
        input_window_us: 0,
        jitter_limit_us: 0,
        heartbeat_us: 0,
        boot_timeout_us: 0,
        sdo_timeout_us: 0,
        sdo_retries: 0,
        enable_timeout_us: 0,
        missed_warning: 0,
        missed_fault: 0,
    };
    let yaw = YawTable { axis: None, plane: [0; 2], stiffness: 0.0, damping: 0.0, rate_limit: 0.0 };
    let safety = SafetyTable {
        lean: &[],
        lean_start: 0.0,
        lean_limit: 0.0,
        lean_rate_start: 0.0,
        stale_fault: 0,
        silent_fault: 0,
        rise_timeout_us: 0,
        lower_timeout_us: 0,
        fault_deadline_us: 0,
    };
    let operator = OperatorTable { bus: 0, command: 0, telemetry: 0, master: NodeId::clamped(1) };
    DriveTable {
        name: "",
        robot: "",
        fingerprint: 0,
        coordinates: 0,
        timing,
        buses: &[],
        nodes: &[],
        axes: &[],
        commands: &[],
        yaw: Some(yaw),
        safety,
        operator,
    }
}

/// All that a generated reader calls.
fn every_number(data: &[u8; 8], to: &mut Readings<'_>) {
    let [b0, b1, b2, b3, ..] = *data;
    let (long, short) = (i32::from_le_bytes([b0, b1, b2, b3]), u16::from_le_bytes([b0, b1]));
    let (index, scale) = (unknown(0), unknown(0.0));
    to.statusword(short);
    to.mode_display(b0 as i8);
    to.error_register(b1);
    to.position(long, scale);
    to.velocity(long, scale);
    to.actual_torque(short as i16, scale);
    to.coordinate(index, long, scale);
    to.rate(index, short as i16, scale);
    to.heading(long, scale);
    to.heading_rate(short as i16, scale);
    to.yaw(long as u32, scale);
    to.sequence(b2);
    to.health(b3);
    to.legs_state(b0);
}

/// All that a generated writer calls.
fn every_field(from: &Outputs<'_>) -> [u8; 8] {
    let [b0, b1, ..] = DataType::I16.low_bytes(from.torque(unknown(0)).saturating_neg());
    let [b2, b3, ..] = DataType::U16.low_bytes(from.controlword(unknown(0)).into());
    let [b4, ..] = unknown(DataType::U8).low_bytes(from.legs_command().into());
    [b0, b1, b2, b3, b4, 0, 0, 0]
}

/// What generated tables have beside their numbers.
fn straight_line_code() {
    black_box(Pdo::new(0, 0, 0, &[]).read_by(every_number));
    black_box(CommandTable {
        bus: 0,
        cob_id: 0,
        cyclic: true,
        fields: &[],
        writer: Some(every_field),
    });
}

/// All that a master is asked for, in any order, on any frames, with tables of any length and content.
pub(crate) fn master_of_any_tables() {
    straight_line_code();
    let table = unknown(tables());
    let mut master = Master::new(&table);
    let mut out = |bus: usize, frame: Frame| {
        black_box((bus, frame));
    };
    while unknown(true) {
        let now = unknown(0_u64);
        match unknown(0) {
            0 => {
                with_bytes(|bytes| master.receive(unknown(0), &Frame::new(unknown(0), bytes), now))
            }
            1 => master.poll(now, &mut out),
            2 => {
                black_box(master.request(unknown(Request::Start), now));
            }
            3 => master.report(unknown(Fault::EmergencyStop), now),
            4 => master.command(&Command::new(unknown(&[][..])), now, &mut out),
            5 => {
                black_box(master.inputs_due(now));
                let measured = master.measure(now);
                let index = unknown(0);
                black_box((
                    measured.position(index),
                    measured.velocity(index),
                    measured.age(index),
                ));
            }
            6 => {
                master.plan(unknown(true), unknown(true));
                master.aim(unknown(0.0));
            }
            _ => {
                black_box((master.next_wake(), master.state(), master.applied(), master.legs()));
                let index = unknown(0);
                black_box((master.statusword(index), master.torque_counts(index)));
                black_box((master.motor_torque(index), master.is_alive(index)));
            }
        }
    }
}

/// Lines from a serial port, and frames to it.
pub(crate) fn slcan_of_any_bytes() {
    with_bytes(|bytes| {
        let mut decoder = Decoder::default();
        for byte in bytes {
            if let Some(Token::Line(line)) = decoder.push(*byte) {
                black_box((command(&line).is_ok(), reply(&line).is_ok()));
            }
        }
        let frame = Frame::new(unknown(0), bytes);
        black_box(encode(&frame, unknown(None)).as_bytes().len());
    });
}
