//! Generates a module for every bundled model.

use shapebot_codegen::{Build, BuildError};

fn main() -> Result<(), BuildError> {
    let build = Build::new().with(shapebot_synthesis::control);
    let models = shapebot_models::MODELS.iter();
    let build = models.fold(build, |build, (name, text)| build.text(*name, *text));
    build.generate_collection("robots")
}
