//! Operations of every derived function of model files, by candidate.
//!
//! `cargo run --release -p shapebot-codegen --example counts -- robots/models/*.robot`

use shapebot_codegen::derive::{self, Parameters};
use std::io::Write;

fn main() -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    for path in std::env::args().skip(1) {
        let bytes = std::fs::read(&path)?;
        let parsed = shapebot_model_dsl::parse_bytes(&path, &bytes);
        let Some(model) = parsed.model else {
            writeln!(out, "{path}: {} errors", parsed.diagnostics.len())?;
            continue;
        };
        let start = std::time::Instant::now();
        let proved = derive::prove(&model);
        writeln!(out, "{path}: proof {:.1} ms", start.elapsed().as_secs_f64() * 1e3)?;
        let (equations, certificate) = match proved {
            Ok(proved) => proved,
            Err(refusals) => {
                writeln!(out, "{path}: refused, {} reasons", refusals.len())?;
                continue;
            }
        };
        for mode in [Parameters::Baked, Parameters::Symbolic] {
            let start = std::time::Instant::now();
            let derivation = derive::specialise(&model, &equations, &certificate, mode);
            writeln!(out, "  {mode:?}: {:.1} ms", start.elapsed().as_secs_f64() * 1e3)?;
            for (quantity, function) in &derivation.functions {
                let others: Vec<String> = function
                    .candidates
                    .iter()
                    .map(|(name, count)| format!("{name} {}", count.flops()))
                    .collect();
                let name = format!("{quantity:?}");
                writeln!(
                    out,
                    "    {name:28} {:5}  {}",
                    function.operations.flops(),
                    others.join(", ")
                )?;
            }
        }
    }
    Ok(())
}
