//! The CANopen master and the bus.

use crate::{unknown, with_bytes};
use core::hint::black_box;
use shapebot_bus::slcan::codec::{Decoder, Token, command, encode, reply};
use shapebot_drive::safety::Request;
use shapebot_drive::{
    Command, DriveTable, Fault, Frame, Master, NodeId, OperatorTable, SafetyTable, Timing, YawTable,
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

/// All that a master is asked for, in any order, on any frames, with tables of any length and content.
pub(crate) fn master_of_any_tables() {
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
