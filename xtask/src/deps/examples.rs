//! Examples use the façade only, though cargo lets them see all that the façade imports.

use super::rings;
use crate::finding::Finding;
use crate::rust_source::{RustSource, line_at};
use crate::tree::Tree;

pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let refused: Vec<String> = rings::crates_below_facade().collect();
    let mut findings = Vec::new();
    for (path, text) in tree.texts_ending(".rs").filter(|(path, _)| path.starts_with("examples/")) {
        let source = RustSource::new(text);
        for (offset, word) in
            source.words().filter(|(_, word)| refused.iter().any(|name| name == word))
        {
            let message =
                format!("example (ring 4) may not import {word}; allowed of our crates: jointplay");
            findings.push(Finding::new(path, line_at(&source.code, offset), message));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_facade() {
        let good = "//! Not jointplay_core.\nuse jointplay::gpr;\n";
        let bad = "use jointplay::gpr;\nuse jointplay_core::linalg;\n";
        let tree = Tree::of(&[
            ("examples/01_a.rs", good),
            ("examples/02_b.rs", bad),
            ("crates/c/src/lib.rs", bad),
        ]);
        let found: Vec<_> = check(&tree).into_iter().map(|f| (f.path, f.line)).collect();
        assert_eq!(found, [("examples/02_b.rs".to_owned(), 2)]);
    }
}
