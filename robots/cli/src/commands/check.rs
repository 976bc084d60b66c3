//! `shapebot check`: what is wrong with a model, and what is proved about it.

use crate::args::CheckArgs;
use crate::failure::Outcome;
use crate::robot;
use std::io::Write;

pub(crate) fn run(args: &CheckArgs) -> Outcome {
    let text = robot::open(&args.robot)?.text()?;
    let (_, _, certificate) = robot::prove(&text)?;
    let mut stdout = anstream::stdout().lock();
    writeln!(stdout, "{}", certificate.to_text().trim_end())?;
    Ok(())
}
