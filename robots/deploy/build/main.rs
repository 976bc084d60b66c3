//! Embeds the sources of the runtime crates, with manifests that need no workspace.
//!
//! A crate's folder is the one of the checkout or, for a published package, the one that cargo unpacks
//! beside this: they are its dependencies. A crate that is nowhere is left out, and `deploy` says so.

mod lock;
mod manifest;

use lock::Lock;
use manifest::Inherited;
use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Packages with their folders in the checkout, from the root.
const CRATES: [(&str, &str); 8] = [
    ("shapebot-dynamics", "planner/dynamics"),
    ("shapebot-planner", "planner/planner"),
    ("shapebot-control", "robots/control"),
    ("shapebot-drive", "robots/drive"),
    ("shapebot-bus", "robots/bus"),
    ("shapebot-runtime", "robots/runtime"),
    ("shapebot-host", "robots/host"),
    ("shapebot-firmware", "robots/firmware"),
];

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let own = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?);
    let version = env::var("CARGO_PKG_VERSION")?;
    let root = own.ancestors().nth(2).unwrap_or(&own).to_path_buf();
    watch(Path::new("build"));
    let lock = read_locks(&own, &root)?;
    let mut crates = Vec::new();
    for (name, path) in CRATES {
        if let Some(folder) = find(&own, &root.join(path), name, &version) {
            crates.push((name, folder));
        }
    }
    let names: Vec<&str> = crates.iter().map(|(name, _)| *name).collect();
    let mut text = String::new();
    text.push_str("/// Sources of the runtime crates.\npub(crate) const CRATES: &[Crate] = &[\n");
    let mut direct = Vec::new();
    for (name, folder) in &crates {
        let inherited = Inherited::find(folder, &root)?;
        let manifest = manifest::rewrite(folder, &inherited, &lock, &names)?;
        writeln!(text, "Crate {{ name: {name:?}, manifest: {:?}, files: &[", manifest.text)?;
        for file in sources(folder)? {
            let relative = file.strip_prefix(folder)?.to_string_lossy().replace('\\', "/");
            writeln!(text, "({relative:?}, include_str!({:?})),", file.to_string_lossy())?;
        }
        text.push_str("] },\n");
        direct.push((*name, manifest.dependencies));
    }
    text.push_str("];\n\n");
    text.push_str(&lock.source(&direct, &version));
    fs::write(PathBuf::from(env::var("OUT_DIR")?).join("sources.rs"), text)?;
    Ok(())
}

/// Tells cargo what to watch; that nobody listens is no reason to fail.
fn watch(path: &Path) {
    let _ = writeln!(io::stdout(), "cargo:rerun-if-changed={}", path.display());
}

/// The folder of a crate: of the checkout, of a registry, or of vendored sources.
fn find(own: &Path, checkout: &Path, name: &str, version: &str) -> Option<PathBuf> {
    let beside = own.parent()?;
    let places =
        [checkout.to_path_buf(), beside.join(format!("{name}-{version}")), beside.join(name)];
    let named = |folder: &PathBuf| {
        let text = fs::read_to_string(folder.join("Cargo.toml")).unwrap_or_default();
        text.contains(&format!("name = \"{name}\""))
    };
    places.into_iter().find(named)
}

/// Files that a crate is built from, sorted.
fn sources(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut files: Vec<PathBuf> =
        ["build.rs", "memory.x"].iter().map(|name| folder.join(name)).collect();
    files.retain(|file| file.is_file());
    walk(&folder.join("src"), &mut files)?;
    files.sort();
    for file in &files {
        watch(file);
    }
    watch(&folder.join("src"));
    watch(&folder.join("Cargo.toml"));
    Ok(files)
}

fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Failure> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            walk(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

/// Versions of the checkout, or of the published package, which has a lock file of its own.
fn read_locks(own: &Path, root: &Path) -> Result<Lock, Failure> {
    let mut lock = Lock::default();
    let candidates =
        [root.join("Cargo.lock"), root.join("robots/firmware/Cargo.lock"), own.join("Cargo.lock")];
    for path in candidates.iter().filter(|path| path.is_file()) {
        watch(path);
        lock.add(&fs::read_to_string(path)?)?;
    }
    Ok(lock)
}
