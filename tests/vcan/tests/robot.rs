//! A simulated robot and its controller, two programs on vcan0 in real time, recorded by candump.

mod common;
mod traffic;

use common::{TASK, can_utils, drive, folder, on_vcan};
use shapebot_bus::candump;
use shapebot_drive::DriveTable;
use shapebot_tests::environment::say;
use std::fs;
use std::path::Path;
use traffic::Traffic;

/// How many times slower time may run before a computer is too busy for this test; at full pace twice.
const PACES: [u32; 4] = [1, 1, 3, 9];

/// Faults that say that a process did not run when it should have.
const LATE: [&str; 5] = ["SyncJitter", "MissedInputs", "ControllerSilent", "8700)", "8250)"];

/// Lateness that both programs forgive, ms of the bus: where others are kept from the processor, Linux takes
/// it from what runs under SCHED_FIFO for 50 ms of each second.
const SLACK: u32 = 60;

/// Both programs at a pace, `candump -L` beside them, which has the lowest right to the processor and gets
/// room for what it takes late. The log is in memory until the end: writing to the host's files takes time.
fn commands(pace: u32) -> String {
    let tool = env!("CARGO_BIN_EXE_vcan-shapebot");
    let how = format!("walk.toml --bus vcan0 --slow {pace} --slack {SLACK}");
    format!(
        "mkdir -p /dev/shm && mount -t tmpfs none /dev/shm || exit 70\n\
         candump -L -r 8388608 vcan0 >/dev/shm/dump.log & dump=$!\n\
         {tool} drive-sim {how} >nodes.txt 2>&1 & nodes=$!\n\
         sleep 1\n\
         {tool} run {how} >run.txt 2>&1; code=$?\n\
         sleep 1; kill $dump $nodes; wait\n\
         cp /dev/shm/dump.log dump.log\n\
         exit $code\n"
    )
}

/// Runs the task; what was on the bus, or what the master said of its lateness. `None` where user-mode
/// Linux is missing.
fn run(folder: &Path, pace: u32, table: &DriveTable<'_>) -> Option<Result<Traffic, String>> {
    let output = on_vcan(folder, &commands(pace))?;
    let text = |name| fs::read_to_string(folder.join(name)).unwrap_or_default();
    let said = text("run.txt");
    if !output.status.success() {
        let is_late = LATE.iter().any(|fault| said.contains(fault));
        assert!(is_late, "{said}\nnodes: {}\n{output:?}", text("nodes.txt"));
        return Some(Err(said));
    }
    Some(Ok(Traffic::read(&folder.join("dump.log"), table)))
}

#[test]
fn a_robot_is_driven_over_socketcan() {
    if !can_utils() {
        return;
    }
    let folder = folder("robot");
    fs::write(folder.join("walk.toml"), TASK).expect("the task");
    let description = drive(shapebot_drives::text("ballbot_planar").expect("a drive"));
    let tables = description.tables();
    let table = tables.table();
    for pace in PACES {
        let Some(result) = run(&folder, pace, &table) else { return };
        let period = table.timing.period_us * pace;
        match result {
            Ok(traffic) => {
                say(&format!("vcan0, SYNC each {period} us: {traffic}"));
                traffic.check(&table);
                assert_eq!(traffic.orders, 0, "nobody operates it");
                if traffic.keeps_time(period) {
                    return;
                }
            }
            Err(said) => say(&format!("vcan0, SYNC each {period} us: {}", said.trim())),
        }
    }
    panic!("this computer keeps no time");
}

/// Two drives and an IMU in one cycle, as the planar ballbot's are wired.
const CYCLE: [&str; 6] = [
    "080#",
    "181#3702000A00000000",
    "182#3702000A00000000",
    "190#000000000001",
    "201#00000F00",
    "202#00000F00",
];

/// A log of cycles of 2 ms, each with these frames.
fn log(cycles: &[&[&str]]) -> Traffic {
    let description = drive(shapebot_drives::text("ballbot_planar").expect("a drive"));
    let tables = description.tables();
    let mut entries = Vec::new();
    for (k, frames) in cycles.iter().enumerate() {
        for (at, frame) in frames.iter().enumerate() {
            let micros = 2000 * k + 100 * at;
            let line = format!("(0000000000.{micros:06}) vcan0 {frame}");
            entries.push(candump::entry(&line).expect("a line"));
        }
    }
    Traffic::of(entries, &tables.table())
}

#[test]
fn whole_cycles_are_told_from_others() {
    let whole = log(&[&CYCLE, &CYCLE, &CYCLE]);
    assert_eq!((whole.cycles, whole.complete, whole.ordered), (3, 3, 3));
    assert_eq!((whole.periods.as_slice(), whole.median_period()), (&[2000, 2000][..], 2000));
    assert!(whole.strange.is_empty() && whole.emergencies.is_empty(), "{whole:?}");

    let [sync, front, back, imu, to_front, to_back] = CYCLE;
    let lacks = [sync, front, back, to_front, to_back];
    let early = [sync, front, to_front, to_back, back, imu];
    let mixed = log(&[&CYCLE, &lacks, &early, &CYCLE]);
    assert_eq!((mixed.cycles, mixed.complete, mixed.ordered), (4, 3, 2));
}

#[test]
fn what_should_not_be_on_the_bus_is_noticed() {
    let strange = ["081#0087110000000000", "7C0#01", "181#37", "201#00", "201#FF7F0F00"];
    // Once the master has gone, the nodes have a right to complain.
    let found = log(&[&CYCLE, &strange, &CYCLE, &["082#0087110000000000"]]);
    assert_eq!(found.emergencies.len(), 1);
    assert_eq!(found.strange.len(), 3, "{:?}", found.strange);
    assert_eq!(found.beyond, 1);
}
