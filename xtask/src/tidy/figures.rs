//! Every file in `docs/figures` is shown somewhere.
//!
//! That is: a link or image of a Markdown file leads to it, or a doc comment of the code names
//! it from the top folder, `docs/figures/name.svg`. A README.md there is no figure.

use crate::finding::Finding;
use crate::markdown;
use crate::rust_source::RustSource;
use crate::tree::Tree;
use std::collections::BTreeSet;

const FOLDER: &str = "docs/figures/";

pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let mut shown = BTreeSet::new();
    for (path, text) in tree.texts_ending(".md") {
        let targets = markdown::references(text);
        shown.extend(targets.iter().filter_map(|r| markdown::resolve(path, &r.target).ok()?));
    }
    for (_, text) in tree.texts_ending(".rs").filter(|(_, text)| text.contains(FOLDER)) {
        for (_, doc) in RustSource::new(text).doc_lines() {
            let names = doc.match_indices(FOLDER).map(|(at, _)| &doc[at..]);
            let ends = |c: char| !(c.is_alphanumeric() || "_-./".contains(c));
            let words = names.map(|name| name.split(ends).next().unwrap_or(name));
            shown.extend(words.map(|word| word.trim_end_matches('.').to_owned()));
        }
    }
    let figures =
        tree.files().filter(|(path, _)| path.starts_with(FOLDER) && !path.ends_with("/README.md"));
    let orphans = figures.filter(|(path, _)| !shown.contains(*path));
    orphans.map(|(path, _)| Finding::new(path, 1, "no document shows this figure")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_with(path: &str, text: &str, expect_orphans: &[&str]) {
        let tree =
            Tree::of(&[(path, text), ("docs/figures/a.svg", ""), ("docs/figures/README.md", "")]);
        let found = check(&tree);
        assert_eq!(
            found.iter().map(|f| f.path.as_str()).collect::<Vec<_>>(),
            expect_orphans,
            "{text}"
        );
    }

    #[test]
    fn shown_figures() {
        check_with("README.md", "![a](docs/figures/a.svg)", &[]);
        check_with("docs/theory/b.md", "<img src='../figures/a.svg'>", &[]);
        check_with("src/lib.rs", "//! See docs/figures/a.svg.", &[]);
    }

    #[test]
    fn orphans() {
        check_with("README.md", "docs/figures/a.svg is a figure", &["docs/figures/a.svg"]);
        check_with("docs/b.md", "![a](a.svg)", &["docs/figures/a.svg"]);
        check_with("src/lib.rs", "let a = \"docs/figures/a.svg\";", &["docs/figures/a.svg"]);
    }
}
