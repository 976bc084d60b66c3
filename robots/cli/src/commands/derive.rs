//! `shapebot derive`: the derived equations of motion.

use crate::args::{DeriveArgs, Format};
use crate::failure::Outcome;
use crate::robot;
use shapebot_codegen::equations::{to_json, to_latex, to_text};
use std::io::Write;

pub(crate) fn run(args: &DeriveArgs) -> Outcome {
    let text = robot::open(&args.robot)?.text()?;
    let (model, equations, certificate) = robot::prove(&text)?;
    let subject = (&model, &equations, &certificate);
    let printed = match args.format {
        Format::Text => to_text(subject),
        Format::Latex => to_latex(subject),
        Format::Json => to_json(subject),
    };
    let mut stdout = anstream::stdout().lock();
    writeln!(stdout, "{}", printed.trim_end())?;
    Ok(())
}
