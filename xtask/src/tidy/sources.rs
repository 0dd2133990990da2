//! `# Source` keys in the code and REFERENCES.md agree, in both directions.
//!
//! REFERENCES.md defines a key on a line that starts with `- **[Key]**`, or with a heading
//! `## [Key]` of any level. A key has at least three characters: a letter, then letters, digits
//! and `- _ . + & : '`.
//!
//! In the code, each bracket in a `# Source` (or `# Sources`) section of a doc comment is a key:
//! `[Key]`, `\[Key\]` (rustdoc takes a bare `[Key]` for a link), `[Key, eq. 5]`, `[Key; Other, p. 7]`,
//! `[Key](…/REFERENCES.md#…)`. Not keys: a link to anything else, a bracket that starts with no
//! letter or a shorter or stranger word (units such as `[m]`), and one that follows a word, as in `x[i]`.
//!
//! A key counts as used when any text file but REFERENCES.md holds it in such a bracket.

use crate::finding::Finding;
use crate::rust_source::RustSource;
use crate::tree::Tree;
use std::collections::{BTreeMap, BTreeSet};

const FILE: &str = "REFERENCES.md";

pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut defined = BTreeMap::new();
    for (line, key) in definitions(tree.text(FILE).unwrap_or_default()) {
        if let Some(first) = defined.insert(key, line) {
            findings.push(Finding::new(
                FILE,
                line,
                format!("[{key}] is already defined on line {first}"),
            ));
        }
    }
    for (path, text) in tree.texts_ending(".rs") {
        for (line, key) in
            cited(text).into_iter().filter(|(_, key)| !defined.contains_key(key.as_str()))
        {
            let message =
                format!("source [{key}] is not in {FILE} (write an item's name in backticks)");
            findings.push(Finding::new(path, line, message));
        }
    }
    let texts = tree.texts().filter(|(path, _)| *path != FILE);
    let used: BTreeSet<&str> = texts.flat_map(|(_, text)| text.lines().flat_map(keys)).collect();
    for (key, line) in defined.iter().filter(|(key, _)| !used.contains(*key)) {
        findings.push(Finding::new(
            FILE,
            *line,
            format!("[{key}] is cited nowhere in code or documents"),
        ));
    }
    findings
}

/// Keys that REFERENCES.md defines, each with its line.
pub(crate) fn definitions(references: &str) -> Vec<(usize, &str)> {
    let lines = references.lines().enumerate();
    lines.filter_map(|(i, line)| Some((i + 1, definition(line)?))).collect()
}

fn definition(line: &str) -> Option<&str> {
    let entry = line.strip_prefix("- **[").and_then(|rest| rest.split_once("]**"));
    let title = line.trim_start_matches('#');
    let heading =
        (title.len() < line.len()).then(|| title.trim_start().strip_prefix('[')).flatten();
    let (key, _) = entry.or_else(|| heading.and_then(|rest| rest.split_once(']')))?;
    (first_key(key) == Some(key)).then_some(key)
}

/// Keys in the `# Source` sections of a Rust file, each with its line.
fn cited(text: &str) -> Vec<(usize, String)> {
    let source = RustSource::new(text);
    let mut found = Vec::new();
    let (mut in_section, mut in_example, mut last_line) = (false, false, 0);
    for (line, doc) in source.doc_lines() {
        if line != last_line + 1 {
            (in_section, in_example) = (false, false);
        }
        last_line = line;
        // In an example, `# ` starts a hidden line, not a heading.
        if doc.trim_start().starts_with("```") {
            in_example = !in_example;
        } else if in_example {
        } else if doc.starts_with('#') {
            let title = doc.trim_start_matches('#').trim();
            in_section = title == "Source" || title == "Sources";
        } else if in_section {
            found.extend(keys(doc).map(|key| (line, key.to_owned())));
        }
    }
    found
}

/// Keys in the brackets of a line.
fn keys(line: &str) -> impl Iterator<Item = &str> {
    line.match_indices('[').flat_map(move |(at, _)| {
        let before = line[..at].chars().next_back();
        let indexes = before.is_some_and(|c| c.is_alphanumeric() || c == '_');
        let (inside, after) = line[at + 1..].split_once(']').unwrap_or_default();
        let link = after.strip_prefix('(').and_then(|target| target.split(')').next());
        let is_key = !indexes && link.is_none_or(|target| target.contains(FILE));
        let pieces = if is_key { inside.trim_end_matches('\\') } else { "" };
        pieces.split(';').filter_map(first_key)
    })
}

/// The key that a piece of a bracket starts with.
fn first_key(piece: &str) -> Option<&str> {
    let word = piece.trim().split(|c: char| c.is_whitespace() || c == ',').next()?;
    let fits = word.chars().all(|c| c.is_alphanumeric() || "-_.+&:'".contains(c));
    let is_key = fits && word.starts_with(char::is_alphabetic) && word.chars().nth(2).is_some();
    is_key.then_some(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_files(references: &str, code: &str, notes: &str, expect: &[(&str, usize)]) {
        let tree = Tree::of(&[(FILE, references), ("a.rs", code), ("notes.md", notes)]);
        let mut found: Vec<_> = check(&tree).into_iter().map(|f| (f.path, f.line)).collect();
        found.sort();
        let expect: Vec<_> =
            expect.iter().map(|(path, line)| ((*path).to_owned(), *line)).collect();
        assert_eq!(found, expect, "{references} | {code} | {notes}");
    }

    const CITING: &str = "/// A.\n///\n/// # Source\n/// [Nobody1900], eq. (3)\nfn a() {}\n";

    #[test]
    fn a_cited_key_is_defined() {
        check_files("- **[Nobody1900]** A title, 1900.\n", CITING, "", &[]);
        check_files("## [Nobody1900] A title\n", CITING, "", &[]);
        check_files("# References\n", CITING, "", &[("a.rs", 4)]);
        check_files("Read [Nobody1900] one day.\n", CITING, "", &[("a.rs", 4)]);
    }

    #[test]
    fn a_defined_key_is_cited() {
        let two = "- **[Nobody1900]** A.\n- **[Else1901]** B.\n";
        check_files(two, CITING, "", &[(FILE, 2)]);
        check_files(two, CITING, "As in [Else1901, p. 3].\n", &[]);
    }

    #[test]
    fn a_key_is_defined_once() {
        check_files("- **[Nobody1900]** A.\n# [Nobody1900]\n", CITING, "", &[(FILE, 2)]);
    }

    #[test]
    fn only_source_sections_cite() {
        let elsewhere =
            "/// [Gone1]\n///\n/// # Source\n/// own\n///\n/// # Errors\n/// [Gone2]\nfn a() {}\n";
        check_files("", elsewhere, "", &[]);
        check_files("", "/// # Source\n/// own\nfn a() {}\n/// [Gone1]\nfn b() {}\n", "", &[]);
        check_files("", "let a = \"\n/// # Source\n/// [Gone1]\n\";\n", "", &[]);
        check_files(
            "",
            "/// ```\n/// # Source\n/// x[Gone1]; [Gone2]\n/// ```\nfn a() {}\n",
            "",
            &[],
        );
    }

    #[test]
    fn a_module_has_sources_too() {
        check_files(
            "",
            "//! A.\n//!\n//! # Sources\n//! - [Gone1]\n//! - [Gone2]\n",
            "",
            &[("a.rs", 4), ("a.rs", 5)],
        );
    }

    #[test]
    fn forms_of_a_key() {
        let check = |line: &str, expect: &[&str]| {
            assert_eq!(keys(line).collect::<Vec<_>>(), expect, "{line}")
        };
        check("[Aa1], [Bb2]; \\[Cc3\\]", &["Aa1", "Bb2", "Cc3"]);
        check("[Aa1, eq. 5] and [Bb2; Cc3, p. 7]", &["Aa1", "Bb2", "Cc3"]);
        check("[Aa1](https://example.org/REFERENCES.md#aa1)", &["Aa1"]);
        check(
            "[`item`], [text](https://example.org), [^one], x[index], [0, 1], [m], [N/mm], [",
            &[],
        );
    }
}
