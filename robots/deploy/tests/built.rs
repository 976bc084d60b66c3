//! Deployed crates, built and tested with no checkout in reach.
//!
//! What cargo needs of crates.io has to be in its cache: it is, where this test was built, as far as the
//! features agree. `SHAPEBOT_REQUIRE=deploy` makes a machine without it fail instead of skip.

mod common;

use common::{build_folder, cargo, deployed, run, skip};
use shapebot_deploy::Target;
use std::path::Path;
use std::process::Command;

/// Tests, then the program's own usage.
fn builds_alone(name: &str, target: Target) {
    let folder = deployed(name, target);
    let Some(printed) = cargo(folder.path(), &["test", "--offline", "--quiet"]) else { return };
    assert!(printed.contains("5 passed; 0 failed"), "{printed}");
    if target == Target::Linux {
        let built = cargo(folder.path(), &["build", "--release", "--offline", "--quiet"]);
        assert!(built.is_some());
        let binary = format!("{}-robot", name.replace('_', "-"));
        let binary = build_folder("deployed").join("release").join(binary);
        let help = run(&binary, folder.path(), "deployed", &["--help"]);
        let help = String::from_utf8_lossy(&help.stdout).into_owned();
        assert!(help.contains("--bus NAME=PORT"), "{help}");
        let wrong = run(&binary, folder.path(), "deployed", &["--bus", "nowhere=can0"]);
        assert_eq!(wrong.status.code(), Some(2));
    }
}

#[test]
fn the_smallest_robot_builds_and_passes_its_tests_alone() {
    builds_alone("ballbot_planar", Target::Linux);
}

#[test]
fn the_largest_robot_builds_and_passes_its_tests_alone() {
    builds_alone("ballbot3d_arms", Target::Linux);
}

/// Built for the microcontroller where there is a way to, and run in the emulator where there is one.
#[test]
fn the_firmware_builds_and_sends_its_first_frames() {
    let name = "ballbot_planar";
    builds_alone(name, Target::CortexM);
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).expect("the checkout");
    let way = root.join("tests/emulated/bare-metal");
    if !way.exists() {
        return skip("qemu", "tests/emulated/bare-metal is not here");
    }
    let folder = deployed(name, Target::CortexM);
    let arguments = ["build", "--release", "--quiet", "--offline", "--features", "firmware"];
    // Where other tests build for it: the core library is there.
    let output = run(&way, folder.path(), "bare-metal", &arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(77) {
        return skip("qemu", errors.trim());
    }
    assert!(output.status.success(), "{errors}");
    let firmware = build_folder("bare-metal/thumbv7em-none-eabihf/release/firmware");
    let serial = folder.path().join("serial");
    let emulator = Command::new("qemu-system-arm")
        .args(["-M", "mps2-an386", "-display", "none", "-monitor", "none"])
        .args(["-semihosting-config", "enable=on,target=native"])
        .args(["-icount", "shift=0,sleep=off"])
        .arg("-serial")
        .arg(format!("file:{}", serial.display()))
        .arg("-kernel")
        .arg(firmware)
        .spawn();
    let mut emulator = match emulator {
        Ok(emulator) => emulator,
        Err(error) => return skip("qemu", &format!("qemu-system-arm: {error}")),
    };
    // Without nodes the master goes on asking for them: SYNC, heartbeats and resets, for ever.
    let enough = |text: &str| text.matches("t0800").count() > 20;
    let mut text = String::new();
    for _ in 0..600 {
        std::thread::sleep(std::time::Duration::from_millis(100));
        text = std::fs::read_to_string(&serial).unwrap_or_default();
        if enough(&text) || emulator.try_wait().is_ok_and(|status| status.is_some()) {
            break;
        }
    }
    let _ = emulator.kill();
    let _ = emulator.wait();
    assert!(enough(&text), "no SYNC: {text}");
    // All nodes are reset first.
    assert!(text.contains("t000"), "no NMT: {text}");
}
