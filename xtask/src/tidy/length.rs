//! Rust files, README.md and ARCHITECTURE.md stay short, and no file is large.
//!
//! Of a Rust file the lines count up to the test module at its foot: a `#[cfg(test)]` at the
//! start of a line whose module ends the file. Files in a folder `tests`, or named `tests.rs`,
//! do not count.

use crate::finding::Finding;
use crate::rust_source::RustSource;
use crate::tree::{MAX_SIZE, Tree};

/// Most lines a Rust file may have, tests aside.
const RUST_LINES: usize = 500;

/// Documents, and the number of lines each must stay under.
const DOCUMENT_LINES: [(&str, usize); 2] = [("README.md", 100), ("ARCHITECTURE.md", 200)];

pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (path, text) in tree.texts_ending(".rs").filter(|(path, _)| !is_test(path)) {
        let count = lines_without_tests(text);
        if count > RUST_LINES {
            let message =
                format!("{count} lines without tests, more than {RUST_LINES}: part it by concept");
            findings.push(Finding::new(path, RUST_LINES + 1, message));
        }
    }
    for (path, limit) in DOCUMENT_LINES {
        let count = tree.text(path).map_or(0, |text| text.lines().count());
        if count >= limit {
            findings.push(Finding::new(
                path,
                limit,
                format!("{count} lines, must stay under {limit}"),
            ));
        }
    }
    let large = tree.files().filter(|(_, file)| file.size > MAX_SIZE);
    let message = |size: u64| format!("{size} bytes, more than {MAX_SIZE}");
    findings.extend(large.map(|(path, file)| Finding::new(path, 1, message(file.size))));
    findings
}

fn is_test(path: &str) -> bool {
    path.split('/').any(|part| part == "tests" || part == "tests.rs")
}

fn lines_without_tests(text: &str) -> usize {
    let code = RustSource::new(text).code;
    let lines: Vec<&str> = code.lines().collect();
    let last = lines.iter().rposition(|line| line.starts_with("#[cfg(test)]"));
    last.filter(|start| ends_the_file(&lines[*start..].join("\n"))).unwrap_or(lines.len())
}

/// Whether `code`, which starts with `#[cfg(test)]`, is one module and nothing after it.
fn ends_the_file(code: &str) -> bool {
    let is_module = code.lines().any(|line| line.split_whitespace().any(|word| word == "mod"));
    let (mut depth, mut end) = (0_usize, None);
    for (at, c) in code.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 && matches!(c, '}' | ';') {
            end = Some(at + 1);
            break;
        }
    }
    is_module && end.is_some_and(|end| code[end..].trim().is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_file(path: &str, text: &str, expect: bool) {
        assert_eq!(check(&Tree::of(&[(path, text)])).is_empty(), expect, "{path}");
    }

    const TESTS: &str = "#[cfg(test)]\nmod tests {\n    fn a() { b(\"}\") }\n}\n";

    #[test]
    fn rust_files() {
        check_file("src/a.rs", &"x();\n".repeat(500), true);
        check_file("src/a.rs", &"x();\n".repeat(501), false);
        check_file("tests/laws.rs", &"x();\n".repeat(501), true);
        check_file("src/a/tests.rs", &"x();\n".repeat(501), true);
        check_file("src/contests/a.rs", &"x();\n".repeat(501), false);
    }

    #[test]
    fn the_foot_does_not_count() {
        assert_eq!(lines_without_tests(&format!("a();\n\n{TESTS}")), 2);
        assert_eq!(lines_without_tests("a();\n#[cfg(test)]\nmod tests;\n"), 1);
        assert_eq!(lines_without_tests(&format!("a();\n#[cfg(test)]\nuse b;\n{TESTS}")), 3);
    }

    #[test]
    fn tests_elsewhere_count() {
        assert_eq!(lines_without_tests(&format!("{TESTS}a();\n")), 5);
        assert_eq!(lines_without_tests("#[cfg(test)]\nfn helper() {\n}\n"), 3);
        assert_eq!(lines_without_tests("a();\n/*\n#[cfg(test)]\nmod a {}\n*/\nb();\n"), 6);
    }

    #[test]
    fn large_files() {
        check_file("a.csv", &"a".repeat(1_000_000), true);
        check_file("a.csv", &"a".repeat(1_000_001), false);
    }

    #[test]
    fn documents() {
        check_file("README.md", &"a\n".repeat(99), true);
        check_file("README.md", &"a\n".repeat(100), false);
        check_file("ARCHITECTURE.md", &"a\n".repeat(199), true);
        check_file("ARCHITECTURE.md", &"a\n".repeat(200), false);
        check_file("docs/long.md", &"a\n".repeat(900), true);
    }
}
