//! Manifests without workspace inheritance, development dependencies and lints.

use crate::lock::Lock;
use crate::{Failure, watch};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use toml::{Table, Value};

/// What a manifest may inherit.
#[derive(Default)]
pub(crate) struct Inherited {
    package: Table,
    dependencies: Table,
}

impl Inherited {
    /// From the crate's own manifest if it is a workspace's root, else from that of the checkout.
    pub(crate) fn find(folder: &Path, root: &Path) -> Result<Self, Failure> {
        for path in [folder.join("Cargo.toml"), root.join("Cargo.toml")] {
            let Ok(text) = fs::read_to_string(&path) else { continue };
            let table: Table = text.parse()?;
            if let Some(workspace) = table.get("workspace").and_then(Value::as_table) {
                watch(&path);
                let part = |key| workspace.get(key).and_then(Value::as_table).cloned();
                let (package, dependencies) = (part("package"), part("dependencies"));
                return Ok(Self {
                    package: package.unwrap_or_default(),
                    dependencies: dependencies.unwrap_or_default(),
                });
            }
        }
        Ok(Self::default())
    }
}

/// A manifest's text, and the names it depends on.
pub(crate) struct Manifest {
    pub(crate) text: String,
    pub(crate) dependencies: Vec<String>,
}

/// The manifest of a crate that lies beside the crates `ours`.
pub(crate) fn rewrite(
    folder: &Path,
    inherited: &Inherited,
    lock: &Lock,
    ours: &[&str],
) -> Result<Manifest, Failure> {
    let table: Table = fs::read_to_string(folder.join("Cargo.toml"))?.parse()?;
    let mut manifest = Manifest { text: package(&table, inherited), dependencies: Vec::new() };
    if let Some(features) = table.get("features").and_then(Value::as_table) {
        manifest.text.push_str("\n[features]\n");
        for (name, value) in features {
            writeln!(manifest.text, "{name} = {value}")?;
        }
    }
    let context = Context { inherited, lock, ours };
    if let Some(list) = table.get("dependencies").and_then(Value::as_table) {
        manifest.text.push_str("\n[dependencies]\n");
        context.dependencies(list, &mut manifest)?;
    }
    for (target, part) in table.get("target").and_then(Value::as_table).into_iter().flatten() {
        if let Some(list) = part.get("dependencies").and_then(Value::as_table) {
            write!(manifest.text, "\n[target.{:?}.dependencies]\n", target)?;
            context.dependencies(list, &mut manifest)?;
        }
    }
    Ok(manifest)
}

fn package(table: &Table, inherited: &Inherited) -> String {
    let mut text = String::from("[package]\n");
    let own = table.get("package").and_then(Value::as_table).cloned().unwrap_or_default();
    for key in ["name", "description", "version", "edition", "rust-version", "license"] {
        let value = own.get(key).filter(|value| value.is_str());
        if let Some(value) = value.or_else(|| inherited.package.get(key)) {
            let _ = writeln!(text, "{key} = {value}");
        }
    }
    text.push_str("publish = false\n");
    text
}

struct Context<'a> {
    inherited: &'a Inherited,
    lock: &'a Lock,
    ours: &'a [&'a str],
}

impl Context<'_> {
    fn dependencies(&self, list: &Table, manifest: &mut Manifest) -> Result<(), Failure> {
        for (name, value) in list {
            let (line, version) = self.dependency(name, value)?;
            writeln!(manifest.text, "{name} = {{ {line} }}")?;
            manifest.dependencies.push(self.lock.key(name, &version));
        }
        Ok(())
    }

    fn dependency(&self, name: &str, value: &Value) -> Result<(String, String), Failure> {
        let empty = Value::Table(Table::new());
        let inherits = value.get("workspace").is_some();
        let base = if inherits { self.inherited.dependencies.get(name) } else { None };
        let base = base.unwrap_or(&empty);
        let flag = |key| value.get(key).or_else(|| base.get(key)).and_then(Value::as_bool);
        let (mut line, version) = if self.ours.contains(&name) {
            (format!("path = \"../{name}\""), String::new())
        } else {
            let text =
                |v: &Value| v.as_str().or_else(|| v.get("version")?.as_str()).map(str::to_owned);
            let wanted = text(value).or_else(|| text(base)).unwrap_or_default();
            let version = self.lock.version(name, &wanted);
            let version = version.ok_or_else(|| format!("`{name}` {wanted} is in no lock file"))?;
            (format!("version = \"={version}\""), version.to_owned())
        };
        if flag("default-features") == Some(false) {
            line.push_str(", default-features = false");
        }
        if flag("optional") == Some(true) {
            line.push_str(", optional = true");
        }
        let features: Vec<&str> = [base, value]
            .iter()
            .flat_map(|part| part.get("features").and_then(Value::as_array).into_iter().flatten())
            .filter_map(Value::as_str)
            .collect();
        if !features.is_empty() {
            write!(line, ", features = {features:?}")?;
        }
        Ok((line, version))
    }
}
