//! What follows from a request.

use crate::{Error, Request};
use shapebot_codegen::build::{Module, emitted_with};
use shapebot_codegen::derive::{Derivation, Parameters, prove, specialise};
use shapebot_drive_build::DriveDescription;
use shapebot_dynamics::control::ControlDesign;
use shapebot_interpreter::Tapes;
use shapebot_model_dsl::{Diagnostic, parse_bytes, render};

/// Everything that follows from the two texts.
pub(crate) struct Derived {
    /// The model file's stem.
    pub(crate) stem: String,
    /// The emitted module.
    pub(crate) module: Module,
    /// The symbolic derivation with the model's own values bound: another way to the same numbers.
    pub(crate) tapes: Tapes<f64>,
    /// Gains.
    pub(crate) design: ControlDesign,
    /// The checked drive.
    pub(crate) drive: DriveDescription,
}

impl Derived {
    pub(crate) fn new(request: &Request<'_>) -> Result<Self, Error> {
        let (name, text) = (request.model.name, request.model.text);
        let refused =
            |diagnostics: &[Diagnostic]| Error::Model(render(diagnostics, name, text, false));
        let stem = request.model.stem().to_owned();
        let parsed = parse_bytes(name, text.as_bytes());
        let Some(model) = parsed.model else { return Err(refused(&parsed.diagnostics)) };
        let proved = prove(&model).map_err(|diagnostics| refused(&diagnostics))?;
        let (equations, certificate) = proved;
        let runtime = specialise(&model, &equations, &certificate, Parameters::Symbolic);
        let values: Vec<f64> = model.parameters.iter().map(|p| p.value_f64).collect();
        let tapes = Tapes::new(&runtime, &values)?;
        // Refuses what is not shape-accelerated.
        shapebot_interpreter::sizes(&tapes)?;
        let drive = shapebot_drive_build::read(
            request.drive.name,
            request.drive.text,
            tapes.description(),
        )?;
        let baked = specialise(&model, &equations, &certificate, Parameters::Baked);
        let (module, design) = emit(&stem, &runtime, &baked)?;
        Ok(Self { stem, module, tapes, design, drive })
    }
}

fn emit(
    stem: &str,
    runtime: &Derivation,
    baked: &Derivation,
) -> Result<(Module, ControlDesign), Error> {
    let design =
        shapebot_synthesis::design(runtime).map_err(|why| Error::Gains(why.to_string()))?;
    let control = shapebot_synthesis::control(runtime);
    Ok((emitted_with(stem, runtime, Some(baked), &[control]), design))
}
