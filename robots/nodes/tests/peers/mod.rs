//! Where the Python programs of `tests/peers/can` and their interpreter are.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

pub(crate) fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here).to_path_buf()
}

/// Says that a test is skipped and why, past the capture of the test harness.
pub(crate) fn skip(name: &str, why: &str) {
    let required = std::env::var("SHAPEBOT_REQUIRE").unwrap_or_default();
    let listed = |word: &str| word.trim() == name || word.trim() == "all";
    assert!(!required.split(',').any(listed), "SHAPEBOT_REQUIRE wants `{name}`: {why}");
    let _ = writeln!(std::io::stderr(), "skipped ({name}): {why}");
}

/// The interpreter with the packages, or a line that says that it is not there.
pub(crate) fn python() -> Option<PathBuf> {
    let python = root().join("target/venv/bin/python");
    let check = Command::new(&python)
        .args(["-c", "import can, canopen, cantools, serial"])
        .stderr(Stdio::null())
        .status();
    if check.is_ok_and(|status| status.success()) {
        return Some(python);
    }
    skip("canopen", "Python's canopen is not in target/venv: run tests/peers/can/setup.sh");
    None
}

pub(crate) fn script(name: &str) -> PathBuf {
    root().join("tests/peers/can").join(name)
}
