//! Links of the built book: every one leads to a file and, with `#`, to a place in it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Folder of the book that holds copies of linked files of the repository.
pub(super) const FILES: &str = "files";

/// Folder of the book with the documentation of the library by rustdoc, which checks its links.
pub(super) const RUST: &str = "rust";

/// Files of the repository that the pages of the book link, by their path in the repository.
pub(super) fn files(book: &Path) -> io::Result<Vec<String>> {
    let mut found = BTreeSet::new();
    for (_, page) in pages(book)? {
        let marker = format!("{FILES}/");
        let targets = attributes(&page, &["href", "src"]);
        found.extend(targets.filter_map(|target| {
            let at = target.trim_start_matches("../");
            at.strip_prefix(&marker).map(|path| path.split('#').next().unwrap_or(path).to_owned())
        }));
    }
    Ok(found.into_iter().collect())
}

/// The links that lead nowhere, each with its page.
pub(super) fn dead(book: &Path) -> io::Result<Vec<String>> {
    let pages = pages(book)?;
    let anchors: BTreeMap<&PathBuf, BTreeSet<&str>> = pages
        .iter()
        .map(|(path, page)| (path, attributes(page, &["id", "name"]).collect()))
        .collect();
    let mut dead = Vec::new();
    for (path, page) in &pages {
        for target in attributes(page, &["href", "src"]) {
            if target.contains(':') || target.is_empty() {
                continue;
            }
            let (file, anchor) =
                target.split_once('#').map_or((target, None), |(f, a)| (f, Some(a)));
            let there = if file.is_empty() { path.clone() } else { path.with_file_name(file) };
            let there = there.canonicalize().unwrap_or(there);
            let is_missing = match anchors.get(&there) {
                Some(ids) => {
                    anchor.is_some_and(|anchor| !anchor.is_empty() && !ids.contains(anchor))
                }
                None => !there.exists(),
            };
            let page = path.strip_prefix(book).unwrap_or(path).display();
            if target.starts_with('/') {
                dead.push(format!(
                    "{page}: {target} is outside of the book where that is in a folder of its host"
                ));
            } else if is_missing {
                dead.push(format!("{page}: {target} does not exist"));
            }
        }
    }
    Ok(dead)
}

/// Every HTML page in a folder and in all folders in it, but not those that are copies of files or by rustdoc.
pub(super) fn pages(book: &Path) -> io::Result<Vec<(PathBuf, String)>> {
    let mut found = Vec::new();
    let mut folders = vec![book.canonicalize()?];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() && ![FILES, RUST].iter().any(|name| path.ends_with(name)) {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "html") {
                let text = fs::read_to_string(&path)?;
                found.push((path, text));
            }
        }
    }
    Ok(found)
}

/// Values of attributes with these names.
fn attributes<'a>(page: &'a str, names: &'a [&str]) -> impl Iterator<Item = &'a str> {
    names.iter().flat_map(move |name| {
        page.split('<').filter_map(move |tag| {
            let tag = tag.split('>').next()?;
            let (_, after) = tag.split_once(&format!(" {name}=\""))?;
            after.split('"').next()
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dead_links_and_anchors_are_found() {
        let book = std::env::temp_dir().join(format!("xtask-book-{}", std::process::id()));
        fs::create_dir_all(book.join("a")).unwrap();
        fs::write(
            book.join("index.html"),
            "<a href=\"a/b.html#c\"><a href=\"a/b.html#d\"><img src=\"e.svg\"><a href=\"rust/x.html\">",
        )
        .unwrap();
        fs::create_dir_all(book.join("rust")).unwrap();
        fs::write(book.join("rust/x.html"), "<a href=\"y.html\">").unwrap();
        fs::write(
            book.join("a/b.html"),
            "<h2 id=\"c\"></h2><a href=\"#c\"><a href=\"../files/x/y.toml#z\">",
        )
        .unwrap();
        // A page of mdBook for missing pages, which works at the top of a host only.
        fs::write(book.join("404.html"), "<base href=\"/\"><img src=\"/e.svg\">").unwrap();
        let (found, files) = (dead(&book).unwrap(), files(&book).unwrap());
        fs::remove_dir_all(&book).unwrap();
        assert_eq!(files, ["x/y.toml"]);
        let outside = found.iter().filter(|line| line.starts_with("404.html: /")).count();
        assert_eq!((found.len(), outside), (5, 2), "{found:?}");
    }
}
