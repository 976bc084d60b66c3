//! Writes the tables of the drives that tests need without a host's help.

use shapebot_codegen::derive::{Parameters, derive};
use shapebot_drive_build::Source;
use shapebot_interpreter::Tapes;
use std::error::Error;
use std::path::PathBuf;
use std::{env, fs, io};

fn main() -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default()).join("drives.rs");
    let names = shapebot_drives::DRIVES.iter().map(|(name, _)| *name);
    let modules: Result<Vec<String>, _> = names.map(module).collect();
    fs::write(out, modules?.concat())?;
    io::Write::write_all(&mut io::stdout(), b"cargo:rerun-if-changed=build.rs\n")?;
    Ok(())
}

/// The module of a bundled drive, checked against its model.
fn module(name: &str) -> Result<String, Box<dyn Error>> {
    let source = Source::parse(name, shapebot_drives::text(name).ok_or("no such drive")?)?;
    let text = shapebot_models::text(source.robot()).ok_or("no such model")?;
    let parsed = shapebot_model_dsl::parse(&format!("{}.robot", source.robot()), text);
    let model = parsed.model.ok_or("the model is refused")?;
    let derivation = derive(&model, Parameters::Symbolic).map_err(|e| format!("{e:?}"))?;
    let tapes = Tapes::<f64>::with_model_parameters(&derivation);
    Ok(source.check(tapes.description())?.rust())
}
