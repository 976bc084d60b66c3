//! `shapebot`: the program.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    shapebot::main()
}
