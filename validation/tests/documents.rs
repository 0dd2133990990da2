//! The documents keep their word: tests that they name exist.

use std::collections::BTreeSet;
use std::path::Path;

fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Names of the tests in this crate.
fn tests() -> BTreeSet<String> {
    ["closed_forms", "errata", "golden", "paper"]
        .iter()
        .flat_map(|file| {
            let text = read(&format!("validation/tests/{file}.rs"));
            let names = text.split("#[test]").skip(1).map(|after| {
                let (_, name) = after.split_once("fn ").expect("a function after #[test]");
                name.split('(').next().expect("split gives one part at least").to_owned()
            });
            names.collect::<Vec<String>>()
        })
        .collect()
}

/// Code spans of a document that can only be names of tests: words of lower case letters, digits and three underscores or more.
fn named(text: &str) -> Vec<String> {
    let spans = text.split('`').skip(1).step_by(2);
    let is_test = |word: &&str| {
        word.matches('_').count() >= 3
            && word.chars().all(|letter| matches!(letter, 'a'..='z' | '0'..='9' | '_'))
    };
    spans.filter(is_test).map(str::to_owned).collect()
}

#[test]
fn every_test_that_a_document_names_exists() {
    let tests = tests();
    assert!(tests.len() > 40, "{tests:?}");
    let mut count = 0;
    for document in ["docs/theory.md", "docs/errata.md", "docs/paper-to-code.md"] {
        for name in named(&read(document)) {
            assert!(tests.contains(&name), "{document} names `{name}`, which is no test");
            count += 1;
        }
    }
    assert!(count > 60, "only {count} names found");
}
