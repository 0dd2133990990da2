//! The packages of the workspace, as `cargo metadata` tells them.

use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// A package of the workspace.
pub(super) struct Package {
    /// Its name.
    pub(super) name: String,
    /// Path of its manifest from the top folder.
    pub(super) manifest: String,
    /// Text of its manifest, to point at lines of it.
    pub(super) text: String,
    /// What it imports.
    pub(super) dependencies: Vec<Dependency>,
}

/// An import of a package.
#[derive(Debug, PartialEq)]
pub(super) struct Dependency {
    /// The imported package's own name, also where it is renamed.
    pub(super) name: String,
    /// What it is imported for.
    pub(super) kind: Kind,
    /// Whether it is given by a path, so that it is ours.
    pub(super) is_local: bool,
}

/// What a dependency is imported for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// The crate itself.
    Normal,
    /// Its build script.
    Build,
    /// Its tests, examples and benches.
    Dev,
}

impl Package {
    /// Line of the manifest that names the dependency, or 1.
    pub(super) fn line_of(&self, dependency: &str) -> usize {
        let names = |line: &str| {
            let rest = line.trim_start().strip_prefix(dependency);
            rest.is_some_and(|rest| rest.starts_with(['.', ' ', '=']))
                || line.contains(&format!("package = \"{dependency}\""))
        };
        self.text.lines().position(names).map_or(1, |i| i + 1)
    }
}

/// Asks cargo for the packages of the workspace at `root`.
///
/// # Errors
/// If cargo cannot be started, fails, or answers something else than metadata.
pub(super) fn of_workspace(root: &Path) -> Result<Vec<Package>, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let arguments = ["metadata", "--format-version", "1", "--no-deps"];
    let output = Command::new(cargo).args(arguments).current_dir(root).output();
    let output = output.map_err(|error| format!("cannot start cargo metadata: {error}"))?;
    if !output.status.success() {
        return Err(format!(
            "cargo metadata failed: {}",
            String::from_utf8_lossy(&output.stderr).trim()
        ));
    }
    let mut packages = parse(&String::from_utf8_lossy(&output.stdout))?;
    for package in &mut packages {
        package.text = std::fs::read_to_string(root.join(&package.manifest)).unwrap_or_default();
    }
    Ok(packages)
}

/// Packages in the text that `cargo metadata` prints; without the text of their manifests.
fn parse(metadata: &str) -> Result<Vec<Package>, String> {
    let metadata: Value =
        serde_json::from_str(metadata).map_err(|e| format!("cargo metadata: {e}"))?;
    let root = string(&metadata, "workspace_root")?;
    let packages = array(&metadata, "packages")?.iter();
    packages.map(|package| parse_package(package, &root)).collect()
}

fn parse_package(package: &Value, root: &str) -> Result<Package, String> {
    let manifest = string(package, "manifest_path")?;
    let inside = Path::new(&manifest)
        .strip_prefix(root)
        .map_or(manifest.clone(), |path| path.display().to_string());
    let dependencies = array(package, "dependencies")?.iter();
    Ok(Package {
        name: string(package, "name")?,
        manifest: inside.replace('\\', "/"),
        text: String::new(),
        dependencies: dependencies.map(parse_dependency).collect::<Result<_, _>>()?,
    })
}

fn parse_dependency(dependency: &Value) -> Result<Dependency, String> {
    let kind = match dependency["kind"].as_str() {
        None | Some("normal") => Kind::Normal,
        Some("build") => Kind::Build,
        Some("dev") => Kind::Dev,
        Some(other) => return Err(format!("cargo metadata: unknown kind of dependency `{other}`")),
    };
    Ok(Dependency {
        name: string(dependency, "name")?,
        kind,
        is_local: dependency["path"].is_string(),
    })
}

fn string(value: &Value, key: &str) -> Result<String, String> {
    value[key].as_str().map(str::to_owned).ok_or_else(|| format!("cargo metadata: no text `{key}`"))
}

fn array<'a>(value: &'a Value, key: &str) -> Result<&'a Vec<Value>, String> {
    value[key].as_array().ok_or_else(|| format!("cargo metadata: no list `{key}`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const METADATA: &str = r#"{ "workspace_root": "/w", "packages": [ {
        "name": "jointplay-study", "manifest_path": "/w/crates/jointplay-study/Cargo.toml", "dependencies": [
            { "name": "jointplay-core", "kind": null, "path": "/w/crates/jointplay-core" },
            { "name": "cc", "kind": "build" },
            { "name": "proptest", "kind": "dev", "rename": "laws" } ] } ] }"#;

    #[test]
    fn metadata_is_read() {
        let packages = parse(METADATA).unwrap();
        assert_eq!(packages.len(), 1);
        assert_eq!(packages[0].name, "jointplay-study");
        assert_eq!(packages[0].manifest, "crates/jointplay-study/Cargo.toml");
        let expect = [
            ("jointplay-core", Kind::Normal, true),
            ("cc", Kind::Build, false),
            ("proptest", Kind::Dev, false),
        ];
        let found: Vec<_> = packages[0]
            .dependencies
            .iter()
            .map(|d| (d.name.as_str(), d.kind, d.is_local))
            .collect();
        assert_eq!(found, expect);
    }

    #[test]
    fn other_text_is_an_error() {
        let error = |text: &str| parse(text).err().unwrap_or_default();
        assert!(error("oops").starts_with("cargo metadata: expected"));
        assert_eq!(error(r#"{ "workspace_root": "/w" }"#), "cargo metadata: no list `packages`");
        assert_eq!(
            error(&METADATA.replace("build", "other")),
            "cargo metadata: unknown kind of dependency `other`"
        );
    }

    #[test]
    fn lines_of_the_manifest() {
        let text = "[dependencies]\nserde_json = \"1\"\nserde.workspace = true\nlaws = { package = \"proptest\" }\n";
        let package = Package {
            name: "a".into(),
            manifest: "m".into(),
            text: text.into(),
            dependencies: vec![],
        };
        let check = |name, expect| assert_eq!(package.line_of(name), expect, "{name}");
        check("serde", 3);
        check("serde_json", 2);
        check("proptest", 4);
        check("gone", 1);
    }
}
