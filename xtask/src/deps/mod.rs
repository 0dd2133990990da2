//! `cargo xtask deps`: does each crate import only what its ring may?
//!
//! Normal and build dependencies count, optional and target-specific ones included; dev-dependencies are free.
//! Examples see every import of the façade's crate, so their code is read instead.

mod rings;

use crate::finding::{self, Finding};
use crate::rust_source::{RustSource, line_at};
use crate::tree::Tree;
use cargo_metadata::{DependencyKind, MetadataCommand};
use rings::{Outside, Rule};
use std::path::Path;

/// A package of the workspace and the libraries that it imports, without dev-dependencies.
struct Package {
    name: String,
    /// Path of its manifest from the top folder.
    manifest: String,
    imports: Vec<Import>,
}

/// An imported package.
struct Import {
    name: String,
    /// Whether it is given by a path.
    is_local: bool,
}

/// Checks the workspace at `root` and prints every finding; true if there is none.
pub(crate) fn run(root: &Path) -> bool {
    let packages = packages(root).map_err(|error| error.to_string());
    let tree = Tree::load(root).map_err(|error| error.to_string());
    match packages.and_then(|packages| Ok((packages, tree?))) {
        Ok((packages, tree)) => {
            let findings = check(&packages).into_iter().chain(check_examples(&tree)).collect();
            finding::report("deps", findings)
        }
        Err(error) => {
            eprintln!("deps: {error}");
            false
        }
    }
}

/// The packages of the workspace at `root`.
fn packages(root: &Path) -> Result<Vec<Package>, cargo_metadata::Error> {
    let metadata = MetadataCommand::new().no_deps().current_dir(root).exec()?;
    let packages = metadata.packages.iter().map(|package| {
        let manifest = package.manifest_path.strip_prefix(&metadata.workspace_root);
        let manifest = manifest.unwrap_or(&package.manifest_path).as_str().replace('\\', "/");
        let used = package.dependencies.iter().filter(|d| d.kind != DependencyKind::Development);
        let imports = used.map(|d| Import { name: d.name.clone(), is_local: d.path.is_some() });
        Package { name: package.name.to_string(), manifest, imports: imports.collect() }
    });
    Ok(packages.collect())
}

/// Findings of all packages against the table of rings.
fn check(packages: &[Package]) -> Vec<Finding> {
    let is_ours = |import: &Import| {
        import.is_local
            || rings::rule(&import.name).is_some()
            || packages.iter().any(|package| package.name == import.name)
    };
    let mut findings = Vec::new();
    for package in packages {
        let Some(rule) = rings::rule(&package.name) else {
            let message =
                format!("crate {} has no ring: add it to xtask/src/deps/rings.rs", package.name);
            findings.push(Finding::new(&package.manifest, 1, message));
            continue;
        };
        let allowed = |import: &&Import| {
            if is_ours(import) {
                rule.ours.contains(&import.name.as_str())
            } else {
                rule.outside.allows(&import.name)
            }
        };
        for import in package.imports.iter().filter(|import| !allowed(import)) {
            findings.push(Finding::new(&package.manifest, 1, violation(rule, &import.name)));
        }
    }
    findings
}

/// Names crate, import, ring, and what is allowed.
fn violation(rule: &Rule, import: &str) -> String {
    let ours = if rule.ours.is_empty() { "none".to_owned() } else { rule.ours.join(", ") };
    let outside = match rule.outside {
        Outside::Only([]) => "none".to_owned(),
        Outside::Only(names) => names.join(", "),
        Outside::AllBut([]) => "any".to_owned(),
        Outside::AllBut(names) => format!("any but {}", names.join(", ")),
    };
    let (name, ring) = (rule.name, rule.ring);
    format!(
        "{name} ({ring}) may not import {import}; allowed of our crates: {ours}; from outside: {outside}"
    )
}

/// Examples use the façade only.
fn check_examples(tree: &Tree) -> Vec<Finding> {
    let refused: Vec<String> = rings::crates_below_facade().collect();
    let mut findings = Vec::new();
    for (path, text) in
        tree.texts_ending(".rs").filter(|(path, _)| path.starts_with("crates/jointplay/examples/"))
    {
        let source = RustSource::new(text);
        for (offset, word) in
            source.words().filter(|(_, word)| refused.iter().any(|name| name == word))
        {
            let message =
                format!("an example may not import {word}; allowed of our crates: jointplay");
            findings.push(Finding::new(path, line_at(&source.code, offset), message));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(name: &str, imports: &[(&str, bool)]) -> Package {
        let imports = imports
            .iter()
            .map(|&(name, is_local)| Import { name: name.into(), is_local })
            .collect();
        Package { name: name.into(), manifest: format!("{name}/Cargo.toml"), imports }
    }

    #[test]
    fn imports_follow_the_rings() {
        let check_import = |name: &str, import: &str, expect: bool| {
            let found = check(&[package(name, &[(import, import.starts_with("jointplay"))])]);
            assert_eq!(found.is_empty(), expect, "{name} imports {import}: {found:?}");
        };
        check_import("jointplay-core", "nalgebra", true);
        check_import("jointplay-core", "serde", false);
        check_import("jointplay-core", "jointplay-study", false);
        check_import("jointplay-study", "jointplay-core", true);
        check_import("jointplay-cell", "jointplay-format", false);
        check_import("jointplay-format", "toml", true);
        check_import("jointplay-format", "jointplay-report", false);
        check_import("jointplay-report", "jointplay-format", true);
        check_import("jointplay-report", "jointplay-interop", false);
        check_import("jointplay-interop", "jointplay-report", true);
        check_import("jointplay-format", "clap_complete", false);
        check_import("jointplay", "nalgebra", false);
        check_import("jointplay-commands", "clap", true);
        check_import("jointplay-commands", "jointplay-core", false);
        // A path is ours wherever it leads.
        assert_eq!(check(&[package("jointplay-commands", &[("serde", true)])]).len(), 1);
    }

    #[test]
    fn a_crate_without_ring_is_refused() {
        // The second finding is its import, though its name does not show that it is ours.
        let found =
            check(&[package("helper", &[]), package("jointplay-commands", &[("helper", false)])]);
        let paths: Vec<_> = found.iter().map(|f| f.path.as_str()).collect();
        assert_eq!(paths, ["helper/Cargo.toml", "jointplay-commands/Cargo.toml"]);
    }

    #[test]
    fn the_message_lists_what_is_allowed() {
        let message = violation(rings::rule("jointplay").unwrap(), "serde");
        assert!(message.starts_with(
            "jointplay (ring 3) may not import serde; allowed of our crates: jointplay-core, "
        ));
        assert!(message.ends_with("from outside: none"), "{message}");
    }

    #[test]
    fn examples_import_the_facade_only() {
        let good = "//! Not jointplay_core.\nuse jointplay::gpr;\n";
        let bad = "use jointplay::gpr;\nuse jointplay_core::linalg;\n";
        let tree = Tree::of(&[
            ("crates/jointplay/examples/01_a.rs", good),
            ("crates/jointplay/examples/02_b.rs", bad),
            ("crates/c/src/lib.rs", bad),
        ]);
        let found: Vec<_> = check_examples(&tree).into_iter().map(|f| (f.path, f.line)).collect();
        assert_eq!(found, [("crates/jointplay/examples/02_b.rs".to_owned(), 2)]);
    }

    #[test]
    fn the_workspace_is_read() {
        let packages = packages(&crate::root::find()).unwrap();
        let xtask = packages.iter().find(|package| package.name == "xtask").unwrap();
        assert_eq!(xtask.manifest, "xtask/Cargo.toml");
        assert!(
            xtask.imports.iter().any(|import| import.name == "cargo_metadata" && !import.is_local)
        );
    }
}
