//! Deployed folders and cargo in them.
#![allow(dead_code, reason = "each test uses its part")]

use shapebot_deploy::{Request, Target, Text, deploy, write};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Says that a test is skipped and why, past the capture of the test harness.
pub(crate) fn skip(name: &str, why: &str) {
    let required = std::env::var("SHAPEBOT_REQUIRE").unwrap_or_default();
    let listed = |word: &str| word.trim() == name || word.trim() == "all";
    assert!(!required.split(',').any(listed), "SHAPEBOT_REQUIRE wants `{name}`: {why}");
    let _ = writeln!(std::io::stderr(), "skipped ({name}): {why}");
}

/// A folder of the build that runs these tests.
pub(crate) fn build_folder(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("this test");
    test.ancestors().nth(3).expect("a target folder").join(name)
}

/// A deployed crate, in a folder that has no checkout above it.
pub(crate) fn deployed(name: &str, target: Target) -> tempfile::TempDir {
    deployed_on(name, shapebot_drives::text(name).expect("a drive"), target, None)
}

/// The same on any drive, with a plan.
pub(crate) fn deployed_on(
    name: &str,
    drive: &str,
    target: Target,
    plan: Option<&[u8]>,
) -> tempfile::TempDir {
    let model = format!("{name}.robot");
    let files = deploy(&Request {
        model: Text { name: &model, text: shapebot_models::text(name).expect("a model") },
        drive: Text { name: &format!("{name}.toml"), text: drive },
        target,
        plan,
    });
    let folder = tempfile::tempdir().expect("a folder");
    let files = files.unwrap_or_else(|error| panic!("{error}"));
    write(&files, &folder.path().join("robot")).unwrap_or_else(|error| panic!("{error}"));
    folder
}

/// Runs a command without the outer cargo's environment.
pub(crate) fn run(program: &Path, folder: &Path, target: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new(program);
    for (name, _) in std::env::vars_os() {
        let text = name.to_string_lossy();
        let inner = text.starts_with("CARGO_PKG_") || text.starts_with("CARGO_MANIFEST_");
        if inner || ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "OUT_DIR"].contains(&&*text) {
            command.env_remove(&name);
        }
    }
    command.args(arguments).current_dir(folder.join("robot"));
    command.env("CARGO_TARGET_DIR", build_folder(target));
    command.env("CARGO_NET_OFFLINE", "true").env("CARGO_TERM_COLOR", "never");
    command.output().unwrap_or_else(|error| panic!("{}: {error}", program.display()))
}

/// Runs cargo; `None`, after a line that says so, where its cache lacks a package.
pub(crate) fn cargo(folder: &Path, arguments: &[&str]) -> Option<String> {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = run(Path::new(&program), folder, "deployed", arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    let lacking = ["no matching package", "unable to update", "failed to download"];
    if !output.status.success() && lacking.iter().any(|text| errors.contains(text)) {
        skip("deploy", errors.lines().next().unwrap_or_default());
        return None;
    }
    assert!(output.status.success(), "cargo {} failed:\n{errors}", arguments.join(" "));
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// A line past the capture of the test harness.
pub(crate) fn say(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}
