//! Deployed folders and cargo in them.
#![allow(dead_code, reason = "each test uses its part")]

use shapebot_deploy::{Request, Target, Text, deploy, write};
use std::fs::{self, File};
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::SystemTime;

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

/// A deployed crate, in a folder that has no checkout above it. There is one at a time: all of them share
/// a target folder, in which cargo gives their crates the same names.
pub(crate) struct Deployed {
    folder: PathBuf,
    _only: File,
}

impl Deployed {
    /// A folder that is the same each time these tests of this build run, so that cargo recognises the
    /// runtime crates of one robot in those of the next. Waits until it is nobody's.
    fn new(target: Target) -> Self {
        let lock = build_folder("deployed.lock");
        let only = File::create(&lock).unwrap_or_else(|e| panic!("{}: {e}", lock.display()));
        only.lock().expect("a lock");
        let mut hasher = DefaultHasher::new();
        lock.hash(&mut hasher);
        let name = format!("shapebot-deployed-{target:?}-{:016x}", hasher.finish());
        let folder = std::env::temp_dir().join(name);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
        Self { folder, _only: only }
    }

    /// The folder in which `robot` is.
    pub(crate) fn path(&self) -> &Path {
        &self.folder
    }

    /// Cargo goes by times: the runtime crates are as old as this test, in which they are embedded.
    fn age(&self) {
        let test = std::env::current_exe().and_then(fs::metadata).expect("this test");
        age(&self.folder.join("robot/crates"), test.modified().expect("a time"));
    }
}

impl Drop for Deployed {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Sets the times of all files in a folder.
fn age(folder: &Path, time: SystemTime) {
    for path in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path())
    {
        if path.is_dir() {
            age(&path, time);
        } else {
            let file = File::options().write(true).open(&path);
            file.and_then(|file| file.set_modified(time)).expect("a file");
        }
    }
}

/// A bundled robot, deployed.
pub(crate) fn deployed(name: &str, target: Target) -> Deployed {
    deployed_on(name, shapebot_drives::text(name).expect("a drive"), target, None)
}

/// The same on any drive, with a plan.
pub(crate) fn deployed_on(
    name: &str,
    drive: &str,
    target: Target,
    plan: Option<&[u8]>,
) -> Deployed {
    let model = format!("{name}.robot");
    let files = deploy(&Request {
        model: Text { name: &model, text: shapebot_models::text(name).expect("a model") },
        drive: Text { name: &format!("{name}.toml"), text: drive },
        target,
        plan,
    });
    let files = files.unwrap_or_else(|error| panic!("{error}"));
    let folder = Deployed::new(target);
    write(&files, &folder.path().join("robot")).unwrap_or_else(|error| panic!("{error}"));
    folder.age();
    folder
}

/// A command without the outer cargo's environment.
fn command(program: &Path, folder: &Path, target: &str, arguments: &[&str]) -> Command {
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
    command
}

fn output(mut command: Command) -> Output {
    command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"))
}

/// Runs a command.
pub(crate) fn run(program: &Path, folder: &Path, target: &str, arguments: &[&str]) -> Output {
    output(command(program, folder, target, arguments))
}

/// Runs cargo; `None`, after a line that says so, where its cache lacks a package. What it builds on the
/// way goes beside that of the build that runs these tests: packages of crates.io are built once.
pub(crate) fn cargo(folder: &Path, arguments: &[&str]) -> Option<String> {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = command(Path::new(&program), folder, "deployed", arguments);
    command.env("CARGO_BUILD_BUILD_DIR", build_folder("")).env("CARGO_PROFILE_DEV_DEBUG", "0");
    let output = output(command);
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
