//! Model texts: reading, checking, deriving, and saying what is wrong with them.

use crate::failure::{Failure, Outcome};
use shapebot_codegen::derive::{Derivation, Equations, Parameters};
use shapebot_codegen::proof::Certificate;
use shapebot_model_dsl::model::Model;
use shapebot_model_dsl::{Diagnostic, MAX_BYTES, parse_bytes, render};
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

/// A model's text with its name for messages.
#[derive(Clone, Debug)]
pub(crate) struct ModelText {
    /// A path, or the file name of a bundled robot.
    pub(crate) name: String,
    /// The file's bytes.
    pub(crate) bytes: Vec<u8>,
}

impl ModelText {
    /// Reads a file. A longer one than a model may be is cut, and then refused as too long.
    pub(crate) fn read(path: &Path) -> Outcome<Self> {
        let failure = |e: &std::io::Error| Failure::file("read", path, e);
        let file = File::open(path).map_err(|e| failure(&e))?;
        let mut bytes = Vec::new();
        file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(|e| failure(&e))?;
        Ok(Self { name: path.display().to_string(), bytes })
    }

    /// The checked model; its diagnostics go to standard error.
    pub(crate) fn model(&self) -> Outcome<Model> {
        let parsed = parse_bytes(&self.name, &self.bytes);
        self.report(&parsed.diagnostics);
        parsed.model.ok_or(Failure::Reported)
    }

    fn refuse(&self, diagnostics: &[Diagnostic]) -> Failure {
        self.report(diagnostics);
        Failure::Reported
    }

    /// Says what is wrong, on standard error.
    fn report(&self, diagnostics: &[Diagnostic]) {
        if diagnostics.is_empty() {
            return;
        }
        let text = String::from_utf8_lossy(&self.bytes);
        let rendered = render(diagnostics, &self.name, &text, true);
        // `anstream` leaves colours out where they are not wanted. Nowhere to complain if it fails.
        let _ = writeln!(anstream::stderr(), "{}", rendered.trim_end());
    }
}

/// A model with its equations of motion and what is proved about them; what is wrong with it goes to
/// standard error.
pub(crate) fn prove(text: &ModelText) -> Outcome<(Model, Equations, Certificate)> {
    let model = text.model()?;
    let proved = shapebot_codegen::derive::prove(&model);
    let (equations, certificate) = proved.map_err(|diagnostics| text.refuse(&diagnostics))?;
    text.report(&certificate.warnings);
    Ok((model, equations, certificate))
}

/// Everything that follows from a model; what is wrong with it goes to standard error.
pub(crate) fn derive(text: &ModelText, parameters: Parameters) -> Outcome<Derivation> {
    let model = text.model()?;
    let derived = shapebot_codegen::derive::derive(&model, parameters);
    let derivation = derived.map_err(|diagnostics| text.refuse(&diagnostics))?;
    text.report(&derivation.certificate.warnings);
    Ok(derivation)
}

/// The same with other parameters, of a derivation that was reported already.
pub(crate) fn rederive(derivation: &Derivation, parameters: Parameters) -> Outcome<Derivation> {
    shapebot_codegen::derive::derive(&derivation.model, parameters).map_err(|_| Failure::Reported)
}
