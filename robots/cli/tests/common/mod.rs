//! Running the built tool.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What a run left behind.
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Run {
    /// The run, which must have ended well.
    pub(crate) fn ok(self) -> Self {
        assert_eq!(self.code, 0, "{}", self.stderr);
        self
    }

    /// The run, which must have ended with a code and a message about something.
    pub(crate) fn fails(self, code: i32, about: &str) -> Self {
        assert_eq!(self.code, code, "{}", self.stderr);
        assert!(self.stderr.contains(about), "no `{about}` in: {}", self.stderr);
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        self
    }
}

/// Runs the tool in a folder with some input.
pub(crate) fn shapebot(folder: &Path, args: &[&str], input: &str) -> Run {
    let mut child = Command::new(env!("CARGO_BIN_EXE_shapebot"))
        .args(args)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_owned();
    // A tool that stops early closes the pipe, which is its right.
    let writer = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
    let output = child.wait_with_output().unwrap();
    let _ = writer.join().unwrap();
    Run {
        code: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// The workspace's folder.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Says that a test is skipped and why, past the test harness's capture.
///
/// # Panics
///
/// When `SHAPEBOT_REQUIRE` names what is missing.
pub(crate) fn skip(name: &str, why: &str) {
    let required = std::env::var("SHAPEBOT_REQUIRE").unwrap_or_default();
    let listed = |word: &str| word.trim() == name || word.trim() == "all";
    assert!(!required.split(',').any(listed), "SHAPEBOT_REQUIRE wants `{name}`: {why}");
    let _ = writeln!(std::io::stderr(), "skipped ({name}): {why}");
}
