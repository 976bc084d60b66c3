//! The tool as a program of this package, so that tests run it as it is now.

use std::process::ExitCode;

fn main() -> ExitCode {
    shapebot::main()
}
