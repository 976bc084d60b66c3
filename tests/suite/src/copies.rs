//! Copies of parts of the checkout, and cargo in them.

use crate::environment::{files, read, root};
use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Writes a file unless it has that content already: cargo goes by times.
///
/// # Panics
///
/// If it cannot be written.
pub fn write_if_changed(path: &Path, content: &[u8]) {
    if std::fs::read(path).is_ok_and(|old| old == content) {
        return;
    }
    let fail = |e| panic!("{}: {e}", path.display());
    path.parent().map_or(Ok(()), std::fs::create_dir_all).unwrap_or_else(fail);
    std::fs::write(path, content).unwrap_or_else(fail);
}

/// Makes `target` a copy of the checkout's files; `false`, after a line that says so, without git.
///
/// # Panics
///
/// If a file cannot be copied.
pub fn copy_checkout(target: &Path) -> bool {
    let Some(files) = files() else { return false };
    for path in &files {
        match std::fs::read(root().join(path)) {
            Ok(content) => write_if_changed(&target.join(path), &content),
            // Gone since it was listed.
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => panic!("{path}: {error}"),
        }
    }
    remove_others(target, target, &files.into_iter().collect());
    true
}

/// Removes what an earlier copy had and the checkout has no longer.
fn remove_others(target: &Path, folder: &Path, files: &BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            remove_others(target, &path, files);
        } else if let Ok(relative) = path.strip_prefix(target)
            && !files.contains(&relative.to_string_lossy().replace('\\', "/"))
        {
            std::fs::remove_file(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        }
    }
}

/// Makes `folder` a copy of a crate of `tests/` that is outside of the workspace, built from the checkout and
/// with the versions of its lock, so that nothing has to be downloaded.
///
/// # Panics
///
/// If a file cannot be copied.
pub fn copy_crate(name: &str, files: &[&str], folder: &Path) {
    for file in files {
        let mut text = read(&format!("tests/{name}/{file}"));
        if *file == "Cargo.toml" {
            text = text.replace("../..", &root().to_string_lossy().replace('\\', "/"));
        }
        write_if_changed(&folder.join(file), text.as_bytes());
    }
    write_if_changed(&folder.join("Cargo.lock"), read("Cargo.lock").as_bytes());
}

/// A folder of the build that runs these tests, by its name: `<target>/foreign`.
#[must_use]
pub fn build_folder(name: &str) -> PathBuf {
    // <target>/<profile>/deps/<test>-<hash>
    let test = std::env::current_exe().unwrap_or_default();
    let target = test.ancestors().nth(3).unwrap_or(Path::new("target"));
    target.join(name)
}

/// Cargo without the network in `folder`; nothing of the environment of the outer cargo remains. What it
/// makes goes into `target`, what it needs on the way there beside that of the build that runs these
/// tests: packages of crates.io that both build alike are built once.
///
/// # Panics
///
/// If it cannot be started or fails, with what it said.
#[must_use]
pub fn cargo(folder: &Path, target: &Path, arguments: &[&str], input: &str) -> String {
    text(cargo_output(folder, target, arguments, input), arguments)
}

/// The same, whatever comes of it.
///
/// # Panics
///
/// If it cannot be started.
#[must_use]
pub fn cargo_output(folder: &Path, target: &Path, arguments: &[&str], input: &str) -> Output {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(program);
    for (name, _) in std::env::vars_os() {
        let text = name.to_string_lossy();
        let inner = text.starts_with("CARGO_PKG_") || text.starts_with("CARGO_MANIFEST_");
        if inner || ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "OUT_DIR"].contains(&&*text) {
            command.env_remove(&name);
        }
    }
    command.args(arguments).current_dir(folder).env("CARGO_TARGET_DIR", target);
    command.env("CARGO_BUILD_BUILD_DIR", build_folder(""));
    // What is built here is run once: unoptimised, build scripts and programs share what they need.
    for setting in ["OPT_LEVEL", "DEBUG", "BUILD_OVERRIDE_OPT_LEVEL", "BUILD_OVERRIDE_DEBUG"] {
        command.env(format!("CARGO_PROFILE_DEV_{setting}"), "0");
    }
    command.env("CARGO_NET_OFFLINE", "true").env("CARGO_TERM_COLOR", "never");
    output(&mut command, input)
}

/// What a program prints that is given `input`.
///
/// # Panics
///
/// If it cannot be started or fails, with what it said.
#[must_use]
pub fn run(command: &mut Command, input: &str) -> String {
    let output = output(command, input);
    text(output, &[&command.get_program().to_string_lossy()])
}

/// What was printed by a program that must have ended well.
fn text(output: Output, called: &[&str]) -> String {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{} failed:\n{errors}", called.join(" "));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn output(command: &mut Command, input: &str) -> Output {
    use std::io::Write as _;
    let pipe = std::process::Stdio::piped;
    command.stdin(pipe()).stdout(pipe()).stderr(pipe());
    let mut child = command.spawn().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let mut stdin = child.stdin.take();
    let input = input.to_owned();
    let writer = std::thread::spawn(move || {
        // Whoever does not read its input says why itself.
        let _ = stdin.as_mut().map(|pipe| pipe.write_all(input.as_bytes()));
    });
    let output = child.wait_with_output().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let _ = writer.join();
    output
}
