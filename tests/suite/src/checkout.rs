//! The checkout as text: folders, manifests and sources.

use crate::environment::read;

/// What a manifest says that the structure rules are about.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Manifest {
    /// Package name.
    pub name: String,
    /// Folder of the manifest: `codegen/symbolic`.
    pub folder: String,
    /// Names under `[dependencies]`.
    pub dependencies: Vec<String>,
    /// Names under `[build-dependencies]`.
    pub build_dependencies: Vec<String>,
    /// Names under `[dev-dependencies]`.
    pub dev_dependencies: Vec<String>,
}

impl Manifest {
    /// Reads the parts of TOML that our manifests use: a table header per line, a key per line.
    #[must_use]
    pub fn parse(folder: &str, text: &str) -> Self {
        let mut manifest = Self { folder: folder.to_owned(), ..Self::default() };
        let mut table = String::new();
        for line in text.lines().map(str::trim) {
            if line.starts_with('[') {
                table = line.trim_matches(['[', ']']).to_owned();
                // `[dependencies.name]`
                if let Some((kind, name)) = table.clone().rsplit_once('.') {
                    manifest.depend(kind, name);
                }
                continue;
            }
            let Some((key, value)) = line.split_once('=').filter(|_| !line.starts_with('#')) else {
                continue;
            };
            let key = key.trim().split('.').next().unwrap_or_default().trim_matches('"');
            if table == "package" && key == "name" {
                manifest.name = value.trim().trim_matches('"').to_owned();
            }
            manifest.depend(&table.clone(), key);
        }
        manifest
    }

    fn depend(&mut self, table: &str, name: &str) {
        // Also `target.'cfg(…)'.dependencies`.
        let list = match table.rsplit('.').next() {
            Some("dependencies") => &mut self.dependencies,
            Some("build-dependencies") => &mut self.build_dependencies,
            Some("dev-dependencies") => &mut self.dev_dependencies,
            _ => return,
        };
        list.push(name.to_owned());
    }

    /// All that the crate itself is built from.
    pub fn needs(&self) -> impl Iterator<Item = &str> {
        self.dependencies.iter().chain(&self.build_dependencies).map(String::as_str)
    }
}

/// Manifests of all members of the workspace.
///
/// # Panics
///
/// If one of them cannot be read.
#[must_use]
pub fn members() -> Vec<Manifest> {
    let root = read("Cargo.toml");
    let (_, list) = root.split_once("members = [").expect("the workspace's members");
    let (list, _) = list.split_once(']').expect("the end of the members");
    let folders = list.split(',').map(|entry| entry.trim().trim_matches('"'));
    let folders = folders.filter(|folder| !folder.is_empty());
    folders.map(|folder| Manifest::parse(folder, &read(&format!("{folder}/Cargo.toml")))).collect()
}

#[cfg(test)]
mod tests {
    use super::Manifest;

    #[test]
    fn dependencies_are_found_in_all_spellings() {
        let text = "
            [package]
            name = \"a\"
            [dependencies]
            # b = 1
            c.workspace = true
            d = { workspace = true, features = [\"x\"] }
            [build-dependencies]
            e = \"1\"
            [dev-dependencies.f]
            version = \"1\"
            [lints]
            workspace = true";
        let manifest = Manifest::parse("x/a", text);
        assert_eq!((manifest.name.as_str(), manifest.folder.as_str()), ("a", "x/a"));
        assert_eq!(manifest.needs().collect::<Vec<_>>(), ["c", "d", "e"]);
        assert_eq!(manifest.dev_dependencies, ["f"]);
    }
}
