//! `shapebot emit`: the specialised Rust code of a model.

use crate::args::EmitArgs;
use crate::failure::{Failure, Outcome};
use crate::robot;
use shapebot_codegen::build::{emitted, write_if_changed};
use shapebot_codegen::derive::Parameters;
use std::io::Write;
use std::path::Path;

pub(crate) fn run(args: &EmitArgs) -> Outcome {
    let text = robot::open(&args.robot)?.text()?;
    let runtime = robot::derive(&text, Parameters::Symbolic)?;
    let baked = args.bake.then(|| robot::rederive(&runtime, Parameters::Baked)).transpose()?;
    let stem = Path::new(&text.name).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let module = emitted(&stem.unwrap_or_default(), &runtime, baked.as_ref());
    let path = args.output.join(format!("{}.rs", module.stem));
    write_if_changed(&path, &module.text).map_err(Failure::usage)?;
    let names = &module.names;
    let mut stdout = anstream::stdout().lock();
    writeln!(stdout, "wrote {}: {}::{}", path.display(), names.module, names.robot)?;
    if args.bake {
        writeln!(stdout, "with parameters folded in: {}::{}", names.module, names.baked)?;
    }
    Ok(())
}
