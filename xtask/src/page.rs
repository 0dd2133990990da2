//! `cargo xtask page`: build the studio's page, compare it with the one in the repository, and test it in a browser.
//!
//! `studio/test.mjs` builds and tests; here a Node is found that runs it, the two pages are compared, and the command is built that serves the page.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{fs, io};

use crate::command;

/// Fails on a Node that is too old for the page's tools.
const NEW_ENOUGH: &str = "const [major, minor] = process.versions.node.split('.').map(Number); \
                          process.exit(major > 20 || (major === 20 && minor >= 19) ? 0 : 1)";

/// Where `studio/test.mjs` builds page and playground to compare them, the folders that they have in the repository, and what builds them there.
const PARTS: [[&str; 3]; 2] = [
    ["target/page/built", "crates/jointplay-studio/page", "npm run build"],
    ["target/page/playground", "docs/playground", "npm run playground"],
];

/// Builds and tests the page at `root`; true if all passed.
pub(crate) fn run(root: &Path) -> bool {
    build(root) && browse(root)
}

/// Whether the page is built from the present sources, and passes the tests without a browser.
pub(crate) fn build(root: &Path) -> bool {
    test(None, root) && PARTS.iter().all(|part| is_current(part, root))
}

/// Whether the page passes the tests in a browser, and so does the book.
pub(crate) fn browse(root: &Path) -> bool {
    // Debug builds of the command read the page from its folder: a new page needs no new command.
    command::built(root).is_some_and(|command| test(Some(command), root))
}

fn test(command: Option<PathBuf>, root: &Path) -> bool {
    let Some(node) = find() else { return false };
    let mut test = Command::new(node);
    test.arg("studio/test.mjs").args(command).current_dir(root);
    test.status().is_ok_and(|status| status.success())
}

/// Whether a built folder of the repository is what its sources give, byte for byte; prints what differs.
fn is_current([built, committed, command]: &[&str; 3], root: &Path) -> bool {
    let differences = match (files(&root.join(built)), files(&root.join(committed))) {
        (Ok(built), Ok(committed)) => differences(&built, &committed),
        (Err(error), _) => vec![format!("cannot read {built}: {error}")],
        (_, Err(error)) => vec![format!("cannot read {committed}: {error}")],
    };
    if differences.is_empty() {
        return true;
    }
    eprintln!("page: {committed} is not what the folder studio gives:");
    for difference in &differences {
        eprintln!("  {difference}");
    }
    eprintln!("run `{command}` in the folder studio, and commit {committed}");
    false
}

/// The files of a folder and of all folders in it, by their path within it.
fn files(folder: &Path) -> io::Result<BTreeMap<PathBuf, Vec<u8>>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![PathBuf::new()];
    while let Some(within) = folders.pop() {
        for entry in folder.join(&within).read_dir()? {
            let entry = entry?;
            let path = within.join(entry.file_name());
            if entry.file_type()?.is_dir() {
                folders.push(path);
            } else {
                found.insert(path, fs::read(entry.path())?);
            }
        }
    }
    Ok(found)
}

/// One line for each file that only one of two folders has, or that differs.
fn differences(
    built: &BTreeMap<PathBuf, Vec<u8>>,
    committed: &BTreeMap<PathBuf, Vec<u8>>,
) -> Vec<String> {
    let missing = built.iter().filter_map(|(path, bytes)| match committed.get(path) {
        None => Some(format!("{} is missing", path.display())),
        Some(other) if other != bytes => Some(format!("{} differs", path.display())),
        Some(_) => None,
    });
    let obsolete = committed.keys().filter(|path| !built.contains_key(*path));
    missing.chain(obsolete.map(|path| format!("{} is obsolete", path.display()))).collect()
}

/// The name of a Node that is new enough; prints an error if there is none.
pub(crate) fn find() -> Option<&'static str> {
    let mut probe = Command::new("node");
    probe.args(["--eval", NEW_ENOUGH]).stdout(Stdio::null()).stderr(Stdio::null());
    if !probe.status().is_ok_and(|status| status.success()) {
        eprintln!(
            "page: no Node 20.19 or newer on the path; install one with npm, from https://nodejs.org or your system"
        );
        return None;
    }
    Some("node")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[(&str, &str)]) -> BTreeMap<PathBuf, Vec<u8>> {
        files.iter().map(|(path, text)| (PathBuf::from(path), text.as_bytes().to_vec())).collect()
    }

    #[test]
    fn a_page_differs_by_one_byte_one_file_more_or_one_less() {
        let built = folder(&[("index.html", "a"), ("assets/page-1.js", "b")]);
        assert_eq!(differences(&built, &built), <[String; 0]>::default());
        let stale = folder(&[("index.html", "a "), ("assets/page-0.js", "b")]);
        assert_eq!(
            differences(&built, &stale),
            ["assets/page-1.js is missing", "index.html differs", "assets/page-0.js is obsolete"]
        );
    }

    #[test]
    fn files_are_found_in_folders_within() {
        let root = std::env::temp_dir().join(format!("xtask-page-{}", std::process::id()));
        fs::create_dir_all(root.join("assets")).unwrap();
        fs::write(root.join("index.html"), "a").unwrap();
        fs::write(root.join("assets/page.js"), "b").unwrap();
        let found = files(&root);
        fs::remove_dir_all(&root).unwrap();
        assert_eq!(found.unwrap(), folder(&[("index.html", "a"), ("assets/page.js", "b")]));
        assert!(files(&root).is_err());
    }
}
