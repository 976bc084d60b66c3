//! Generation in a build script.
//!
//! ```no_run
//! fn main() -> Result<(), shapebot_codegen::BuildError> {
//!     shapebot_codegen::Build::new().model("models/my_robot.robot").generate()
//! }
//! ```
//!
//! and in the crate: `shapebot_dynamics::include_model!("my_robot");`
//!
//! [`Build::with`] lets other crates add items to the modules, such as the gains of a controller.

mod error;
#[cfg(test)]
mod tests;

pub use error::BuildError;

use crate::derive::{Derivation, Parameters, Quantity, prove, specialise};
use crate::emit::{Documentation, Emission, EmittedNames, collection, emit, emitted_names};
use shapebot_model_dsl::{Diagnostic, model::Model, parse_bytes, render};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Generates modules from model files: the whole configuration of a build script.
#[derive(Clone, Debug, Default)]
pub struct Build {
    sources: Vec<Source>,
    bake: bool,
    out_dir: Option<PathBuf>,
    extensions: Vec<Extension>,
}

/// Makes further items for the module of a derivation, see [`Build::with`].
pub type Extension = fn(&Derivation) -> Addition;

/// What an [`Extension`] adds to a module.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Addition {
    /// Rust items with their documentation; paths begin with `::`. Text that is no Rust ends up as a
    /// compile error of the module.
    pub items: String,
    /// Messages that cargo is to show.
    pub warnings: Vec<String>,
}

#[derive(Clone, Debug)]
enum Source {
    File(PathBuf),
    Text { name: String, text: String },
}

/// A generated module.
#[derive(Clone, Debug)]
pub struct Module {
    /// The model file's stem: name of the module's file.
    pub stem: String,
    /// Names inside.
    pub names: EmittedNames,
    /// n, n_x, n_s.
    pub dimensions: [usize; 3],
    /// Whether it is a robot that the planner can plan for; else only the Lagrangian trait is
    /// implemented.
    pub shape_accelerated: bool,
    /// The Rust text.
    pub text: String,
    /// Rendered messages about things that are probably not meant.
    pub warnings: Vec<String>,
}

impl Build {
    /// Nothing yet: add models with [`Build::model`].
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a model file; relative paths count from the crate's folder. The module is named after the
    /// file.
    #[must_use]
    pub fn model(mut self, path: impl Into<PathBuf>) -> Self {
        self.sources.push(Source::File(path.into()));
        self
    }

    /// Adds a model by its text; `name` names the module.
    #[must_use]
    pub fn text(mut self, name: impl Into<String>, text: impl Into<String>) -> Self {
        self.sources.push(Source::Text { name: name.into(), text: text.into() });
        self
    }

    /// Emits, beside the type with parameters at run time, one that has the model's own values folded
    /// into its equations: `MyRobotBaked`.
    #[must_use]
    pub fn bake_parameters(mut self) -> Self {
        self.bake = true;
        self
    }

    /// Adds what an extension makes of each model to its module.
    ///
    /// ```text
    /// Build::new().model("models/my_robot.robot").with(shapebot_synthesis::control).generate()
    /// ```
    #[must_use]
    pub fn with(mut self, extension: Extension) -> Self {
        self.extensions.push(extension);
        self
    }

    /// Where to write; `OUT_DIR` if not set.
    #[must_use]
    pub fn out_dir(mut self, path: impl Into<PathBuf>) -> Self {
        self.out_dir = Some(path.into());
        self
    }

    /// Writes `<stem>.rs` per model into the output folder, where it changed, and tells cargo what to
    /// watch.
    ///
    /// # Errors
    ///
    /// Messages about all models that are wrong, or the file that cannot be read or written.
    pub fn generate(&self) -> Result<(), BuildError> {
        self.announce();
        let out_dir = self.destination()?;
        self.write_modules(&out_dir).map(|_| ())
    }

    /// As [`Build::generate`] with baked parameters, and writes `<name>.rs` that includes all modules
    /// and defines `for_each_robot!`: nobody has to list the robots.
    ///
    /// # Errors
    ///
    /// As [`Build::generate`].
    pub fn generate_collection(self, name: &str) -> Result<(), BuildError> {
        let build = self.bake_parameters();
        build.announce();
        let out_dir = build.destination()?;
        let modules = build.write_modules(&out_dir)?;
        write_if_changed(&out_dir.join(format!("{name}.rs")), &collection(&modules))
    }

    fn write_modules(&self, out_dir: &Path) -> Result<Vec<Module>, BuildError> {
        let modules = self.modules()?;
        for module in &modules {
            warn(&module.warnings);
            write_if_changed(&out_dir.join(format!("{}.rs", module.stem)), &module.text)?;
        }
        Ok(modules)
    }

    /// The modules, without writing anything.
    ///
    /// # Errors
    ///
    /// Messages about all models that are wrong, or the file that cannot be read.
    pub fn modules(&self) -> Result<Vec<Module>, BuildError> {
        let mut modules: Vec<Module> = Vec::new();
        let mut errors = Vec::new();
        for source in &self.sources {
            match self.module(source) {
                Ok(module) if modules.iter().any(|m| m.names.module == module.names.module) => {
                    errors.push(BuildError::Duplicate { module: module.names.module });
                }
                Ok(module) => modules.push(module),
                Err(error) => errors.push(error),
            }
        }
        match errors.len() {
            0 => Ok(modules),
            1 => Err(errors.remove(0)),
            _ => Err(BuildError::Several(errors)),
        }
    }

    fn module(&self, source: &Source) -> Result<Module, BuildError> {
        let (stem, name, bytes) = match source {
            Source::File(path) => {
                let bytes = std::fs::read(path)
                    .map_err(|error| BuildError::Read { path: path.clone(), error })?;
                let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
                (stem.unwrap_or_default(), path.to_string_lossy().into_owned(), bytes)
            }
            Source::Text { name, text } => {
                (name.clone(), format!("{name}.robot"), text.clone().into_bytes())
            }
        };
        module(&stem, &name, &bytes, self)
    }

    fn announce(&self) {
        let files = self.sources.iter().filter_map(|source| match source {
            Source::File(path) => Some(path.display().to_string()),
            Source::Text { .. } => None,
        });
        for file in files.chain([String::from("build.rs")]) {
            tell_cargo(&format!("rerun-if-changed={file}"));
        }
    }

    fn destination(&self) -> Result<PathBuf, BuildError> {
        let set = self.out_dir.clone();
        set.or_else(|| std::env::var_os("OUT_DIR").map(PathBuf::from)).ok_or(BuildError::NoOutDir)
    }
}

/// One module from the bytes of a model file.
fn module(stem: &str, name: &str, bytes: &[u8], build: &Build) -> Result<Module, BuildError> {
    let text = String::from_utf8_lossy(bytes);
    let refuse = |diagnostics: &[Diagnostic]| BuildError::Model {
        path: PathBuf::from(name),
        rendered: rendered(diagnostics, name, &text),
    };
    let parsed = parse_bytes(name, bytes);
    let Some(model) = parsed.model else { return Err(refuse(&parsed.diagnostics)) };
    let (equations, certificate) = prove(&model).map_err(|diagnostics| refuse(&diagnostics))?;
    let runtime = specialise(&model, &equations, &certificate, Parameters::Symbolic);
    let baked = build.bake.then(|| specialise(&model, &equations, &certificate, Parameters::Baked));
    let mut warnings = parsed.diagnostics;
    warnings.extend(certificate.warnings);
    let mut warnings: Vec<String> = warnings
        .iter()
        .map(|warning| rendered(std::slice::from_ref(warning), name, &text))
        .collect();
    let additions: Vec<Addition> =
        build.extensions.iter().map(|extension| extension(&runtime)).collect();
    warnings.extend(additions.iter().flat_map(|addition| addition.warnings.iter().cloned()));
    Ok(Module { warnings, ..emitted_with(stem, &runtime, baked.as_ref(), &additions) })
}

/// The module of a derivation, and of a second one with its parameters baked.
#[must_use]
pub fn emitted(stem: &str, runtime: &Derivation, baked: Option<&Derivation>) -> Module {
    emitted_with(stem, runtime, baked, &[])
}

/// As [`emitted`], with further items.
#[must_use]
pub fn emitted_with(
    stem: &str,
    runtime: &Derivation,
    baked: Option<&Derivation>,
    additions: &[Addition],
) -> Module {
    let model = &runtime.model;
    let documentation = documentation(runtime);
    let additional: Vec<String> = additions.iter().map(|a| a.items.clone()).collect();
    let text = emit(&Emission {
        stem,
        model,
        functions: &runtime.functions,
        baked: baked.map(|derivation| &derivation.functions),
        documentation: &documentation,
        additional: &additional,
    });
    Module {
        stem: stem.to_owned(),
        names: emitted_names(stem, model),
        dimensions: dimensions(model),
        shape_accelerated: runtime.functions.contains_key(&Quantity::Gamma),
        text,
        warnings: Vec::new(),
    }
}

fn dimensions(model: &Model) -> [usize; 3] {
    let (n, n_x) = (model.coordinates.len(), model.position_count());
    [n, n_x, n - n_x]
}

fn documentation(derivation: &Derivation) -> Documentation {
    let equations = crate::equations::to_text(derivation);
    Documentation { equations, certificate: derivation.certificate.to_text() }
}

fn rendered(diagnostics: &[Diagnostic], name: &str, text: &str) -> String {
    render(diagnostics, name, text, false)
}

/// A line for cargo; that nobody listens is no reason to fail.
fn tell_cargo(line: &str) {
    let _ = writeln!(io::stdout(), "cargo:{line}");
}

fn warn(warnings: &[String]) {
    for line in warnings.iter().flat_map(|warning| warning.lines()) {
        tell_cargo(&format!("warning={line}"));
    }
}

/// Writes a file if its content differs: first beside it, then in its place, so that nobody ever reads
/// half of it.
///
/// # Errors
///
/// [`BuildError::Write`].
pub fn write_if_changed(path: &Path, text: &str) -> Result<(), BuildError> {
    if std::fs::read(path).is_ok_and(|old| old == text.as_bytes()) {
        return Ok(());
    }
    let mut temporary = path.as_os_str().to_owned();
    temporary.push(format!(".{}.tmp", std::process::id()));
    let temporary = PathBuf::from(temporary);
    let write = || {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        std::fs::write(&temporary, text)?;
        std::fs::rename(&temporary, path)
    };
    write().map_err(|error| {
        let _ = std::fs::remove_file(&temporary);
        BuildError::Write { path: path.to_owned(), error }
    })
}
