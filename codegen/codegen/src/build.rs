//! Generation in a build script.
//!
//! ```no_run
//! fn main() -> Result<(), shapebot_codegen::BuildError> {
//!     shapebot_codegen::Build::new().model("models/my_robot.robot").generate()
//! }
//! ```
//!
//! and in the crate: `shapebot_dynamics::include_model!("my_robot");`

use crate::derive::{Derivation, Parameters, Quantity, prove, specialise};
use crate::emit::{Documentation, Emission, EmittedNames, collection, emit, emitted_names};
use shapebot_model_dsl::{Diagnostic, model::Model, parse_bytes, render};
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Generates modules from model files: the whole configuration of a build script.
#[derive(Clone, Debug, Default)]
pub struct Build {
    sources: Vec<Source>,
    bake: bool,
    out_dir: Option<PathBuf>,
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
        module(&stem, &name, &bytes, self.bake)
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
fn module(stem: &str, name: &str, bytes: &[u8], bake: bool) -> Result<Module, BuildError> {
    let text = String::from_utf8_lossy(bytes);
    let refuse = |diagnostics: &[Diagnostic]| BuildError::Model {
        path: PathBuf::from(name),
        rendered: rendered(diagnostics, name, &text),
    };
    let parsed = parse_bytes(name, bytes);
    let Some(model) = parsed.model else { return Err(refuse(&parsed.diagnostics)) };
    let (equations, certificate) = prove(&model).map_err(|diagnostics| refuse(&diagnostics))?;
    let runtime = specialise(&model, &equations, &certificate, Parameters::Symbolic);
    let baked = bake.then(|| specialise(&model, &equations, &certificate, Parameters::Baked));
    let mut warnings = parsed.diagnostics;
    warnings.extend(certificate.warnings);
    let warnings = warnings
        .iter()
        .map(|warning| rendered(std::slice::from_ref(warning), name, &text))
        .collect();
    Ok(Module { warnings, ..emitted(stem, &runtime, baked.as_ref()) })
}

/// The module of a derivation, and of a second one with its parameters baked.
#[must_use]
pub fn emitted(stem: &str, runtime: &Derivation, baked: Option<&Derivation>) -> Module {
    let model = &runtime.model;
    let documentation = documentation(runtime);
    let text = emit(&Emission {
        stem,
        model,
        functions: &runtime.functions,
        baked: baked.map(|derivation| &derivation.functions),
        documentation: &documentation,
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

/// Why nothing was generated. Both `{}` and `{:?}` print messages for a reader, so that
/// `fn main() -> Result<(), BuildError>` does.
#[non_exhaustive]
pub enum BuildError {
    /// A model file cannot be read.
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// A model is wrong.
    Model {
        /// The file, or the name of the text.
        path: PathBuf,
        /// All messages about it, with their places.
        rendered: String,
    },
    /// Two models would make the same module.
    Duplicate {
        /// Its name.
        module: String,
    },
    /// A module cannot be written.
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// Neither `OUT_DIR` nor [`Build::out_dir`] says where to write.
    NoOutDir,
    /// Several of these.
    Several(Vec<Self>),
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read { path, error } => {
                write!(f, "cannot read the model {}: {error}", path.display())
            }
            Self::Model { rendered, .. } => f.write_str(rendered.trim_end()),
            Self::Duplicate { module } => {
                write!(f, "two models would make the module `{module}`: rename one of the files")
            }
            Self::Write { path, error } => write!(f, "cannot write {}: {error}", path.display()),
            Self::NoOutDir => {
                f.write_str("no output folder: run from a build script, or set `Build::out_dir`")
            }
            Self::Several(errors) => {
                let texts: Vec<String> = errors.iter().map(Self::to_string).collect();
                f.write_str(&texts.join("\n\n"))
            }
        }
    }
}

impl fmt::Debug for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no robot was generated\n\n{self}")
    }
}

impl std::error::Error for BuildError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Read { error, .. } | Self::Write { error, .. } => Some(error),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder that is removed again.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path =
                std::env::temp_dir().join(format!("shapebot-build-{name}-{}", std::process::id()));
            std::fs::create_dir_all(&path).expect("a folder");
            Self(path)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    const CART: &str = "robot Cart {
    params { m: kg = 1 in 0.1..10; }
    position x: m;
    kinetic 1/2*m*(d/dt(x))^2;
    actuator f on d/dt(x);
}";

    #[test]
    fn a_file_that_did_not_change_is_left_alone() {
        let folder = Folder::new("unchanged");
        let build = Build::new().text("cart", CART).out_dir(&folder.0);
        build.generate().expect("generated");
        let file = folder.0.join("cart.rs");
        let long_ago = std::time::SystemTime::UNIX_EPOCH;
        let handle = std::fs::File::options().write(true).open(&file).expect("there");
        handle.set_modified(long_ago).expect("set");
        build.generate().expect("generated");
        assert_eq!(std::fs::metadata(&file).and_then(|m| m.modified()).expect("there"), long_ago);
        let files = std::fs::read_dir(&folder.0).expect("there").count();
        assert_eq!(files, 1, "nothing temporary stays");
    }

    #[test]
    fn all_wrong_models_are_reported_at_once_with_their_places() {
        let build = Build::new()
            .text("first", "robot A {")
            .text("second", "robot B { nonsense }")
            .model("absent.robot");
        let error = build.modules().expect_err("three errors");
        let text = format!("{error:?}");
        for part in [
            "no robot was generated",
            "first.robot:1",
            "second.robot:1",
            "cannot read the model absent.robot",
        ] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
    }

    #[test]
    fn two_models_of_one_name_are_refused() {
        let error =
            Build::new().text("a-b", CART).text("a_b", CART).modules().expect_err("one module");
        assert!(error.to_string().contains("`a_b`"));
    }

    #[test]
    fn a_collection_lists_what_it_includes() {
        let folder = Folder::new("collection");
        Build::new()
            .text("cart", CART)
            .out_dir(&folder.0)
            .generate_collection("robots")
            .expect("generated");
        let list = std::fs::read_to_string(folder.0.join("robots.rs")).expect("written");
        assert!(list.contains("include!(concat!(env!(\"OUT_DIR\"), \"/cart.rs\"));"));
        assert!(list.contains("{ \"cart\", cart, Cart, CartBaked, 1, 1, 0 }"));
        syn::parse_file(&list).expect("Rust");
    }
}
