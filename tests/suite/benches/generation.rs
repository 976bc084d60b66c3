//! How long it takes from a model's text to Rust, per bundled model and for all of them, and the largest
//! memory that was in use.

use shapebot_codegen::Build;
use std::io::Write as _;

fn main() {
    divan::main();
    if let Some(peak) = peak_memory() {
        let _ = writeln!(std::io::stdout(), "peak memory of the process: {peak}");
    }
}

fn names() -> impl Iterator<Item = &'static str> {
    shapebot_models::MODELS.iter().map(|(name, _)| *name)
}

/// Parse, derive, prove, simplify, emit with parameters at run time and baked.
#[divan::bench(args = names(), sample_count = 5, sample_size = 1)]
fn one_model(name: &str) -> usize {
    let text = shapebot_models::text(name).unwrap_or_default();
    emit(Build::new().text(name, text).bake_parameters())
}

/// Without the baked type, as in somebody's build script.
#[divan::bench(args = names(), sample_count = 5, sample_size = 1)]
fn one_model_without_baking(name: &str) -> usize {
    emit(Build::new().text(name, shapebot_models::text(name).unwrap_or_default()))
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn all_models() -> usize {
    emit(
        shapebot_models::MODELS
            .iter()
            .fold(Build::new().bake_parameters(), |b, (n, t)| b.text(*n, *t)),
    )
}

/// Bytes of Rust.
fn emit(build: Build) -> usize {
    let modules = build.modules().unwrap_or_else(|error| panic!("{error}"));
    modules.iter().map(|module| module.text.len()).sum()
}

/// `VmHWM` of Linux.
fn peak_memory() -> Option<String> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().to_owned())
}
