//! Files into a folder: whole, or not at all.

use crate::files::{HEAD, LIST};
use crate::{Error, Files};
use shapebot_drive::crc::crc32;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// What cargo makes in a crate's folder, and git: neither edited nor lost.
const OTHERS: [&str; 2] = ["target", ".git"];

/// Cargo leaves out of it what a machine does not need.
const LOCK: &str = "Cargo.lock";

/// Files that are there to be changed; what a user made of them is kept.
const FOR_THE_USER: [&str; 2] = ["src/board.rs", "memory.x"];

/// Writes files into a folder that does not exist, is empty, or was written by this function and not
/// edited since. In the last case `target`, `.git` and the files of the board are kept.
///
/// The files are written beside the folder first, and take its place when all are there.
///
/// # Errors
///
/// [`Error::Occupied`], [`Error::Edited`], [`Error::Io`]; the folder is as it was then.
pub fn write(files: &Files, folder: &Path) -> Result<(), Error> {
    let old = Old::look(folder)?;
    let beside = |ending: &str| {
        let mut name = folder.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.{ending}", std::process::id()));
        folder.with_file_name(name)
    };
    let (new, aside) = (beside("new"), beside("old"));
    let written = fill(files, &old, folder, &new).and_then(|()| swap(&old, folder, &new, &aside));
    if written.is_err() {
        let _ = fs::remove_dir_all(&new);
    }
    written
}

/// What is at the folder's place.
struct Old {
    exists: bool,
    /// Files of the user, by their paths.
    kept: Vec<(&'static str, Vec<u8>)>,
}

impl Old {
    fn look(folder: &Path) -> Result<Self, Error> {
        let mut entries = match fs::read_dir(folder) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Ok(Self { exists: false, kept: Vec::new() });
            }
            Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
                return Err(Error::Occupied { folder: folder.to_owned() });
            }
            Err(error) => return Err(at(folder)(error)),
        };
        if entries.next().is_none() {
            return Ok(Self { exists: true, kept: Vec::new() });
        }
        let list = fs::read_to_string(folder.join(LIST)).unwrap_or_default();
        let Some(list) = list.strip_prefix(HEAD) else {
            return Err(Error::Occupied { folder: folder.to_owned() });
        };
        let listed: BTreeMap<&str, &str> =
            list.lines().filter_map(|line| line.split_once(' ')).map(|(c, p)| (p, c)).collect();
        let mut found = Vec::new();
        walk(folder, folder, &mut found)?;
        let (mut kept, mut edited) = (Vec::new(), Vec::new());
        for path in found.into_iter().filter(|path| path != LIST && path != LOCK) {
            let content = fs::read(folder.join(&path)).map_err(at(&folder.join(&path)))?;
            if listed.get(path.as_str()) == Some(&format!("{:08x}", crc32(&content)).as_str()) {
                continue;
            }
            match FOR_THE_USER.iter().find(|name| **name == path) {
                Some(name) => kept.push((*name, content)),
                None => edited.push(path),
            }
        }
        if edited.is_empty() {
            Ok(Self { exists: true, kept })
        } else {
            Err(Error::Edited { folder: folder.to_owned(), files: edited })
        }
    }
}

fn at(path: &Path) -> impl Fn(io::Error) -> Error {
    move |source| Error::Io { path: path.to_owned(), source }
}

/// Paths of all files but those of [`OTHERS`], sorted.
fn walk(root: &Path, folder: &Path, found: &mut Vec<String>) -> Result<(), Error> {
    let entries = fs::read_dir(folder).map_err(at(folder))?;
    let paths: Result<Vec<PathBuf>, _> = entries.map(|entry| entry.map(|e| e.path())).collect();
    let mut paths = paths.map_err(at(folder))?;
    paths.sort();
    for path in paths {
        let relative = path.strip_prefix(root).unwrap_or(&path);
        let relative = relative.to_string_lossy().replace('\\', "/");
        if OTHERS.contains(&relative.as_str()) {
            continue;
        }
        if path.is_dir() {
            walk(root, &path, found)?;
        } else {
            found.push(relative);
        }
    }
    Ok(())
}

fn fill(files: &Files, old: &Old, folder: &Path, new: &Path) -> Result<(), Error> {
    if let Some(parent) = folder.parent().filter(|parent| !parent.as_os_str().is_empty()) {
        fs::create_dir_all(parent).map_err(at(parent))?;
    }
    // Left behind by a process that was ended.
    let _ = fs::remove_dir_all(new);
    for (path, content) in files.iter() {
        let kept = old.kept.iter().find(|(name, _)| *name == path);
        let content = kept.map_or(content, |(_, content)| content);
        let path = new.join(path);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(at(parent))?;
        }
        fs::write(&path, content).map_err(at(&path))?;
    }
    Ok(())
}

/// Puts the new folder into the old one's place; if that fails, the old one back.
fn swap(old: &Old, folder: &Path, new: &Path, aside: &Path) -> Result<(), Error> {
    if !old.exists {
        return fs::rename(new, folder).map_err(at(folder));
    }
    fs::rename(folder, aside).map_err(at(folder))?;
    if let Err(error) = fs::rename(new, folder) {
        let _ = fs::rename(aside, folder);
        return Err(at(folder)(error));
    }
    for name in OTHERS.iter().filter(|name| aside.join(name).exists()) {
        fs::rename(aside.join(name), folder.join(name)).map_err(at(&aside.join(name)))?;
    }
    fs::remove_dir_all(aside).map_err(at(aside))
}
