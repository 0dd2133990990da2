//! `cargo xtask words`: do documents, help, messages, comments and identifiers use the field's terms?
//!
//! `xtask/words.toml` lists words to avoid with the terms to write instead, and the exceptions with their reasons.
//! In Rust files comments, string literals and identifiers are read; in notebooks the source of the cells, without outputs; in Markdown, TOML and all other sources every line.

use crate::finding::{self, Finding};
use crate::rust_source::{RustSource, words};
use crate::tree::Tree;
use serde::Deserialize;
use std::path::Path;

/// The list of words, from the top folder.
const LIST: &str = "xtask/words.toml";

/// Endings of the files that are read as plain text.
const PLAIN: [&str; 16] = [
    ".md", ".svelte", ".ts", ".mjs", ".toml", ".py", ".pyi", ".program", ".c", ".h", ".cpp",
    ".hpp", ".cs", ".sh", ".html", ".css",
];

/// Files that are not read: the list itself, titles of publications, and generated files.
const UNREAD: [&str; 5] = [
    LIST,
    "Cargo.lock",
    "REFERENCES.md",
    "crates/jointplay-c/include/",
    "crates/jointplay-studio/page/",
];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    rule: Vec<Rule>,
    #[serde(default)]
    exception: Vec<Exception>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rule {
    /// Words and phrases of prose, separated by `|`.
    word: String,
    /// Parts of identifiers, separated by `|`.
    #[serde(default)]
    name: String,
    /// Replacement.
    write: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Exception {
    /// File, or the start of its path.
    file: String,
    /// Text of the line.
    text: String,
    /// Why it may stay.
    #[expect(dead_code, reason = "for readers of the list")]
    reason: String,
}

/// Checks the repository at `root` and prints each word to avoid; true if there is none.
pub(crate) fn run(root: &Path) -> bool {
    let checked = Tree::load(root).map_err(|error| error.to_string()).and_then(|tree| check(&tree));
    match checked {
        Ok(findings) => finding::report("words", findings),
        Err(error) => {
            eprintln!("words: {error}");
            false
        }
    }
}

/// One finding for each word to avoid.
fn check(tree: &Tree) -> Result<Vec<Finding>, String> {
    let list: List = toml::from_str(tree.text(LIST).unwrap_or("rule = []"))
        .map_err(|error| format!("{LIST}: {error}"))?;
    let mut findings = Vec::new();
    for (path, text) in tree.texts() {
        if UNREAD.iter().any(|unread| path.starts_with(unread)) {
            continue;
        }
        if path.ends_with(".rs") {
            let source = RustSource::new(text);
            list.find(path, text, &source.prose(), Let::OutsideCodeBlocks, &mut findings);
            list.find_names(path, text, &source.code, &mut findings);
        } else if path.ends_with(".ipynb") {
            let source = NotebookSource::new(text);
            list.find(path, text, &source.prose, Let::OutsideCodeBlocks, &mut findings);
            list.find(path, text, &source.code, Let::Nowhere, &mut findings);
            findings.extend(source.unread.map(|line| Finding::new(path, line, COMPACT)));
        } else if PLAIN.iter().any(|ending| path.ends_with(ending)) {
            let keyword = if path.ends_with(".md") { Let::OutsideCodeBlocks } else { Let::Nowhere };
            list.find(path, text, text, keyword, &mut findings);
        }
    }
    Ok(findings)
}

/// Message about a notebook whose cells cannot be read line by line.
const COMPACT: &str =
    "cells are not read: write each line of their source on a line of the file, as Jupyter does";

/// Source of the cells of a notebook, without outputs and metadata.
///
/// Each part has the lines of the file; lines without source are blank.
#[derive(Default)]
struct NotebookSource {
    /// Source of Markdown and raw cells.
    prose: String,
    /// Source of code cells.
    code: String,
    /// First line, from 1, that contains the source of a cell and other keys.
    unread: Option<usize>,
}

impl NotebookSource {
    /// Reads a notebook in the layout of Jupyter: one key or one line of source on each line of the file.
    fn new(text: &str) -> Self {
        let mut notebook = Self::default();
        let (mut is_code, mut in_list) = (false, false);
        for (i, line) in text.lines().enumerate() {
            let line = line.trim();
            let value = line.strip_suffix(',').unwrap_or(line);
            let mut source = None;
            if in_list {
                in_list = value != "]";
                source = unquoted(value);
            } else if let Some(kind) = value.strip_prefix("\"cell_type\":") {
                is_code = kind.trim_start() == "\"code\"";
            } else if let Some(list) = value.strip_prefix("\"source\":") {
                in_list = list.trim_start() == "[";
                source = unquoted(list);
            } else if value.contains("\"source\":") {
                // Quotes within strings of JSON are escaped, so that this is a key.
                notebook.unread.get_or_insert(i + 1);
            }
            let (own, other) = if is_code {
                (&mut notebook.code, &mut notebook.prose)
            } else {
                (&mut notebook.prose, &mut notebook.code)
            };
            own.push_str(&source.unwrap_or_default().replace('\n', " "));
            own.push('\n');
            other.push('\n');
        }
        notebook
    }
}

/// Text of a string of JSON, or of a list of strings; `None` for brackets of a list.
fn unquoted(json: &str) -> Option<String> {
    let one = serde_json::from_str::<String>(json);
    one.or_else(|_| serde_json::from_str::<Vec<String>>(json).map(|lines| lines.concat())).ok()
}

/// Lines in which `let` is a word of prose; elsewhere it begins a declaration.
#[derive(Clone, Copy, PartialEq)]
enum Let {
    /// Lines outside of fenced code blocks, in documents and in comments of Rust files.
    OutsideCodeBlocks,
    /// No line: the file is source code.
    Nowhere,
}

impl List {
    /// Finds words of prose; `let` only where it is no keyword.
    fn find(&self, path: &str, text: &str, prose: &str, keyword: Let, findings: &mut Vec<Finding>) {
        let rules = self.found_in(prose, |rule| &rule.word);
        let mut in_code_block = false;
        for (i, (line, whole)) in prose.lines().zip(text.lines()).enumerate() {
            let lower = line.to_lowercase();
            in_code_block ^= is_fence(&lower);
            let with_let = keyword == Let::OutsideCodeBlocks && !in_code_block;
            for rule in &rules {
                let found = rule
                    .word
                    .split('|')
                    .find(|word| (with_let || *word != "let") && holds(&lower, word));
                if let Some(word) = found.filter(|_| !self.allows(path, whole)) {
                    findings.push(Finding::new(
                        path,
                        i + 1,
                        format!("\"{}\": write {}", word.trim(), rule.write),
                    ));
                }
            }
        }
    }

    /// Finds parts of identifiers.
    fn find_names(&self, path: &str, text: &str, code: &str, findings: &mut Vec<Finding>) {
        let rules = self.found_in(code, |rule| &rule.name);
        if rules.is_empty() {
            return;
        }
        for (i, (line, whole)) in code.lines().zip(text.lines()).enumerate() {
            for (_, name) in words(line) {
                let parts = parts(name);
                let found = rules.iter().find(|rule| {
                    rule.name
                        .split('|')
                        .filter(|avoid| !avoid.is_empty())
                        .any(|avoid| parts.iter().any(|part| part == avoid))
                });
                if let Some(rule) = found.filter(|_| !self.allows(path, whole)) {
                    findings.push(Finding::new(
                        path,
                        i + 1,
                        format!("`{name}`: write {}", rule.write),
                    ));
                }
            }
        }
    }

    /// Rules of which a word is anywhere in a text, maybe within another: few, so that lines are read quickly.
    fn found_in(&self, text: &str, words: impl Fn(&Rule) -> &str) -> Vec<&Rule> {
        let lower = text.to_lowercase();
        let is_found = |word: &str| !word.is_empty() && lower.contains(word);
        self.rule.iter().filter(|rule| words(rule).split('|').any(is_found)).collect()
    }

    fn allows(&self, path: &str, line: &str) -> bool {
        self.exception
            .iter()
            .any(|exception| path.starts_with(&exception.file) && line.contains(&exception.text))
    }
}

/// Whether a line of a document or a comment opens or closes a code block.
fn is_fence(line: &str) -> bool {
    let line = line.trim_start();
    ["//!", "///"]
        .iter()
        .find_map(|mark| line.strip_prefix(mark))
        .unwrap_or(line)
        .trim_start()
        .starts_with("```")
}

/// Whether a line holds the word between other letters than its own kind.
fn holds(line: &str, word: &str) -> bool {
    line.match_indices(word).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        let after = line[at + word.len()..].chars().next();
        let joins =
            |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == '-');
        !joins(before) && !joins(after)
    }) && !(word == "as well" && line.contains("as well as"))
}

/// Lower-case parts of an identifier, in snake case or camel case.
fn parts(name: &str) -> Vec<String> {
    let mut parts: Vec<String> = vec![String::new()];
    let mut before = ' ';
    for c in name.chars() {
        if c == '_' || c.is_uppercase() && before.is_lowercase() {
            parts.push(String::new());
        }
        if let Some(part) = parts.last_mut().filter(|_| c != '_') {
            part.extend(c.to_lowercase());
        }
        before = c;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULES: &str = "[[rule]]\nword = \"is told|told|let|as well\"\nname = \"told\"\nwrite = \"report\"\n\
                         [[exception]]\nfile = \"a.rs\"\ntext = \"Told by\"\nreason = \"a name\"\n";

    fn found(path: &str, text: &str) -> Vec<String> {
        let findings = check(&Tree::of(&[(LIST, RULES), (path, text)])).unwrap();
        findings.into_iter().map(|f| format!("{}: {}", f.line, f.message)).collect()
    }

    #[test]
    fn comments_strings_and_names_are_read() {
        assert_eq!(
            found("a.rs", "// It is told.\nlet limitTold = 1;\nf(\"told\");\nx.limit_told();"),
            [
                "1: \"is told\": write report",
                "3: \"told\": write report",
                "2: `limitTold`: write report",
                "4: `limit_told`: write report",
            ]
        );
    }

    #[test]
    fn other_words_keywords_and_exceptions_are_not() {
        assert_eq!(
            found("a.rs", "let untold = 1; // retold, told-off, as well as\n// Told by X"),
            <[&str; 0]>::default()
        );
        assert_eq!(found("a.ts", "let x = 1"), <[&str; 0]>::default());
        assert_eq!(found("a.md", "let it be as well"), ["1: \"let\": write report"]);
    }

    #[test]
    fn let_in_code_blocks_is_a_keyword() {
        assert_eq!(
            found("a.rs", "/// let\n/// ```\n/// let x = told();\n/// ```\n//! let"),
            ["1: \"let\": write report", "3: \"told\": write report", "5: \"let\": write report"]
        );
        assert_eq!(found("a.md", "```rust\nlet x = 1;\n```\nlet"), ["4: \"let\": write report"]);
    }

    #[test]
    fn sources_of_other_languages_are_read() {
        for path in ["a.c", "a.h", "a.cpp", "a.hpp", "a.cs", "a.sh", "a.html", "a.css", "a.pyi"] {
            assert_eq!(found(path, "let\n/* as told */"), ["2: \"told\": write report"], "{path}");
        }
        assert_eq!(found("crates/jointplay-c/include/a.h", "told"), <[&str; 0]>::default());
    }

    #[test]
    fn cells_of_notebooks_are_read_and_outputs_are_not() {
        let notebook = r##"{
 "cells": [
  {
   "cell_type": "markdown",
   "metadata": {"note": "told"},
   "source": [
    "let \"it\" be\n",
    "as told, \"source\": 1\n"
   ]
  },
  {
   "cell_type": "code",
   "outputs": [
    {
     "text": [
      "told"
     ]
    }
   ],
   "source": [
    "let = 1\n",
    "print(\"\\ttold\")\n",
    "\ttold]"
   ]
  },
  {
   "cell_type": "raw",
   "source": "told\nonce"
  }
 ]
}
"##;
        let expect = [
            "7: \"let\": write report",
            "8: \"told\": write report",
            "28: \"told\": write report",
            "23: \"told\": write report",
        ];
        assert_eq!(found("a.ipynb", notebook), expect);
        assert_eq!(found("a.json", notebook), <[&str; 0]>::default());
    }

    #[test]
    fn a_compact_notebook_is_reported() {
        let notebook = r#"{"cells": [{"cell_type": "markdown", "source": ["told"]}]}"#;
        assert_eq!(found("a.ipynb", notebook), [format!("1: {COMPACT}")]);
    }

    #[test]
    fn the_list_has_a_reason_for_each_exception() {
        let broken =
            "[[rule]]\nword = \"a\"\nwrite = \"b\"\n[[exception]]\nfile = \"c\"\ntext = \"d\"\n";
        assert!(check(&Tree::of(&[(LIST, broken)])).unwrap_err().contains("reason"));
    }
}
