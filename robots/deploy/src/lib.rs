//! A model and a drive description as a stand-alone crate: [`deploy`] makes its files, [`write()`] puts them
//! into a folder.
//!
//! | in the folder | what it is |
//! | --- | --- |
//! | `src/` | the robot's dynamics and gains, the drive's tables, its plan, and the program around them |
//! | `crates/` | the sources of the runtime crates, with manifests that need no workspace |
//! | `tests/` | the robot against vectors that were recorded from the model by another way |
//! | `can/` | DBC file of each bus, bus load, set-up of the nodes |
//! | `model/`, `drive/` | the two texts that all of it was made from |
//! | `README.md` | wiring, bus load, how to bring the robot up |
//! | `LICENSE-MIT`, `LICENSE-APACHE` | licences of the runtime crates, of which one may be chosen |
//!
//! The files are a pure function of the request: no time, no path and no order of a map gets into them.
//! Nothing refers to anything outside of the folder but crates.io, at versions that are pinned.
//!
//! The sources are those that this crate was built beside. The vectors come from the interpreter of the
//! symbolic derivation and from closed forms, so that a test of the folder compares two ways from the
//! model to a number; see the module `vectors`.
#![forbid(unsafe_code)]

mod derived;
mod error;
mod files;
mod plan;
mod render;
mod request;
mod sources;
mod vectors;
mod wiring;
mod write;

pub use error::Error;
pub use files::Files;
pub use request::{Request, Target, Text};
pub use write::write;

use derived::Derived;

/// The files of a stand-alone crate.
///
/// # Errors
///
/// What is wrong with the model or the drive, with its place; a robot without a controller, or of a size
/// that the runtime has not; a target whose sources this build has not.
pub fn deploy(request: &Request<'_>) -> Result<Files, Error> {
    let derived = Derived::new(request)?;
    let mut files = Files::default();
    sources::add(&derived, request.target, &mut files)?;
    render::add(&derived, request, &mut files)?;
    vectors::add(&derived, &mut files)?;
    plan::add(&derived, request, &mut files)?;
    files.add("model/".to_owned() + &derived.stem + ".robot", request.model.text);
    files.add("drive/".to_owned() + &derived.drive.name + ".toml", request.drive.text);
    files.seal();
    Ok(files)
}
