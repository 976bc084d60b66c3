//! The README's build script.

fn main() -> Result<(), shapebot_codegen::BuildError> {
    let build = shapebot_codegen::Build::new().model("models/my_robot.robot");
    build.with(shapebot_synthesis::control).generate()
}
