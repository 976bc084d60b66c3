//! Programs for a microcontroller: built, and run in an emulator.

use crate::copies::build_folder;
use crate::environment::{root, skip};
use std::io::Read as _;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// The emulator of 32-bit ARM.
const QEMU: &str = "qemu-system-arm";

/// Builds a binary of the firmware workspace for a Cortex-M4F. `None`, after a line that says so, where
/// there is no compiler for it or no emulator.
///
/// # Panics
///
/// If it does not compile, with what cargo said.
#[must_use]
pub fn firmware(package: &str, binary: &str) -> Option<PathBuf> {
    if let Err(error) = Command::new(QEMU).arg("--version").output() {
        skip("qemu", &format!("{QEMU}: {error}"));
        return None;
    }
    let target = build_folder("bare-metal");
    let mut command = Command::new(root().join("tests/emulated/bare-metal"));
    command.args(["build", "--quiet", "--release", "--locked", "-p", package, "--bin", binary]);
    command.arg("--manifest-path").arg(root().join("robots/firmware/Cargo.toml"));
    for name in ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "OUT_DIR"] {
        command.env_remove(name);
    }
    command.env("CARGO_TARGET_DIR", &target).env("CARGO_TERM_COLOR", "never");
    let output = match command.output() {
        Ok(output) => output,
        Err(error) => {
            skip("qemu", &format!("tests/emulated/bare-metal: {error}"));
            return None;
        }
    };
    let errors = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(77) {
        skip("qemu", errors.trim());
        return None;
    }
    assert!(output.status.success(), "{package} does not compile for a Cortex-M4F:\n{errors}");
    Some(target.join("thumbv7em-none-eabihf/release").join(binary))
}

/// The emulated board, an MPS2 with a Cortex-M4F, about to run `program`. An instruction takes one
/// nanosecond of its time, so that a program always does the same.
#[must_use]
pub fn board(program: &PathBuf) -> Command {
    let mut command = Command::new(QEMU);
    command.args(["-M", "mps2-an386", "-display", "none", "-monitor", "none"]);
    command.args(["-semihosting-config", "enable=on,target=native"]);
    command.args(["-icount", "shift=0,sleep=off", "-kernel"]).arg(program);
    command.stdin(Stdio::null());
    command
}

/// Runs a program that prints little and ends by itself. A program that hangs is ended.
///
/// # Panics
///
/// If it cannot be started or takes longer than `limit`.
#[must_use]
pub fn run_within(command: &mut Command, limit: Duration) -> Output {
    let start = Instant::now();
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.unwrap_or_else(|e| panic!("{command:?}: {e}"));
    while child.try_wait().unwrap_or_else(|e| panic!("{command:?}: {e}")).is_none() {
        if start.elapsed() > limit {
            let _ = child.kill();
            let mut text = String::new();
            let _ = child.stdout.take().map(|mut pipe| pipe.read_to_string(&mut text));
            panic!("{command:?} did not end in {limit:?}; it printed:\n{text}");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().unwrap_or_else(|e| panic!("{command:?}: {e}"))
}
