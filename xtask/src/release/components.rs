//! The libraries of others that are in our binaries: crates in programs and libraries, packages of npm in the page of the studio.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::{fs, io};

use cargo_metadata::{
    CargoOpt, DependencyKind, Metadata, MetadataCommand, Package, PackageId, TargetKind,
};

/// Packages of the workspace that are compiled into binaries.
const BINARIES: [&str; 3] = ["jointplay-cli", "jointplay-c", "jointplay-python"];

/// Packages of npm that are compiled into the page although the page names them among its tools.
const COMPILED: [&str; 1] = ["svelte"];

/// First words of names of files with licences and notices.
const LICENCES: [&str; 6] = ["LICENSE", "LICENCE", "COPYING", "UNLICENSE", "NOTICE", "COPYRIGHT"];

/// One library.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Component {
    /// Where it comes from: `cargo` or `npm`.
    pub(super) registry: &'static str,
    pub(super) name: String,
    pub(super) version: String,
    /// Its licences, as an SPDX expression.
    pub(super) licence: String,
    pub(super) repository: String,
    /// SHA-256 of its archive, where the lock file states one.
    pub(super) checksum: Option<String>,
    /// Files with its licences and notices.
    pub(super) files: Vec<PathBuf>,
}

impl Component {
    /// Its package URL.
    pub(super) fn url(&self) -> String {
        format!("pkg:{}/{}@{}", self.registry, self.name.replace('@', "%40"), self.version)
    }
}

/// The libraries in the binaries for one platform, sorted.
///
/// # Errors
/// If cargo fails, or packages of the page are not installed.
pub(super) fn components(root: &Path, platform: &str) -> io::Result<Vec<Component>> {
    let mut found = crates(root, Some(platform))?;
    found.extend(packages_of_page(&root.join("studio"))?);
    found.sort();
    Ok(found)
}

/// The crates in the binaries, for one platform or for all.
pub(super) fn crates(root: &Path, platform: Option<&str>) -> io::Result<Vec<Component>> {
    let platform = platform.into_iter().flat_map(|platform| ["--filter-platform", platform]);
    let metadata = MetadataCommand::new()
        .current_dir(root)
        .features(CargoOpt::AllFeatures)
        .other_options(
            ["--locked"].into_iter().chain(platform).map(str::to_owned).collect::<Vec<_>>(),
        )
        .exec()
        .map_err(io::Error::other)?;
    let checksums = checksums(&fs::read_to_string(root.join("Cargo.lock"))?)?;
    let linked = linked(&metadata);
    let foreign =
        metadata.packages.iter().filter(|one| one.source.is_some() && linked.contains(&one.id));
    foreign.map(|package| component(package, &checksums)).collect()
}

/// Packages whose code is linked into the binaries: neither tools of the build nor what only tests use.
fn linked(metadata: &Metadata) -> BTreeSet<PackageId> {
    let packages: BTreeMap<_, _> = metadata.packages.iter().map(|one| (&one.id, one)).collect();
    let nodes = metadata.resolve.iter().flat_map(|resolve| &resolve.nodes);
    let nodes: BTreeMap<_, _> = nodes.map(|node| (&node.id, node)).collect();
    let ours = metadata.packages.iter().filter(|one| BINARIES.contains(&one.name.as_str()));
    let mut open: Vec<&PackageId> = ours.map(|one| &one.id).collect();
    let mut found = BTreeSet::new();
    while let Some(id) = open.pop() {
        let runs_in_compiler = |one: &Package| {
            one.targets.iter().any(|target| target.kind.contains(&TargetKind::ProcMacro))
        };
        if runs_in_compiler(packages[id]) || !found.insert(id.clone()) {
            continue;
        }
        let dependencies = nodes[id].deps.iter();
        let linked = dependencies
            .filter(|one| one.dep_kinds.iter().any(|kind| kind.kind == DependencyKind::Normal));
        open.extend(linked.map(|one| &one.pkg));
    }
    found
}

fn component(
    package: &Package,
    checksums: &BTreeMap<(String, String), String>,
) -> io::Result<Component> {
    let (name, version) = (package.name.to_string(), package.version.to_string());
    let licence = package.license.as_deref().unwrap_or("NOASSERTION");
    let folder = package.manifest_path.parent().unwrap_or(&package.manifest_path);
    Ok(Component {
        registry: "cargo",
        // As some wrote it before SPDX had expressions.
        licence: licence.replace('/', " OR "),
        repository: package.repository.clone().unwrap_or_default(),
        checksum: checksums.get(&(name.clone(), version.clone())).cloned(),
        files: licence_files(folder.as_std_path())?,
        name,
        version,
    })
}

/// Checksums of a lock file of cargo, by name and version.
fn checksums(lock: &str) -> io::Result<BTreeMap<(String, String), String>> {
    let lock: toml::Table = lock.parse().map_err(io::Error::other)?;
    let packages = lock.get("package").and_then(toml::Value::as_array).into_iter().flatten();
    let text = |package: &toml::Value, key: &str| Some(package.get(key)?.as_str()?.to_owned());
    let stated = packages.filter_map(|package| {
        Some(((text(package, "name")?, text(package, "version")?), text(package, "checksum")?))
    });
    Ok(stated.collect())
}

/// Packages of npm that are in the page: what it depends on at run time, and what that depends on.
fn packages_of_page(studio: &Path) -> io::Result<Vec<Component>> {
    let lock: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(studio.join("package-lock.json"))?)?;
    let packages = lock["packages"].as_object().into_iter().flatten();
    let mut found = Vec::new();
    for (path, package) in packages {
        let Some(name) = path.strip_prefix("node_modules/") else { continue };
        if package["dev"] == true && !COMPILED.contains(&name) {
            continue;
        }
        let folder = studio.join(path);
        let missing = |error| {
            io::Error::other(format!(
                "{}: {error}; run `npm ci` in the folder studio",
                folder.display()
            ))
        };
        let manifest = fs::read_to_string(folder.join("package.json")).map_err(missing)?;
        let manifest: serde_json::Value = serde_json::from_str(&manifest)?;
        let text = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
        let repository = &manifest["repository"];
        found.push(Component {
            registry: "npm",
            name: name.to_owned(),
            version: text(&package["version"]),
            licence: text(&manifest["license"]),
            repository: text(repository.get("url").unwrap_or(repository)),
            checksum: None,
            files: licence_files(&folder)?,
        });
    }
    Ok(found)
}

/// Files with licences and notices in the folder of a package, sorted.
fn licence_files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in folder.read_dir()? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
        if path.is_file() && LICENCES.iter().any(|word| name.starts_with(word)) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_in_binaries_are_found() {
        let root = crate::root::find();
        let found = crates(&root, Some("x86_64-unknown-linux-gnu")).unwrap();
        let has = |name: &str| found.iter().any(|one| one.name == name);
        // In each binary, in the command, in the Python package; a macro, a test's library, our own.
        for (name, expect) in [
            ("nalgebra", true),
            ("clap", true),
            ("pyo3", true),
            ("serde_derive", false),
            ("proptest", false),
            ("jointplay-core", false),
        ] {
            assert_eq!(has(name), expect, "{name}");
        }
        let nalgebra = found.iter().find(|one| one.name == "nalgebra").unwrap();
        assert_eq!(nalgebra.licence, "Apache-2.0");
        assert_eq!(nalgebra.checksum.as_ref().map(String::len), Some(64));
        assert!(nalgebra.url().starts_with("pkg:cargo/nalgebra@0."));
        assert!(nalgebra.files.iter().any(|file| file.ends_with("LICENSE")), "{nalgebra:?}");
    }

    #[test]
    fn libraries_of_the_page_are_those_of_its_run() {
        let root = std::env::temp_dir().join(format!("xtask-page-{}", std::process::id()));
        for (name, licence) in [("three", "MIT"), ("svelte", "MIT"), ("@a/b", "ISC")] {
            let folder = root.join("node_modules").join(name);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("package.json"), format!(r#"{{"license": "{licence}"}}"#))
                .unwrap();
            fs::write(folder.join("license.md"), "text").unwrap();
        }
        let lock = r#"{"packages": {"": {}, "node_modules/three": {"version": "1.0.0"},
            "node_modules/svelte": {"version": "5.0.0", "dev": true}, "node_modules/vite": {"version": "8.0.0", "dev": true},
            "node_modules/@a/b": {"version": "2.0.0"}}}"#;
        fs::write(root.join("package-lock.json"), lock).unwrap();
        let found = packages_of_page(&root).unwrap();
        let mut urls: Vec<String> = found.iter().map(Component::url).collect();
        urls.sort();
        fs::remove_dir_all(&root).unwrap();
        assert_eq!(urls, ["pkg:npm/%40a/b@2.0.0", "pkg:npm/svelte@5.0.0", "pkg:npm/three@1.0.0"]);
        assert!(found.iter().all(|one| one.files.len() == 1));
    }
}
