//! Worst-case bus loads against figures worked out by hand.

mod common;

use common::description;
use shapebot_drive_build::{BusLoad, LoadFrame, Rate, worst_bits};

fn load(period: f64, frames: &[(usize, usize)]) -> f64 {
    let frames = frames.iter().flat_map(|&(count, bytes)| {
        let frame = LoadFrame { name: String::new(), cob_id: 0x100, bytes, rate: Rate::Input };
        std::iter::repeat_n(frame, count)
    });
    let load = BusLoad {
        bus: "bus".into(),
        bit_rate: 1_000_000,
        period,
        compute: 0.0,
        frames: frames.collect(),
    };
    100.0 * load.cyclic()
}

#[test]
fn frames_take_this_long() {
    assert_eq!([0, 4, 8].map(worst_bits), [55, 95, 135]);
}

/// Shares at 500 Hz and 1 kHz, rounded to percent.
#[test]
fn loads_of_typical_buses() {
    // (count, bytes): SYNC, RPDOs of 4 bytes, TPDOs of 8.
    let drive: &[(usize, usize)] = &[(1, 0), (4, 4), (4, 8)];
    let with_yaw: &[(usize, usize)] = &[(1, 0), (5, 4), (5, 8)];
    let with_imu: &[(usize, usize)] = &[(1, 0), (5, 4), (7, 8)];
    let with_arms: &[(usize, usize)] = &[(1, 0), (9, 4), (15, 8)];
    let arms: &[(usize, usize)] = &[(1, 0), (4, 4), (8, 8)];
    let shared: &[(usize, usize)] = &[(1, 0), (1, 8), (4, 8)];
    for (frames, slow, fast) in [
        (drive, 49.0, 98.0),
        (with_yaw, 60.0, 121.0),
        (with_imu, 74.0, 148.0),
        (with_arms, 147.0, 294.0),
        (arms, 76.0, 152.0),
        (shared, 37.0, 73.0),
    ] {
        let found = [2e-3, 1e-3].map(|period| load(period, frames));
        assert!((found[0] - slow).abs() <= 0.5 && (found[1] - fast).abs() <= 0.5, "{found:?}");
    }
}

/// By hand: rollers 4 · (95 + 135), yaw 95 + 135, IMU 135 + 115, SYNC 55: 1455 µs of 2000; once 65 µs of
/// a heartbeat before the inputs and before the commands, 200 µs of the controller.
#[test]
fn the_ballbots_bus_is_this_full() {
    let description = description("ballbot3d").unwrap_or_else(|errors| panic!("{errors}"));
    let load = &description.loads[0];
    assert!((load.cyclic() - 1455.0 / 2000.0).abs() < 1e-9, "{}", load.cyclic());
    assert!((load.last_frame() - 1785e-6).abs() < 1e-9, "{}", load.last_frame());
    // Six heartbeats each 100 ms and the master's each 50 ms, of 65 µs.
    assert!((load.background() - 8.0 * 65e-6 / 0.1).abs() < 1e-9, "{}", load.background());
    // Commands: 65 + 5 · 95 µs and the controller's 200 µs before the end of the cycle.
    assert_eq!(description.timing.input_window_us, 2000 - 200 - 540);
}
