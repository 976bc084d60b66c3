//! SocketCAN in user-mode Linux: kernel sockets, can-utils and our own transport on one virtual bus.

mod common;

use common::{can_utils, folder, on_vcan};
use shapebot_tests::copies::build_folder;

/// Identifier and data of each line that `candump -L` printed: `(time) vcan0 123#DEADBEEF`.
fn frames(log: &str) -> Vec<String> {
    log.lines().filter_map(|line| Some(line.split_whitespace().nth(2)?.to_owned())).collect()
}

#[test]
fn what_is_sent_is_what_candump_records() {
    if !can_utils() {
        return;
    }
    let sent = ["123#DEADBEEF", "080#", "1F334455#1122334455667788", "7FF#R4"];
    let mut commands = String::from("candump -L -n 4 vcan0 >dump.log &\nsleep 0.5\n");
    for frame in sent {
        commands += &format!("cansend vcan0 {frame} || exit 3\n");
    }
    commands += "wait\n";
    let folder = folder("candump");
    let Some(output) = on_vcan(&folder, &commands) else { return };
    assert!(output.status.success(), "{output:?}");
    let log = std::fs::read_to_string(folder.join("dump.log")).expect("the log");
    assert_eq!(frames(&log), sent);
}

#[test]
fn our_transport_talks_through_the_kernel() {
    const COUNT: u32 = 500;
    if !can_utils() {
        return;
    }
    let echo = env!("CARGO_BIN_EXE_vcan-echo");
    let commands = format!(
        "candump -L -n {} vcan0 >dump.log &\nsleep 0.5\n{echo} vcan0 {COUNT} 2000 || exit 3\nwait\n",
        2 * COUNT
    );
    let folder = folder("echo");
    let Some(output) = on_vcan(&folder, &commands) else { return };
    assert!(output.status.success(), "{output:?}");
    let log = std::fs::read_to_string(folder.join("dump.log")).expect("the log");
    let expected = (0..COUNT).flat_map(|k| {
        let request = format!("201#{:08X}", k.swap_bytes());
        [request, format!("181#{k:08X}")]
    });
    assert_eq!(frames(&log), expected.collect::<Vec<_>>());
}

#[test]
fn exit_codes_come_through_and_the_host_stays_as_it_was() {
    let outside = build_folder("vcan-must-not-exist");
    let commands = format!("touch {} 2>/dev/null && exit 3\nexit 42\n", outside.display());
    let Some(output) = on_vcan(&folder("exit"), &commands) else { return };
    assert_eq!(output.status.code(), Some(42), "{output:?}");
    assert!(!outside.exists());
}
