//! `shapebot explain`: the page of a diagnostic code, or all codes.

use crate::args::ExplainArgs;
use crate::failure::{Failure, Outcome};
use shapebot_model_dsl::{codes, explain};
use std::io::Write;

pub(crate) fn run(args: &ExplainArgs) -> Outcome {
    let mut stdout = anstream::stdout().lock();
    let Some(code) = &args.code else {
        let bold = anstyle::Style::new().bold();
        for (code, title) in codes() {
            writeln!(stdout, "{bold}{code}{bold:#}  {title}")?;
        }
        return Ok(());
    };
    match explain(code) {
        Some(page) => Ok(writeln!(stdout, "{}", page.trim_end())?),
        None => Err(unknown(code)),
    }
}

fn unknown(code: &str) -> Failure {
    let message = format!("no diagnostic code `{code}`");
    Failure::Usage(message, Some("`shapebot explain` lists all codes".to_owned()))
}
