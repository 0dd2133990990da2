//! `cargo xtask tidy`: do the documents and sources keep the house rules?
//!
//! | file           | rule                                                             |
//! | -------------- | ---------------------------------------------------------------- |
//! | `architecture` | every path and crate named in ARCHITECTURE.md exists             |
//! | `sources`      | `# Source` keys and REFERENCES.md agree, in both directions               |
//! | `length`       | Rust files, README.md and ARCHITECTURE.md stay short, no file is large |
//! | `links`        | relative links and images in Markdown exist, every figure is shown |

mod architecture;
mod length;
mod links;
pub(crate) mod sources;

use crate::finding::{self, Finding};
use crate::tree::Tree;
use std::path::Path;

/// Checks the repository at `root` and prints every finding; true if there is none.
pub(crate) fn run(root: &Path) -> bool {
    match Tree::load(root) {
        Ok(tree) => finding::report("tidy", check(&tree)),
        Err(error) => {
            eprintln!("tidy: cannot read {}: {error}", root.display());
            false
        }
    }
}

/// All findings of all rules.
fn check(tree: &Tree) -> Vec<Finding> {
    let rules = [architecture::check, sources::check, length::check, links::check];
    rules.iter().flat_map(|rule| rule(tree)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_of_all_rules_are_listed() {
        let tree = Tree::of(&[
            ("ARCHITECTURE.md", "`absent/a.rs`\n"),
            ("README.md", "[a](absent.md)\n"),
            ("src/a.rs", "/// # Source\n/// [Nobody1900]\nfn b() {}\n"),
            ("src/b.rs", &"x();\n".repeat(501)),
            ("docs/figures/a.svg", ""),
        ]);
        let mut places: Vec<_> =
            check(&tree).iter().map(|f| format!("{}:{}", f.path, f.line)).collect();
        places.sort();
        let expect = [
            "ARCHITECTURE.md:1",
            "README.md:1",
            "docs/figures/a.svg:1",
            "src/a.rs:2",
            "src/b.rs:501",
        ];
        assert_eq!(places, expect);
    }
}
