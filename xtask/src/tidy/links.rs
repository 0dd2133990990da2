//! Relative links and images in Markdown lead to a file or folder of the repository.
//!
//! Anchors are not followed, and what has a scheme (`https:`) is not fetched.

use crate::finding::Finding;
use crate::markdown;
use crate::tree::Tree;

pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (path, text) in tree.texts_ending(".md") {
        for reference in markdown::references(text) {
            let target = &reference.target;
            let message = match markdown::resolve(path, target) {
                Ok(Some(resolved)) if !tree.contains(&resolved) => {
                    format!("`{target}` does not exist")
                }
                Ok(_) => continue,
                Err(reason) => format!("`{target}` {reason}"),
            };
            findings.push(Finding::new(path, reference.line, message));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_text(path: &str, text: &str, expect_lines: &[usize]) {
        let tree = Tree::of(&[(path, text), ("docs/a.md", ""), ("docs/figures/b.svg", "")]);
        let found = check(&tree);
        assert_eq!(found.iter().map(|f| f.line).collect::<Vec<_>>(), expect_lines, "{text}");
    }

    #[test]
    fn good_links() {
        check_text(
            "README.md",
            "[a](docs/a.md#x) ![b](docs/figures/b.svg) [c](docs/) [d](#d)",
            &[],
        );
        check_text("docs/theory/c.md", "[a](../a.md)\n<img src=\"../figures/b.svg\">", &[]);
        check_text("README.md", "[a](https://example.org/gone) `[b](gone.md)`", &[]);
    }

    #[test]
    fn bad_links() {
        check_text("README.md", "[a](docs/gone.md)\n\n![b](docs/figures/gone.svg)", &[1, 3]);
        check_text("docs/theory/c.md", "[a](a.md)\n[b](../../../a.md)\n[c]: gone.md", &[1, 2, 3]);
    }
}
