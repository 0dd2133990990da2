//! Every path and crate that ARCHITECTURE.md names exists.
//!
//! A code span of letters, digits and `_ - . /` counts as a path if it holds a `/` or ends in the extension of a source file.
//! With a `/` inside, it is read from the top folder; a single name may lie anywhere.
//! A code span `jointplay-…` must be the name of a package.

use crate::finding::Finding;
use crate::markdown::{self, Reference};
use crate::tree::Tree;

const FILE: &str = "ARCHITECTURE.md";

/// Endings that make a word without `/` a file name.
const EXTENSIONS: [&str; 8] = [".rs", ".md", ".toml", ".json", ".py", ".ts", ".svelte", ".svg"];

pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let references = markdown::references(tree.text(FILE).unwrap_or_default());
    let spans = references.into_iter().filter_map(|(line, reference)| match reference {
        Reference::Code(span) => Some((line, span)),
        Reference::Target(_) => None,
    });
    let findings = spans.filter_map(|(line, span)| {
        let missing = if is_path(&span) {
            (!exists(tree, span.trim_end_matches('/'))).then_some("does not exist")
        } else {
            (span.starts_with("jointplay-") && !has_package(tree, &span))
                .then_some("is not the name of a package")
        };
        missing.map(|missing| Finding::new(FILE, line, format!("`{span}` {missing}")))
    });
    findings.collect()
}

fn is_path(span: &str) -> bool {
    let letters = span.chars().all(|c| c.is_ascii_alphanumeric() || "_-./".contains(c));
    letters
        && !span.starts_with('/')
        && (span.contains('/') || EXTENSIONS.iter().any(|end| span.ends_with(end)))
}

fn has_package(tree: &Tree, name: &str) -> bool {
    let line = format!("name = \"{name}\"");
    tree.texts_ending("Cargo.toml").any(|(_, manifest)| manifest.lines().any(|l| l.trim() == line))
}

fn exists(tree: &Tree, path: &str) -> bool {
    let anywhere = format!("/{path}");
    tree.contains(path)
        || !path.contains('/') && tree.entries().any(|entry| entry.ends_with(&anywhere))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_and_packages_exist() {
        let check_text = |text: &str, expect_lines: &[usize]| {
            let tree = Tree::of(&[
                (FILE, text),
                ("crates/jointplay-core/Cargo.toml", "[package]\nname = \"jointplay-core\"\n"),
                ("crates/jointplay-core/src/linalg.rs", ""),
            ]);
            let lines: Vec<_> = check(&tree).iter().map(|finding| finding.line).collect();
            assert_eq!(lines, expect_lines, "{text}");
        };
        check_text(
            "`crates/jointplay-core/src/linalg.rs`, `crates/jointplay-core/`, `linalg.rs`, `src/`",
            &[],
        );
        check_text("ok\n`crates/absent/` and `absent.toml`", &[2, 2]);
        check_text("`jointplay-core/src`\n`linalg.rs/`", &[1]);
        check_text("`jointplay-core` and `jointplay-absent`", &[1]);
        check_text(
            "`constraint::System`, `cargo xtask test`, `∂X/∂P`, `/api/run`, `f(a/b)`, `v1.2`",
            &[],
        );
    }
}
