//! Prints gains and figures of model files:
//! `cargo run --release -p shapebot-synthesis --example figures -- robots/models/*.robot`.

use shapebot_codegen::derive::{Parameters, derive};
use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

fn figures(path: &str) -> Result<String, String> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
    let parsed = shapebot_model_dsl::parse(path, &text);
    let refused = |diagnostics: &[_]| shapebot_model_dsl::render(diagnostics, path, &text, false);
    let model = parsed.model.ok_or_else(|| refused(&parsed.diagnostics))?;
    let derivation =
        derive(&model, Parameters::Symbolic).map_err(|diagnostics| refused(&diagnostics))?;
    let begin = Instant::now();
    let design = shapebot_synthesis::design(&derivation).map_err(|why| format!("{path}: {why}"))?;
    let took = begin.elapsed();
    let f = &design.figures;
    let poles: Vec<String> =
        f.poles.iter().filter(|p| p.im >= 0.0).map(|p| format!("{}±{}i", p.re, p.im)).collect();
    Ok(format!(
        "{path}, {took:.0?}\n  \
         k_p {:?} k_d {:?} s k_i {:?} 1/s, outer {:?} 1/s² {:?} 1/s, observers {} and {} 1/s\n  \
         decay {} 1/s, damping {}, delay margin {} s; over the ranges {} {} {}; all together {}, {} points\n  \
         poles {}",
        design.lean,
        design.lean_rate,
        design.lean_integral,
        design.position,
        design.velocity,
        design.observer_rate,
        design.offset_rate,
        f.decay,
        f.damping,
        f.delay_margin,
        f.worst_decay,
        f.worst_damping,
        f.worst_delay_margin,
        f.together,
        f.samples,
        poles.join(", "),
    ))
}

fn main() -> ExitCode {
    let mut failed = false;
    for path in std::env::args().skip(1) {
        let line = figures(&path).unwrap_or_else(|why| {
            failed = true;
            why
        });
        let _ = writeln!(std::io::stdout(), "{line}");
    }
    ExitCode::from(u8::from(failed))
}
