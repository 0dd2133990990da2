//! Third-party libraries in the binaries: crates in programs and libraries, packages of npm in the page of the studio.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::{fs, io};

use cargo_metadata::{
    CargoOpt, DependencyKind, Metadata, MetadataCommand, Package, PackageId, TargetKind,
};
use serde_json::{Map, Value};

/// Packages of the workspace that are compiled into binaries.
const BINARIES: [&str; 3] = ["jointplay-cli", "jointplay-c", "jointplay-python"];

/// Packages of npm that the page names among its tools, although they and what they depend on are compiled into it.
const COMPILED: [&str; 1] = ["svelte"];

/// Tools of the page that add code of their own to it, but none of their dependencies.
const TOOLS_WITH_CODE: [&str; 1] = ["vite"];

/// Entries of a package in the lock file that name packages it uses when it runs, and whether each has to be there.
const USES: [(&str, bool); 3] =
    [("dependencies", true), ("optionalDependencies", false), ("peerDependencies", false)];

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

/// Packages of npm that are in the page.
pub(super) fn packages_of_page(studio: &Path) -> io::Result<Vec<Component>> {
    let lock: Value = serde_json::from_str(&fs::read_to_string(studio.join("package-lock.json"))?)?;
    let packages = lock["packages"].as_object().cloned().unwrap_or_default();
    let mut found = Vec::new();
    for path in in_page(&packages)? {
        let folder = studio.join(path);
        let missing = |error| {
            io::Error::other(format!(
                "{}: {error}; run `npm ci` in the folder studio",
                folder.display()
            ))
        };
        let manifest = fs::read_to_string(folder.join("package.json")).map_err(missing)?;
        let manifest: Value = serde_json::from_str(&manifest)?;
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let repository = &manifest["repository"];
        found.push(Component {
            registry: "npm",
            name: path.rsplit("node_modules/").next().unwrap_or(path).to_owned(),
            version: text(&packages[path]["version"]),
            licence: text(&manifest["license"]),
            repository: text(repository.get("url").unwrap_or(repository)),
            checksum: None,
            files: licence_files(&folder)?,
        });
    }
    Ok(found)
}

/// Paths in a lock file of npm of all packages whose code can be in the page.
///
/// These are the packages that the page uses when it runs, and those with code in it although the lock file marks them as tools.
/// The bundler omits modules that nothing imports: the page contains no other packages, and possibly fewer.
fn in_page(packages: &Map<String, Value>) -> io::Result<BTreeSet<&str>> {
    let at_run_time = packages
        .iter()
        .filter(|(path, package)| path.starts_with("node_modules/") && package["dev"] != true);
    let mut found: BTreeSet<&str> = at_run_time.map(|(path, _)| path.as_str()).collect();
    let mut open = Vec::new();
    for name in COMPILED {
        open.extend(installed(packages, "", name, true)?);
    }
    while let Some(path) = open.pop() {
        if !found.insert(path) {
            continue;
        }
        for (entry, required) in USES {
            for name in packages[path][entry].as_object().into_iter().flat_map(Map::keys) {
                open.extend(installed(packages, path, name, required)?);
            }
        }
    }
    for name in TOOLS_WITH_CODE {
        found.extend(installed(packages, "", name, true)?);
    }
    Ok(found)
}

/// The path of the package that Node loads as `name` from the package at the path `user`: the nearest one.
///
/// # Errors
/// If the package is required and not in the lock file.
fn installed<'a>(
    packages: &'a Map<String, Value>,
    user: &str,
    name: &str,
    required: bool,
) -> io::Result<Option<&'a str>> {
    let mut folder = user;
    loop {
        let path = format!("{folder}/node_modules/{name}");
        if let Some((path, _)) = packages.get_key_value(path.trim_start_matches('/')) {
            return Ok(Some(path));
        }
        if folder.is_empty() {
            break;
        }
        folder = folder.rfind("node_modules/").map_or("", |end| &folder[..end]);
        folder = folder.trim_end_matches('/');
    }
    if required {
        let message = format!(
            "{name}, which {} needs, is not in studio/package-lock.json; run `npm install` in the folder studio",
            if user.is_empty() { "the page" } else { user }
        );
        return Err(io::Error::other(message));
    }
    Ok(None)
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

    /// Paths in the page for a lock file with these packages.
    fn paths(packages: &str) -> io::Result<Vec<String>> {
        let packages: Map<String, Value> = serde_json::from_str(packages).unwrap();
        Ok(in_page(&packages)?.into_iter().map(str::to_owned).collect())
    }

    #[test]
    fn dependencies_of_compiled_packages_are_in_the_page_and_those_of_tools_are_not() {
        let packages = r#"{"": {"dependencies": {"three": "1"}},
            "node_modules/three": {},
            "node_modules/svelte": {"dev": true, "dependencies": {"clsx": "2", "magic": "1"},
                "optionalDependencies": {"absent": "1"}, "peerDependencies": {"@a/peer": "1"}},
            "node_modules/clsx": {"dev": true, "dependencies": {"svelte": "5"}},
            "node_modules/magic": {"dev": true},
            "node_modules/svelte/node_modules/magic": {"dev": true, "dependencies": {"codec": "1"}},
            "node_modules/codec": {"dev": true},
            "node_modules/@a/peer": {"dev": true},
            "node_modules/vite": {"dev": true, "dependencies": {"css": "1"}},
            "node_modules/css": {"dev": true}}"#;
        let expect = [
            "node_modules/@a/peer",
            "node_modules/clsx",
            "node_modules/codec",
            "node_modules/svelte",
            "node_modules/svelte/node_modules/magic",
            "node_modules/three",
            "node_modules/vite",
        ];
        assert_eq!(paths(packages).unwrap(), expect);
        let incomplete = packages.replace("node_modules/codec", "node_modules/other");
        let message = paths(&incomplete).unwrap_err().to_string();
        assert!(message.starts_with("codec, which node_modules/svelte/node_modules/magic needs"));
        assert!(paths("{}").unwrap_err().to_string().starts_with("svelte, which the page needs"));
    }

    #[test]
    fn packages_of_the_built_page_are_found_in_its_lock_file() {
        let lock = crate::root::find().join("studio/package-lock.json");
        let lock: Value = serde_json::from_str(&fs::read_to_string(lock).unwrap()).unwrap();
        let packages = lock["packages"].as_object().unwrap();
        let found = in_page(packages).unwrap();
        // Packages with modules in source maps of the built page, by `vite build --sourcemap`, and its helper of vite.
        let built = "@codemirror/commands @codemirror/language @codemirror/lint @codemirror/state \
             @codemirror/streamparser @codemirror/view @lezer/common @lezer/highlight \
             @marijn/find-cluster-break @uwdata/flechette clsx crelt style-mod svelte three uplot \
             vite w3c-keyname";
        for name in built.split_whitespace() {
            assert!(found.contains(&*format!("node_modules/{name}")), "{name}");
        }
        for name in ["vitest", "typescript", "playwright-core", "lightningcss"] {
            let path = format!("node_modules/{name}");
            assert!(packages.contains_key(&path) && !found.contains(&*path), "{name}");
        }
    }

    #[test]
    fn packages_of_npm_state_their_licence_and_its_files() {
        let root = std::env::temp_dir().join(format!("xtask-npm-{}", std::process::id()));
        let packages = ["three", "svelte", "@a/b", "vite", "svelte/node_modules/three"];
        for name in packages {
            let folder = root.join("node_modules").join(name);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("package.json"), r#"{"license": "ISC"}"#).unwrap();
            fs::write(folder.join("license.md"), "text").unwrap();
        }
        let lock = r#"{"packages": {"": {}, "node_modules/three": {"version": "1.0.0"},
            "node_modules/svelte": {"version": "5.0.0", "dev": true, "dependencies": {"three": "2"}},
            "node_modules/svelte/node_modules/three": {"version": "2.0.0", "dev": true},
            "node_modules/vite": {"version": "8.0.0", "dev": true},
            "node_modules/@a/b": {"version": "2.0.0"}}}"#;
        fs::write(root.join("package-lock.json"), lock).unwrap();
        let found = packages_of_page(&root).unwrap();
        fs::remove_file(root.join("node_modules/vite/package.json")).unwrap();
        let missing = packages_of_page(&root).unwrap_err().to_string();
        fs::remove_dir_all(&root).unwrap();
        let mut urls: Vec<String> = found.iter().map(Component::url).collect();
        urls.sort();
        let expect = [
            "pkg:npm/%40a/b@2.0.0",
            "pkg:npm/svelte@5.0.0",
            "pkg:npm/three@1.0.0",
            "pkg:npm/three@2.0.0",
            "pkg:npm/vite@8.0.0",
        ];
        assert_eq!(urls, expect);
        assert!(found.iter().all(|one| one.files.len() == 1 && one.licence == "ISC"));
        assert!(missing.contains("vite") && missing.contains("npm ci"), "{missing}");
    }
}
