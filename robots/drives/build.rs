//! Lists the drive descriptions beside this one: a new file is a new drive.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let folder = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default()).join("drives.rs");
    let mut list = String::new();
    for file in drives(&folder)? {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        let path = file.to_string_lossy();
        // Writing to a String cannot fail.
        let _ = writeln!(list, "    ({stem:?}, include_str!({path:?})),");
    }
    // The folder itself, so that new files are seen.
    io::Write::write_all(&mut io::stdout(), b"cargo:rerun-if-changed=.\n")?;
    fs::write(out, format!("&[\n{list}]\n"))
}

/// All `*.toml` files of a folder but the crate's own, in the order of their names.
fn drives(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let is_drive = path.extension().is_some_and(|extension| extension == "toml")
            && path.file_stem().is_some_and(|stem| stem != "Cargo");
        if is_drive && path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
