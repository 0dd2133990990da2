//! Relative links and images in Markdown lead to a file or folder of the repository, and every figure is shown.
//!
//! Anchors are not followed, and a target with a scheme (`https:`) is not fetched.

use crate::finding::Finding;
use crate::markdown::{self, Reference};
use crate::tree::Tree;
use std::collections::BTreeSet;

/// Part of the path of every figure.
const FIGURES: &str = "/figures/";

pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut shown = BTreeSet::new();
    for (path, text) in tree.texts_ending(".md") {
        for (line, reference) in markdown::references(text) {
            let Reference::Target(target) = reference else { continue };
            match markdown::resolve(path, &target) {
                Ok(Some(resolved)) if !tree.contains(&resolved) => {
                    findings.push(Finding::new(path, line, format!("`{target}` does not exist")));
                }
                Ok(resolved) => shown.extend(resolved),
                Err(reason) => {
                    findings.push(Finding::new(path, line, format!("`{target}` {reason}")));
                }
            }
        }
    }
    let figures =
        tree.files().filter(|(path, _)| path.starts_with("docs/") && path.contains(FIGURES));
    let orphans =
        figures.filter(|(path, _)| !shown.contains(*path) && !path.ends_with("README.md"));
    findings
        .extend(orphans.map(|(path, _)| Finding::new(path, 1, "no document shows this figure")));
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_text(path: &str, text: &str, expect: &[(&str, usize)]) {
        let tree = Tree::of(&[(path, text), ("docs/a.md", ""), ("docs/figures/b.svg", "")]);
        let found = check(&tree);
        let found: Vec<_> = found.iter().map(|f| (f.path.as_str(), f.line)).collect();
        assert_eq!(found, expect, "{text}");
    }

    #[test]
    fn good_links() {
        check_text(
            "README.md",
            "[a](docs/a.md#x) ![b](docs/figures/b.svg) [c](docs/) [d](#d)",
            &[],
        );
        check_text("docs/theory/c.md", "[a](../a.md)\n\n<img src=\"../figures/b.svg\">\n", &[]);
        check_text(
            "README.md",
            "[a](https://example.org/absent) `[b](absent.md)` ![b](docs/figures/b.svg)",
            &[],
        );
    }

    #[test]
    fn bad_links_and_figures_that_nothing_shows() {
        check_text(
            "README.md",
            "[a](docs/absent.md)\n\n![b](docs/figures/b.svg)",
            &[("README.md", 1)],
        );
        check_text(
            "docs/c.md",
            "[b](../../a.md)\n",
            &[("docs/c.md", 1), ("docs/figures/b.svg", 1)],
        );
    }
}
