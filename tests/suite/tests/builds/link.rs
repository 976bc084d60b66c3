//! What runs on a robot links without a standard library, a heap and a reachable panic.

use shapebot_tests::copies::{build_folder, cargo, copy_crate};
use shapebot_tests::environment::skip;
use std::path::Path;
use std::process::{Command, Output};

const FILES: [&str; 6] =
    ["Cargo.toml", "src/lib.rs", "src/drive.rs", "src/plan.rs", "src/runtime.rs", "memory.c"];

/// Builds the library with `features` and links it with nothing but `memory.c`.
fn link(folder: &Path, target: &Path, features: &str) -> Output {
    let arguments = ["build", "--release", "--quiet", "--offline", "--features", features];
    let _ = cargo(folder, target, &arguments, "");
    let mut gcc = Command::new("gcc");
    gcc.args(["-nostdlib", "-static", "-Wl,--gc-sections", "-O1", "-ffreestanding"]);
    // Else the loop of memcpy becomes a call of memcpy.
    gcc.args(["-fno-tree-loop-distribute-patterns", "-o"]).arg(target.join("linked"));
    gcc.arg(folder.join("memory.c")).arg(target.join("release/libshapebot_link.a"));
    gcc.output().unwrap_or_else(|e| panic!("gcc: {e}"))
}

#[test]
fn no_panic_is_reachable_and_a_planted_one_is_found() {
    if cfg!(not(all(target_os = "linux", target_arch = "x86_64"))) {
        return skip("link", "the link test is written for x86-64 Linux");
    }
    if Command::new("gcc").arg("--version").output().is_err() {
        return skip("link", "no gcc, with which to link a program from scratch");
    }
    let (folder, target) = (build_folder("link/crate"), build_folder("link/target"));
    copy_crate("link", &FILES, &folder);
    let output = link(&folder, &target, "");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "see tests/link/README.md\n{errors}");
    let output = link(&folder, &target, "planted");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success(), "the planted panic was not found");
    assert!(errors.contains("a_panic_is_reachable"), "{errors}");
}
