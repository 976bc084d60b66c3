//! `shapebot derive`: the derived equations of motion.

use crate::args::{DeriveArgs, Format};
use crate::failure::Outcome;
use crate::robot;
use shapebot_codegen::derive::Parameters;
use shapebot_codegen::equations::{to_json, to_latex, to_text};
use std::io::Write;

pub(crate) fn run(args: &DeriveArgs) -> Outcome {
    let text = robot::open(&args.robot)?.text()?;
    let derivation = robot::derive(&text, Parameters::Symbolic)?;
    let printed = match args.format {
        Format::Text => to_text(&derivation),
        Format::Latex => to_latex(&derivation),
        Format::Json => to_json(&derivation),
    };
    let mut stdout = anstream::stdout().lock();
    writeln!(stdout, "{}", printed.trim_end())?;
    Ok(())
}
