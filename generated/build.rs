//! Generates a module for every bundled model.

use shapebot_codegen::{Build, BuildError};

fn main() -> Result<(), BuildError> {
    let models = shapebot_models::MODELS.iter();
    let build = models.fold(Build::new().with(shapebot_synthesis::control), |build, (name, text)| build.text(*name, *text));
    build.generate_collection("robots")
}
