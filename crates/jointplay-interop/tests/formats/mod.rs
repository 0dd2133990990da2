//! Properties of a mechanism that each format keeps, by reading files: the tables of `docs/reference/formats.md`.
#![expect(clippy::unwrap_used, reason = "a failing test may panic")]

mod exports;
mod fixtures;
mod imports;
mod motions;
mod probes;

use std::fmt::Write as _;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/reference/formats.md");

/// A table in Markdown, aligned by nothing.
fn table(corner: &str, columns: &[&str], rows: &[(&str, Vec<String>)]) -> String {
    let mut text = format!("| {corner} | {} |\n", columns.join(" | "));
    writeln!(text, "|{}", " --- |".repeat(columns.len() + 1)).unwrap();
    for (name, cells) in rows {
        assert_eq!(cells.len(), columns.len(), "{name}");
        writeln!(text, "| {name} | {} |", cells.join(" | ")).unwrap();
    }
    text
}

#[test]
fn the_page_states_what_the_formats_keep() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    let mut updated = page.clone();
    let sections = [
        ("## Imports", imports::table()),
        ("## Exports of mechanisms", exports::table()),
        ("## Exports of motions", motions::table()),
    ];
    for (heading, table) in sections {
        let section = updated.find(heading).unwrap_or_else(|| panic!("{heading} is missing"));
        let start = section + updated[section..].find("\n| ").expect("the section has a table") + 1;
        let end = updated[start..].find("\n\n").map_or(updated.len(), |end| start + end + 1);
        updated.replace_range(start..end, &table);
    }
    if updated != page {
        assert!(
            std::env::var_os("INSTA_UPDATE").is_some_and(|how| how == "always"),
            "run the tests with INSTA_UPDATE=always, and read the difference:\n{updated}"
        );
        std::fs::write(PAGE, updated).unwrap();
    }
}
