//! Gains of a balancing robot's controller from its derived equations.
//!
//! [`design`] linearises a model at the origin, closes the sampled loop of `shapebot-control` around it
//! (zero-order hold, one period of delay, observers included), and picks gains that do best at the worst
//! of several parameter values. It is deterministic. [`control`] puts the result into generated modules:
//!
//! ```no_run
//! fn main() -> Result<(), shapebot_codegen::BuildError> {
//!     shapebot_codegen::Build::new()
//!         .model("models/my_robot.robot")
//!         .with(shapebot_synthesis::control)
//!         .generate()
//! }
//! ```
#![forbid(unsafe_code)]

mod closed_loop;
mod design;
mod gains;
mod linear_algebra;
mod linearisation;
mod robot;
mod search;
mod text;

pub use design::design;

use shapebot_codegen::Addition;
use shapebot_codegen::derive::Derivation;

/// Extension of [`shapebot_codegen::Build`]: `pub const CONTROL`, the gains of the controller of each
/// shape-accelerated model. A model for which none are found gets a warning and no constant.
#[must_use]
pub fn control(derivation: &Derivation) -> Addition {
    if !derivation.certificate.is_shape_accelerated() {
        return Addition::default();
    }
    match design(derivation) {
        Ok(design) => Addition { items: text::items(&design), warnings: Vec::new() },
        Err(reason) => {
            let name = &derivation.model.name;
            let warning = format!("`{name}` has no `CONTROL`: {reason}");
            Addition { items: String::new(), warnings: vec![warning] }
        }
    }
}
