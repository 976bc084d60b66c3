//! Tests that need something of their surroundings, and where those are.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Says that a test is skipped and why, past the capture of the test harness.
///
/// # Panics
///
/// If `SHAPEBOT_REQUIRE`, a list of names separated by commas, contains `name` or `all`.
pub fn skip(name: &str, why: &str) {
    let required = std::env::var("SHAPEBOT_REQUIRE").unwrap_or_default();
    let listed = |word: &str| word.trim() == name || word.trim() == "all";
    assert!(!required.split(',').any(listed), "SHAPEBOT_REQUIRE wants `{name}`: {why}");
    let _ = writeln!(std::io::stderr(), "skipped ({name}): {why}");
}

/// Says something past the capture of the test harness.
pub fn say(text: &str) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Root of the checkout.
#[must_use]
pub fn root() -> PathBuf {
    let suite = Path::new(env!("CARGO_MANIFEST_DIR"));
    suite.ancestors().nth(2).unwrap_or(suite).to_path_buf()
}

/// A file of the checkout as text.
///
/// # Panics
///
/// If it cannot be read.
#[must_use]
pub fn read(path: &str) -> String {
    let whole = root().join(path);
    std::fs::read_to_string(&whole).unwrap_or_else(|e| panic!("{}: {e}", whole.display()))
}

/// Paths of all files that belong to the checkout: tracked ones and new ones that are not ignored.
/// `None`, after a line that says so, where there is no git.
#[must_use]
pub fn files() -> Option<Vec<String>> {
    let arguments = ["ls-files", "--cached", "--others", "--exclude-standard", "-z"];
    let output = Command::new("git").args(arguments).current_dir(root()).output();
    let Some(output) = output.ok().filter(|output| output.status.success()) else {
        skip("git", "the files of the checkout are listed by git, which is not here");
        return None;
    };
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let mut files: Vec<String> = text.split('\0').map(str::to_owned).collect();
    files.retain(|path| !path.is_empty() && root().join(path).is_file());
    files.sort();
    files.dedup();
    Some(files)
}

/// Stems of the model files: the names of the bundled robots.
///
/// # Panics
///
/// If `robots/models` cannot be read.
#[must_use]
pub fn robot_names() -> Vec<String> {
    let folder = root().join("robots/models");
    let entries =
        std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let paths = entries.map(|entry| entry.expect("a folder entry").path());
    let models = paths.filter(|path| path.extension().is_some_and(|e| e == "robot"));
    let stem = |path: PathBuf| path.file_stem().map(|s| s.to_string_lossy().into_owned());
    let mut names: Vec<String> = models.filter_map(stem).collect();
    names.sort();
    names
}
