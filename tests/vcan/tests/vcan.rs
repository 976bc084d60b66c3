//! SocketCAN in user-mode Linux: kernel sockets, can-utils and our own transport on one virtual bus.

use shapebot_tests::copies::build_folder;
use shapebot_tests::environment::{root, skip};
use std::path::PathBuf;
use std::process::{Command, Output};

/// Runs shell commands with vcan0 up in a folder of their own. `None`, after a line that says so, where
/// user-mode Linux is missing.
fn on_vcan(name: &str, commands: &str) -> Option<(Output, PathBuf)> {
    let folder = build_folder(&format!("vcan/{name}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    let script = folder.join("commands.sh");
    std::fs::write(&script, commands).expect("the commands");
    let program = root().join("tests/vcan/vcan");
    let output = Command::new(program).arg("run").arg(&folder).arg(&script).output();
    let output = match output {
        Ok(output) => output,
        Err(error) => {
            skip("vcan", &error.to_string());
            return None;
        }
    };
    if output.status.code() == Some(77) {
        skip("vcan", String::from_utf8_lossy(&output.stderr).trim());
        return None;
    }
    Some((output, folder))
}

/// Whether can-utils are here; says so if not.
fn can_utils() -> bool {
    let here = Command::new("cansend").output().is_ok();
    if !here {
        skip("vcan", "no candump and cansend (Debian: can-utils)");
    }
    here
}

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
    let Some((output, folder)) = on_vcan("candump", &commands) else { return };
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
    let Some((output, folder)) = on_vcan("echo", &commands) else { return };
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
    let Some((output, _)) = on_vcan("exit", &commands) else { return };
    assert_eq!(output.status.code(), Some(42), "{output:?}");
    assert!(!outside.exists());
}
