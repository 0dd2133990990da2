//! No unfinished code and no tests switched off, in code; strings and comments may speak of them.

use crate::finding::Finding;
use crate::rust_source::{RustSource, line_at, words};
use crate::tree::Tree;

/// Macros that have no place in a finished change.
const MACROS: [&str; 3] = ["todo", "unimplemented", "dbg"];

/// Attributes that switch a test off or let any panic pass.
const ATTRIBUTES: [&str; 2] = ["ignore", "should_panic"];

pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (path, text) in tree.texts_ending(".rs") {
        let source = RustSource::new(text);
        for (offset, name) in macros(&source).chain(attributes(&source.code)) {
            findings.push(Finding::new(path, line_at(&source.code, offset), advice(name)));
        }
    }
    findings
}

fn advice(name: &str) -> String {
    match name {
        "ignore" => {
            "#[ignore]: make the test pass, or assert today's answer and say why it is wrong".into()
        }
        "should_panic" => "#[should_panic]: assert on a returned error instead".into(),
        "dbg" => "dbg!: remove it".into(),
        name => format!("{name}!: finish it, or leave it out"),
    }
}

/// Calls of [`MACROS`], each with its offset.
fn macros(source: &RustSource) -> impl Iterator<Item = (usize, &str)> {
    source.words().filter(|(at, word)| {
        let after = source.code[at + word.len()..].trim_start();
        MACROS.contains(word) && after.starts_with('!') && !after.starts_with("!=")
    })
}

/// Uses of [`ATTRIBUTES`], also under `cfg_attr`, each with its offset.
fn attributes(code: &str) -> impl Iterator<Item = (usize, &str)> {
    code.match_indices('#').flat_map(|(at, _)| {
        let inner = code[at + 1..].trim_start().trim_start_matches('!').trim_start();
        let body = inner.strip_prefix('[').map_or("", |body| &body[..bracket_length(body)]);
        let conditional = words(body).next().is_some_and(|(_, first)| first == "cfg_attr");
        let considered = words(body).take(if conditional { usize::MAX } else { 1 });
        considered.filter(|(_, word)| ATTRIBUTES.contains(word)).map(move |(_, word)| (at, word))
    })
}

/// Length of `text` up to the bracket that closes it.
fn bracket_length(text: &str) -> usize {
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        match c {
            '[' => depth += 1,
            ']' if depth == 0 => return at,
            ']' => depth -= 1,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_code(code: &str, expect_lines: &[usize]) {
        let lines: Vec<_> = check(&Tree::of(&[("a.rs", code)])).iter().map(|f| f.line).collect();
        assert_eq!(lines, expect_lines, "{code}");
    }

    #[test]
    fn macros_in_code() {
        check_code(
            "fn a() { todo!() }\nfn b() { unimplemented! (\"c\") }\nlet c = std::dbg!(d);",
            &[1, 2, 3],
        );
    }

    #[test]
    fn attributes_in_code() {
        check_code("#[test]\n#[ignore]\nfn a() {}", &[2]);
        check_code("#[ignore = \"slow\"]\n#[should_panic(expected = \"b\")]\nfn a() {}", &[1, 2]);
        check_code("#[cfg_attr(miri, ignore)]\nfn a() {}", &[1]);
    }

    #[test]
    fn strings_comments_and_other_words() {
        check_code("// todo!()\n/// `dbg!(a)` and #[ignore]\nlet a = \"todo!() #[ignore]\";", &[]);
        check_code("if todo != b { ignore(c[0]) }", &[]);
        check_code("#[serde(ignore)]\n#[derive(Debug)]\nlet should_panic = [ignore];", &[]);
    }
}
