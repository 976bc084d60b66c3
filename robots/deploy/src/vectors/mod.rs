//! Vectors for the tests of a deployed crate, recorded when it is made.
//!
//! What the deployed crate computes is compared with what was found by another way:
//!
//! | in the deployed crate | here |
//! | --- | --- |
//! | emitted functions with parameters folded in | tapes of the symbolic derivation, parameters bound |
//! | the controller on the emitted robot, step after step | the controller on the interpreted robot |
//! | a plan evaluated from the bytes of its file | the polynomials that it was made from |

mod control;
mod dynamics;
mod plan;
mod random;
mod text;

use crate::derived::Derived;
use crate::{Error, Files};
use shapebot_interpreter::with_interpreted;

/// The plan file of the tests.
pub(crate) const PLAN: &str = "tests/vectors/plan.bin";

/// Adds `tests/vectors`.
pub(crate) fn add(derived: &Derived, files: &mut Files) -> Result<(), Error> {
    let mut items = vec![dynamics::record(derived)?];
    let steps = with_interpreted!(derived.tapes.clone(), |robot| {
        control::record(&robot, &derived.design, derived.drive.timing.period_us)
    })?;
    items.push(steps?);
    let (bytes, points) = plan::record(derived)?;
    items.push(points);
    files.add("tests/vectors/mod.rs", text::module(&items));
    files.add(PLAN, bytes);
    Ok(())
}
