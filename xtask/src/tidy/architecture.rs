//! Every path and crate that ARCHITECTURE.md names exists.
//!
//! What counts as a path, outside fenced code:
//! - a code span that is one word of ASCII letters, digits and `_ - . / *` (and `…`), and
//!   holds a `/` or ends in one of [`EXTENSIONS`]. With a `/` at its start it is none (a route
//!   of the server, say).
//! - Of several parts, it is read from the top folder: `crates/jointplay-core/src`.
//! - Of one part (`linalg.rs`, `robots/`), it may lie anywhere.
//! - `*` and `…` stand for any run of letters within one part.
//!
//! A code span `jointplay-…` must be the name of a package. Inside fenced code, drawn folder
//! trees are read (see [`tree_drawing`]). Links are checked with those of all Markdown.

use super::tree_drawing;
use crate::finding::Finding;
use crate::markdown::{self, code_spans};
use crate::tree::Tree;

const FILE: &str = "ARCHITECTURE.md";

/// Endings that make a word without `/` a file name.
const EXTENSIONS: [&str; 20] = [
    "c", "css", "csv", "h", "html", "js", "json", "lock", "md", "png", "py", "pyi", "rs", "sh",
    "svelte", "svg", "toml", "ts", "txt", "yml",
];

pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let Some(text) = tree.text(FILE) else { return Vec::new() };
    let mut findings = Vec::new();
    let lines = markdown::lines(text);
    for line in lines.iter().filter(|line| !line.fenced) {
        for span in code_spans(line.text).0 {
            if is_path(span) && !exists(tree, span) {
                findings.push(Finding::new(FILE, line.number, format!("`{span}` does not exist")));
            } else if is_crate(span) && !has_package(tree, span) {
                let message = format!("`{span}` is not the name of a package");
                findings.push(Finding::new(FILE, line.number, message));
            }
        }
    }
    for (line, path) in tree_drawing::paths(&lines) {
        if !exists_from_top(tree, &path) {
            findings.push(Finding::new(
                FILE,
                line,
                format!("`{path}` in the drawn tree does not exist"),
            ));
        }
    }
    findings
}

fn is_path(span: &str) -> bool {
    let letters = span.chars().all(|c| c.is_ascii_alphanumeric() || "_-./*…".contains(c));
    let extension = span.rsplit_once('.').is_some_and(|(_, end)| EXTENSIONS.contains(&end));
    letters && !span.starts_with('/') && (span.contains('/') || extension)
}

fn is_crate(span: &str) -> bool {
    span.starts_with("jointplay-") && span.chars().all(|c| c.is_ascii_lowercase() || c == '-')
}

fn has_package(tree: &Tree, name: &str) -> bool {
    let line = format!("name = \"{name}\"");
    tree.texts_ending("Cargo.toml").any(|(_, manifest)| manifest.lines().any(|l| l.trim() == line))
}

fn exists(tree: &Tree, path: &str) -> bool {
    if path.trim_end_matches('/').contains('/') {
        return exists_from_top(tree, path);
    }
    tree.entries().any(|entry| {
        let name = entry.rsplit('/').next().unwrap_or(entry);
        fits(tree, path, name, entry)
    })
}

fn exists_from_top(tree: &Tree, path: &str) -> bool {
    let path = path.strip_prefix("./").unwrap_or(path);
    tree.entries().any(|entry| fits(tree, path, entry, entry))
}

/// Whether `path` matches `candidate`, a way to write `entry`; with `/` at its end it wants a folder.
fn fits(tree: &Tree, path: &str, candidate: &str, entry: &str) -> bool {
    let wanted = path.trim_end_matches('/');
    let kind = wanted.len() == path.len() || tree.is_folder(entry);
    let mut parts = (wanted.split('/'), candidate.split('/'));
    kind && wanted.matches('/').count() == candidate.matches('/').count()
        && parts.0.by_ref().zip(parts.1.by_ref()).all(|(pattern, part)| part_fits(pattern, part))
}

/// Whether one part of a path matches a pattern in which `*` and `…` stand for any run of letters.
fn part_fits(pattern: &str, part: &str) -> bool {
    let Some((fixed, after)) = pattern.split_once(['*', '…']) else { return pattern == part };
    let Some(rest) = part.strip_prefix(fixed) else { return false };
    let mut tails = rest.char_indices().map(|(at, _)| &rest[at..]).chain([""]);
    tails.any(|tail| part_fits(after, tail))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_text(architecture: &str, expect_lines: &[usize]) {
        let tree = Tree::of(&[
            (FILE, architecture),
            ("crates/jointplay-core/Cargo.toml", "[package]\nname = \"jointplay-core\"\n"),
            ("crates/jointplay-core/src/linalg.rs", ""),
            ("robots/gpr.toml", ""),
            ("examples/01_gpr.rs", ""),
        ]);
        let lines: Vec<_> = check(&tree).iter().map(|finding| finding.line).collect();
        assert_eq!(lines, expect_lines, "{architecture}");
    }

    #[test]
    fn paths_from_the_top() {
        check_text(
            "`crates/jointplay-core/src/linalg.rs`, `crates/jointplay-core`, `robots/gpr.toml`",
            &[],
        );
        check_text("ok\n`crates/gone/` and `robots/gone.toml`", &[2, 2]);
        check_text("`jointplay-core/src`", &[1]);
    }

    #[test]
    fn a_single_part_may_lie_anywhere() {
        check_text("`linalg.rs`, `src/`, `robots/`", &[]);
        check_text("`gone.rs`\n`gone/`", &[1, 2]);
        check_text("`linalg.rs/`", &[1]);
    }

    #[test]
    fn patterns() {
        check_text("`robots/*.toml`, `examples/01_…`, `examples/*_gpr.*`", &[]);
        check_text("`robots/*.json`\n`*/linalg.rs`", &[1, 2]);
    }

    #[test]
    fn what_is_no_path() {
        check_text(
            "`constraint::System`, `cargo xtask test`, `∂X/∂P`, `/api/run`, `f(a/b)`, `v1.2`",
            &[],
        );
        check_text("```text\n`gone/a.rs` gone/b.rs\n```", &[]);
    }

    #[test]
    fn crates_are_packages() {
        check_text("`jointplay-core` and `jointplay`", &[]);
        check_text("`jointplay-gone`", &[1]);
    }

    #[test]
    fn drawn_trees() {
        check_text(
            "```text\njointplay/\n├─ robots/  what\n└─ crates/\n   └─ jointplay-core/\n```",
            &[],
        );
        check_text("```text\n├─ robots/\n│  └─ gone.toml  what\n└─ gone/\n```", &[3, 4]);
    }
}
