//! Whether an archive holds all that its sources need, and what a registry shows.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::archives::Unpacked;
use crate::finding::Finding;
use crate::rust_source::line_at;

/// Files that every archive holds.
const EVERYWHERE: [&str; 3] = ["README.md", "LICENSE-MIT", "LICENSE-APACHE"];

/// Largest size of an archive that the Cargo registry accepts (bytes).
const LARGEST: u64 = 10 * 1024 * 1024;

/// How sources name files that are compiled in, and folders.
const EMBEDS: [&str; 4] = ["include_str!(", "include_bytes!(", "#[path = ", FOLDER];

/// How sources name a folder that is compiled in.
const FOLDER: &str = "#[folder = ";

/// Everything that is missing in the archives.
pub(super) fn check(root: &Path, unpacked: &Unpacked) -> io::Result<Vec<Finding>> {
    let mut findings = Vec::new();
    for (name, archive) in &unpacked.packages {
        let package = unpacked.of(name);
        let size = fs::metadata(archive)?.len();
        if size > LARGEST {
            let message = format!("the archive has {size} bytes; at most {LARGEST} are accepted");
            findings.push(Finding::new(name, 1, message));
        }
        for file in EVERYWHERE.iter().filter(|file| !package.join(file).is_file()) {
            findings.push(Finding::new(name, 1, format!("the archive has no {file}")));
        }
        let source = root.join("crates").join(name);
        for file in files(&package.join("src"))? {
            if file.extension().is_none_or(|end| end != "rs") {
                continue;
            }
            let text = fs::read_to_string(&file)?;
            let shown = file.strip_prefix(&unpacked.folder).unwrap_or(&file);
            for (line, embedded) in embedded(&text) {
                let missing = missing(&embedded, &file, &package, &source)?;
                findings.extend(missing.map(|message| {
                    Finding::new(&shown.display().to_string().replace('\\', "/"), line, message)
                }));
            }
        }
    }
    Ok(findings)
}

/// A path that a source names.
#[derive(Debug, PartialEq)]
enum Embedded {
    /// A file, relative to the source.
    File(String),
    /// A folder of which files are chosen by a macro, relative to the source.
    FolderOfSource(String),
    /// A folder, relative to the crate.
    FolderOfCrate(String),
}

/// Files that a source embeds, also in its tests, with lines from 1.
fn embedded(code: &str) -> Vec<(usize, Embedded)> {
    let mut found = Vec::new();
    for mark in EMBEDS {
        for (place, _) in code.match_indices(mark) {
            let rest = &code[place + mark.len()..];
            let Some(path) = rest.split('"').nth(1) else { continue };
            let line_start = code[..place].rfind('\n').map_or(0, |end| end + 1);
            let is_comment = code[line_start..place].trim_start().starts_with("//");
            if is_comment {
                continue;
            }
            let embedded = match (mark == FOLDER, rest.starts_with("concat!(")) {
                (true, _) => Embedded::FolderOfCrate(path.to_owned()),
                (false, true) => Embedded::FolderOfSource(path.to_owned()),
                (false, false) => Embedded::File(path.to_owned()),
            };
            found.push((line_at(code, place), embedded));
        }
    }
    found
}

/// Parts of an embedded file or folder that the archive lacks; `source` is the folder of the crate in the repository.
fn missing(
    embedded: &Embedded,
    file: &Path,
    package: &Path,
    source: &Path,
) -> io::Result<Option<String>> {
    let folder_of_file = file.parent().unwrap_or(package);
    let (path, folder) = match embedded {
        Embedded::File(path) => (path, folder_of_file.join(path)),
        Embedded::FolderOfSource(path) => (path, folder_of_file.join(path)),
        Embedded::FolderOfCrate(path) => (path, package.join(path)),
    };
    let Ok(folder) = folder.canonicalize() else {
        return Ok(Some(format!("\"{path}\" is not in the archive")));
    };
    let Ok(inside) = folder.strip_prefix(package.canonicalize()?).map(Path::to_owned) else {
        return Ok(Some(format!("\"{path}\" is outside the archive")));
    };
    let absent = files(&source.join(&inside))?
        .into_iter()
        .filter_map(|path| Some(path.strip_prefix(source).ok()?.to_owned()))
        .find(|path| !package.join(path).is_file());
    Ok(absent.map(|path| format!("{} is not in the archive", path.display())))
}

/// All files in a folder and below, or the file itself.
fn files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    if folder.is_file() {
        return Ok(vec![folder.to_owned()]);
    }
    let mut found = Vec::new();
    for entry in folder.read_dir()? {
        let path = entry?.path();
        found.append(&mut files(&path)?);
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn embedded_files_are_found_in_code_and_tests() {
        let text = "\
/// As `include_str!(\"no.toml\")`.
const A: &str = include_str!(\"../a.toml\");
macro_rules! b { ($n:expr) => { include_str!(concat!(\"../robots/\", $n)) } }
static C: &[u8] = include_bytes!(
    \"../c.ttf\"
);
#[doc = include_str!(\"guide.md\")]
#[cfg(doctest)]
struct Guide;
#[folder = \"page\"]
#[cfg(test)]
#[path = \"../tests/common.rs\"]
mod common;
mod tests { const D: &str = include_str!(\"d.toml\"); }
";
        let mut found = embedded(text);
        found.sort_by_key(|(line, _)| *line);
        let expect = [
            (2, Embedded::File("../a.toml".to_owned())),
            (3, Embedded::FolderOfSource("../robots/".to_owned())),
            (4, Embedded::File("../c.ttf".to_owned())),
            (7, Embedded::File("guide.md".to_owned())),
            (10, Embedded::FolderOfCrate("page".to_owned())),
            (12, Embedded::File("../tests/common.rs".to_owned())),
            (14, Embedded::File("d.toml".to_owned())),
        ];
        assert_eq!(found, expect);
    }

    #[test]
    fn what_an_archive_lacks_is_reported() {
        let root = std::env::temp_dir().join(format!("xtask-package-{}", std::process::id()));
        let (source, package) = (root.join("crates/a"), root.join("unpacked/a-0.1.0"));
        for (folder, files) in [
            (&source, &["src/lib.rs", "page/x.js", "page/y.js"][..]),
            (&package, &["src/lib.rs", "page/x.js"]),
        ] {
            for file in files {
                fs::create_dir_all(folder.join(file).parent().unwrap()).unwrap();
                fs::write(folder.join(file), "").unwrap();
            }
        }
        let file = package.join("src/lib.rs");
        let check = |embedded: Embedded, expect: Option<&str>| {
            let found = missing(&embedded, &file, &package, &source).unwrap();
            assert_eq!(found.as_deref(), expect);
        };
        check(Embedded::File("../page/x.js".to_owned()), None);
        check(
            Embedded::File("../page/y.js".to_owned()),
            Some("\"../page/y.js\" is not in the archive"),
        );
        check(
            Embedded::File("../../../crates/a/page/y.js".to_owned()),
            Some("\"../../../crates/a/page/y.js\" is outside the archive"),
        );
        check(Embedded::FolderOfCrate("page".to_owned()), Some("page/y.js is not in the archive"));
        fs::remove_file(source.join("page/y.js")).unwrap();
        check(Embedded::FolderOfCrate("page".to_owned()), None);
        fs::remove_dir_all(&root).unwrap();
    }
}
