//! `cargo xtask deps`: does each crate import only what its ring may?
//!
//! Normal and build dependencies count, optional and target-specific ones too; dev-dependencies
//! are free. Examples see every import of the façade's crate, so their code is read instead.

mod examples;
mod package;
mod rings;

use crate::finding::{self, Finding};
use crate::tree::Tree;
use package::{Dependency, Kind, Package};
use rings::{Outside, Rule};
use std::path::Path;

/// Checks the workspace at `root` and prints every finding; true if there is none.
pub(crate) fn run(root: &Path) -> bool {
    let packages = package::of_workspace(root);
    let tree = Tree::load(root).map_err(|error| error.to_string());
    match packages.and_then(|packages| Ok((packages, tree?))) {
        Ok((packages, tree)) => {
            let findings = check(&packages).into_iter().chain(examples::check(&tree)).collect();
            finding::report("deps", findings)
        }
        Err(error) => {
            eprintln!("deps: {error}");
            false
        }
    }
}

/// Findings of all packages against the table of rings.
fn check(packages: &[Package]) -> Vec<Finding> {
    let is_ours = |dependency: &Dependency| {
        dependency.is_local
            || rings::rule(&dependency.name).is_some()
            || packages.iter().any(|package| package.name == dependency.name)
    };
    let mut findings = Vec::new();
    for package in packages {
        let Some(rule) = rings::rule(&package.name) else {
            let message =
                format!("crate {} has no ring: add it to xtask/src/deps/rings.rs", package.name);
            findings.push(Finding::new(&package.manifest, 1, message));
            continue;
        };
        for dependency in package.dependencies.iter().filter(|d| d.kind != Kind::Dev) {
            let allowed = if is_ours(dependency) {
                rule.ours.contains(&dependency.name.as_str())
            } else {
                rule.outside.allows(&dependency.name)
            };
            if !allowed {
                let line = package.line_of(&dependency.name);
                findings.push(Finding::new(&package.manifest, line, violation(rule, dependency)));
            }
        }
    }
    findings
}

/// Names crate, dependency, ring, and what is allowed.
fn violation(rule: &Rule, dependency: &Dependency) -> String {
    let kind = if dependency.kind == Kind::Build { "build dependency " } else { "" };
    let ours = if rule.ours.is_empty() { "none".to_owned() } else { rule.ours.join(", ") };
    let outside = match rule.outside {
        Outside::Only([]) => "none".to_owned(),
        Outside::Only(names) => names.join(", "),
        Outside::AllBut([]) => "any".to_owned(),
        Outside::AllBut(names) => format!("any but {}", names.join(", ")),
    };
    let (name, ring) = (rule.name, rule.ring);
    format!(
        "{name} ({ring}) may not import {kind}{}; allowed of our crates: {ours}; from outside: {outside}",
        dependency.name
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dependency(name: &str, kind: Kind) -> Dependency {
        Dependency { name: name.into(), kind, is_local: name.starts_with("jointplay") }
    }

    /// Expects `names` of the imports of `package` to be refused.
    fn check_imports(package: &str, imports: &[&str], expect_refused: &[&str]) {
        for kind in [Kind::Normal, Kind::Build] {
            let dependencies = imports.iter().map(|name| dependency(name, kind)).collect();
            let packages = [Package {
                name: package.into(),
                manifest: "m".into(),
                text: String::new(),
                dependencies,
            }];
            let messages: Vec<_> = check(&packages).into_iter().map(|f| f.message).collect();
            assert_eq!(messages.len(), expect_refused.len(), "{package}: {messages:?}");
            for (message, refused) in messages.iter().zip(expect_refused) {
                assert!(message.contains(&format!("{refused};")), "{message}");
                assert!(message.starts_with(package), "{message}");
            }
        }
    }

    #[test]
    fn core_imports_mathematics_only() {
        check_imports("jointplay-core", &["nalgebra", "thiserror", "pulp", "faer"], &[]);
        check_imports(
            "jointplay-core",
            &["serde", "rayon", "jointplay-study"],
            &["serde", "rayon", "jointplay-study"],
        );
    }

    #[test]
    fn studies_and_cells() {
        check_imports(
            "jointplay-study",
            &["jointplay-core", "rayon", "nalgebra", "thiserror"],
            &[],
        );
        check_imports(
            "jointplay-study",
            &["jointplay-cell", "serde"],
            &["jointplay-cell", "serde"],
        );
        check_imports("jointplay-cell", &["jointplay-core", "rsruckig", "parry3d-f64"], &[]);
        check_imports("jointplay-cell", &["jointplay-study"], &["jointplay-study"]);
        check_imports("jointplay-cell", &["jointplay-format"], &["jointplay-format"]);
    }

    #[test]
    fn formats_and_plots_take_libraries_but_no_doors() {
        for package in ["jointplay-format", "jointplay-plot"] {
            check_imports(
                package,
                &["jointplay-core", "jointplay-study", "jointplay-cell", "serde", "toml"],
                &[],
            );
            let refused = ["clap", "clap_complete", "anyhow", "pyo3", "tokio", "axum", "jointplay"];
            check_imports(package, &refused, &refused);
        }
        check_imports("jointplay-plot", &["jointplay-format"], &["jointplay-format"]);
        check_imports("jointplay-report", &["jointplay-format"], &[]);
        check_imports("jointplay-interop", &["jointplay-format", "jointplay-report"], &[]);
        check_imports("jointplay-format", &["jointplay-report"], &["jointplay-report"]);
        check_imports("jointplay-report", &["jointplay-interop"], &["jointplay-interop"]);
    }

    #[test]
    fn the_facade_takes_no_library() {
        check_imports(
            "jointplay",
            &["jointplay-core", "jointplay-study", "jointplay-format", "jointplay-plot"],
            &[],
        );
        check_imports("jointplay", &["nalgebra", "jointplay-cli"], &["nalgebra", "jointplay-cli"]);
    }

    #[test]
    fn doors_see_the_facade_only() {
        let doors = [
            "jointplay-cli",
            "jointplay-studio",
            "jointplay-python",
            "jointplay-c",
            "jointplay-validation",
        ];
        for door in doors {
            check_imports(door, &["jointplay", "clap", "anyhow", "pyo3", "axum"], &[]);
            check_imports(door, &["jointplay-core"], &["jointplay-core"]);
        }
        check_imports("xtask", &["serde_json"], &[]);
        check_imports("xtask", &["jointplay", "clap"], &["jointplay", "clap"]);
    }

    #[test]
    fn dev_dependencies_are_free() {
        let dependencies =
            vec![dependency("proptest", Kind::Dev), dependency("jointplay-cli", Kind::Dev)];
        let package = Package {
            name: "jointplay-core".into(),
            manifest: "m".into(),
            text: String::new(),
            dependencies,
        };
        assert_eq!(check(&[package]), []);
    }

    #[test]
    fn a_crate_without_ring_is_refused() {
        let new = |name: &str, imports: &[&str]| Package {
            name: name.into(),
            manifest: format!("{name}/Cargo.toml"),
            text: String::new(),
            dependencies: imports.iter().map(|name| dependency(name, Kind::Normal)).collect(),
        };
        // The second is also refused as an import, though its name does not show that it is ours.
        let found = check(&[new("helper", &[]), new("jointplay-cli", &["helper"])]);
        let paths: Vec<_> = found.iter().map(|f| f.path.as_str()).collect();
        assert_eq!(paths, ["helper/Cargo.toml", "jointplay-cli/Cargo.toml"]);
    }

    #[test]
    fn a_path_is_ours_wherever_it_leads() {
        let vendored = Dependency { name: "serde".into(), kind: Kind::Normal, is_local: true };
        let dependencies = vec![vendored];
        let package = Package {
            name: "jointplay-cli".into(),
            manifest: "m".into(),
            text: String::new(),
            dependencies,
        };
        assert_eq!(check(&[package]).len(), 1);
    }

    #[test]
    fn the_message_says_what_is_allowed() {
        let message =
            violation(rings::rule("jointplay-study").unwrap(), &dependency("serde", Kind::Build));
        assert_eq!(
            message,
            "jointplay-study (ring 1) may not import build dependency serde; \
             allowed of our crates: jointplay-core; from outside: rayon, nalgebra, thiserror, chacha20"
        );
    }
}
