//! The README's build script.

fn main() -> Result<(), shapebot_codegen::BuildError> {
    shapebot_codegen::Build::new().model("models/my_robot.robot").generate()
}
