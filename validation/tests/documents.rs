//! The documents keep their word: tests that they name exist.

use std::collections::BTreeSet;
use std::path::Path;

use jointplay_validation::gallery;

fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Names of the tests of this crate and of all others.
fn tests() -> BTreeSet<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut folders = vec![root.join("crates"), root.join("validation/tests")];
    let mut found = BTreeSet::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("the folder is there") {
            let path = entry.expect("the folder can be read").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = std::fs::read_to_string(&path).expect("a test can be read");
                found.extend(text.split("#[test]").skip(1).filter_map(|after| {
                    let (_, name) = after.split_once("fn ")?;
                    name.split('(').next().map(str::to_owned)
                }));
            }
        }
    }
    found
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
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/explanation");
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("the folder can be read").path();
        let document = path.file_name().expect("a file").to_string_lossy().into_owned();
        for name in named(&read(&format!("docs/explanation/{document}"))) {
            assert!(tests.contains(&name), "{document} names `{name}`, which is no test");
            count += 1;
        }
    }
    assert!(count > 60, "only {count} names found");
}

/// The texts of a picture, in order.
fn texts(svg: &str) -> Vec<&str> {
    svg.split("</text>").filter_map(|part| part.rsplit_once('>').map(|(_, text)| text)).collect()
}

#[test]
fn the_catalogue_page_and_its_pictures_are_current() {
    let cure = "run `cargo run -p jointplay-validation --bin figures`";
    assert_eq!(read("docs/reference/catalogue.md"), gallery::page().expect("a page"), "{cure}");
    let page = read("docs/reference/catalogue.md");
    for (entry, file) in &gallery::mechanisms() {
        let section = page.split(&format!("## {}\n", entry.name)).nth(1).expect("a section");
        let description = section.lines().filter(|line| !line.trim().is_empty()).nth(1);
        assert!(
            description.is_some_and(|text| text.ends_with('.')),
            "{}: {description:?}",
            entry.name
        );
        let committed = read(&format!("docs/figures/catalogue/{}.svg", entry.name));
        let picture = gallery::picture(file).map(|picture| picture.to_svg());
        let drawn = picture.expect("it closes").expect("it can be drawn");
        // Where lines are may differ in the last digit from machine to machine; what is named and how long the scale is does not.
        let (mut committed, mut drawn) = (texts(&committed), texts(&drawn));
        committed.sort_unstable();
        drawn.sort_unstable();
        assert_eq!(committed, drawn, "{}: {cure}", entry.name);
    }
}
