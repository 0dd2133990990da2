//! `cargo xtask tidy`: do the documents and sources keep the house rules?
//!
//! | file           | rule                                                             |
//! | -------------- | ---------------------------------------------------------------- |
//! | `architecture` | every path and crate named in ARCHITECTURE.md exists             |
//! | `tree_drawing` | reads the paths of a drawn folder tree                           |
//! | `sources`      | `# Source` keys and REFERENCES.md agree, both ways               |
//! | `unfinished`   | no unfinished code, no tests switched off                        |
//! | `length`       | Rust files, README.md and ARCHITECTURE.md stay short             |
//! | `size`         | no large files                                                   |
//! | `links`        | relative links and images in Markdown exist                      |
//! | `figures`      | every figure is shown somewhere                                  |

mod architecture;
mod figures;
mod length;
mod links;
mod size;
pub(crate) mod sources;
mod tree_drawing;
mod unfinished;

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
    let rules = [
        architecture::check,
        sources::check,
        unfinished::check,
        length::check,
        size::check,
        links::check,
        figures::check,
    ];
    rules.iter().flat_map(|rule| rule(tree)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_of_all_rules_are_listed() {
        let tree = Tree::of(&[
            ("ARCHITECTURE.md", "`gone/a.rs`\n"),
            ("README.md", "[a](gone.md)\n"),
            ("src/a.rs", "fn a() { todo!() }\n/// # Source\n/// [Nobody1900]\nfn b() {}\n"),
            ("docs/figures/a.svg", ""),
        ]);
        let mut places: Vec<_> =
            check(&tree).iter().map(|f| format!("{}:{}", f.path, f.line)).collect();
        places.sort();
        let expect = [
            "ARCHITECTURE.md:1",
            "README.md:1",
            "docs/figures/a.svg:1",
            "src/a.rs:1",
            "src/a.rs:3",
        ];
        assert_eq!(places, expect);
    }

    #[test]
    fn a_clean_tree_has_none() {
        let tree = Tree::of(&[
            ("ARCHITECTURE.md", "`src/a.rs`\n"),
            ("README.md", "![a](docs/figures/a.svg)\n"),
            ("REFERENCES.md", "- **[Nobody1900]** A title.\n"),
            ("src/a.rs", "/// # Source\n/// [Nobody1900]\nfn b() {}\n"),
            ("docs/figures/a.svg", ""),
        ]);
        assert_eq!(check(&tree), []);
    }
}
