//! Lock files: which versions were tested.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use toml::{Table, Value};

/// Packages of lock files that are not ours, by name and version.
#[derive(Default)]
pub(crate) struct Lock {
    packages: BTreeMap<(String, String), Package>,
}

struct Package {
    source: String,
    checksum: String,
    /// As in the file: `name`, or `name version` where there are several.
    dependencies: Vec<String>,
}

impl Lock {
    /// Adds the packages of a lock file; the first file that has a package decides its versions.
    pub(crate) fn add(&mut self, text: &str) -> Result<(), toml::de::Error> {
        let table: Table = text.parse()?;
        let known: BTreeSet<String> = self.packages.keys().map(|(name, _)| name.clone()).collect();
        for package in table.get("package").and_then(Value::as_array).into_iter().flatten() {
            let text =
                |key| package.get(key).and_then(Value::as_str).unwrap_or_default().to_owned();
            let (name, source) = (text("name"), text("source"));
            // Packages without a source are ours.
            if source.is_empty() || known.contains(&name) {
                continue;
            }
            let list = package.get("dependencies").and_then(Value::as_array).into_iter().flatten();
            let dependencies = list.filter_map(Value::as_str).map(str::to_owned).collect();
            let found = Package { source, checksum: text("checksum"), dependencies };
            self.packages.insert((name, text("version")), found);
        }
        Ok(())
    }

    /// The locked version of a package that a requirement such as `0.4` means.
    pub(crate) fn version(&self, name: &str, requirement: &str) -> Option<&str> {
        let wanted = requirement.trim_start_matches(['^', '=']);
        let fits = |version: &str| {
            version
                .strip_prefix(wanted)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        // A requirement such as `1.49` is also met by 1.50.
        let major = |version: &str| {
            let mut parts = version.split('.');
            let first = parts.next().unwrap_or_default().to_owned();
            if first == "0" { format!("0.{}", parts.next().unwrap_or_default()) } else { first }
        };
        let versions = || {
            let all = self.packages.keys().filter(move |(own, _)| own == name);
            all.map(|(_, version)| version.as_str())
        };
        versions().find(|v| fits(v)).or_else(|| versions().find(|v| major(v) == major(wanted)))
    }

    /// How dependencies name a package: with its version where there are several.
    pub(crate) fn key(&self, name: &str, version: &str) -> String {
        let several = self.packages.keys().filter(|(other, _)| other == name).count() > 1;
        if several { format!("{name} {version}") } else { name.to_owned() }
    }

    /// Rust source of the lock files of deployed crates: our packages with what they need, and all
    /// others that these reach.
    pub(crate) fn source(&self, ours: &[(&str, Vec<String>)], version: &str) -> String {
        let mut text = String::from(
            "/// Entries of lock files: package, what it needs of ours and others, and its text.\n\
             pub(crate) const LOCKED: &[Locked] = &[\n",
        );
        let mut put = |name: &str, needs: &[String], entry: &str| {
            let needs: Vec<&str> = needs.iter().map(String::as_str).collect();
            // Writing to a String cannot fail.
            let _ =
                writeln!(text, "Locked {{ name: {name:?}, needs: &{needs:?}, text: {entry:?} }},");
        };
        for (name, dependencies) in ours {
            let mut dependencies = dependencies.clone();
            dependencies.sort();
            dependencies.dedup();
            put(name, &dependencies, &entry(name, version, None, &dependencies));
        }
        for ((name, version), package) in &self.packages {
            let key = self.key(name, version);
            put(
                &key,
                &package.dependencies,
                &entry(name, version, Some(package), &package.dependencies),
            );
        }
        text.push_str("];\n");
        text
    }
}

fn entry(name: &str, version: &str, package: Option<&Package>, dependencies: &[String]) -> String {
    let mut text = format!("[[package]]\nname = {name:?}\nversion = {version:?}\n");
    if let Some(Package { source, checksum, .. }) = package {
        let _ = writeln!(text, "source = {source:?}");
        if !checksum.is_empty() {
            let _ = writeln!(text, "checksum = {checksum:?}");
        }
    }
    if !dependencies.is_empty() {
        text.push_str("dependencies = [\n");
        for dependency in dependencies {
            let _ = writeln!(text, " {dependency:?},");
        }
        text.push_str("]\n");
    }
    text
}
