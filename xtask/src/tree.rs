//! The repository's files, without those that `.gitignore` names.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::{fs, io};

/// Largest size a file of the repository may have (byte); larger ones are not read as text either.
pub(crate) const MAX_SIZE: u64 = 1_000_000;

/// A file of the repository.
pub(crate) struct File {
    /// Size on disk (byte).
    pub(crate) size: u64,
    /// Its text, if it is UTF-8 and not larger than [`MAX_SIZE`].
    pub(crate) text: Option<String>,
}

/// All files of the repository, by path from its top folder with `/` between the parts.
pub(crate) struct Tree {
    files: BTreeMap<String, File>,
    /// Files and the folders that hold them. An empty folder is no part of a clone, so none is here.
    entries: BTreeSet<String>,
}

impl Tree {
    /// Reads the files under `root` that a clone would hold after committing everything.
    ///
    /// # Errors
    /// If a folder or file cannot be read.
    pub(crate) fn load(root: &Path) -> io::Result<Self> {
        let mut files = BTreeMap::new();
        let walk = ignore::WalkBuilder::new(root)
            .hidden(false)
            .require_git(false)
            .filter_entry(|entry| entry.file_name() != ".git")
            .build();
        for entry in walk {
            let on_disk = entry.map_err(io::Error::other)?.into_path();
            let metadata = fs::symlink_metadata(&on_disk)?;
            if metadata.is_dir() {
                continue;
            }
            let inside = on_disk.strip_prefix(root).map_err(io::Error::other)?;
            let path = inside.to_string_lossy().replace('\\', "/");
            let size = metadata.len();
            let readable = metadata.is_file() && size <= MAX_SIZE;
            let text = if readable { String::from_utf8(fs::read(&on_disk)?).ok() } else { None };
            files.insert(path, File { size, text });
        }
        Ok(Self::new(files))
    }

    fn new(files: BTreeMap<String, File>) -> Self {
        let mut entries = BTreeSet::new();
        for path in files.keys() {
            entries.extend(path.match_indices('/').map(|(end, _)| path[..end].to_owned()));
            entries.insert(path.clone());
        }
        Self { files, entries }
    }

    /// Every file with its path, in order of path.
    pub(crate) fn files(&self) -> impl Iterator<Item = (&str, &File)> {
        self.files.iter().map(|(path, file)| (path.as_str(), file))
    }

    /// Every text file with its path.
    pub(crate) fn texts(&self) -> impl Iterator<Item = (&str, &str)> {
        self.files().filter_map(|(path, file)| Some((path, file.text.as_deref()?)))
    }

    /// The text files whose name ends in `suffix`, such as `.rs`.
    pub(crate) fn texts_ending(&self, suffix: &str) -> impl Iterator<Item = (&str, &str)> {
        self.texts().filter(move |(path, _)| path.ends_with(suffix))
    }

    /// The text of one file, if it is there.
    pub(crate) fn text(&self, path: &str) -> Option<&str> {
        self.files.get(path)?.text.as_deref()
    }

    /// Whether `path` is a file or a folder; the empty path is the top folder.
    pub(crate) fn contains(&self, path: &str) -> bool {
        path.is_empty() || self.entries.contains(path)
    }

    /// Files and folders, in order of path.
    pub(crate) fn entries(&self) -> impl Iterator<Item = &str> {
        self.entries.iter().map(String::as_str)
    }

    /// A tree that exists only in a test.
    #[cfg(test)]
    pub(crate) fn of(texts: &[(&str, &str)]) -> Self {
        let file = |text: &str| File { size: text.len() as u64, text: Some(text.to_owned()) };
        Self::new(texts.iter().map(|(path, text)| ((*path).to_owned(), file(text))).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_those_of_the_files() {
        let tree = Tree::of(&[("a/b/c.rs", ""), ("d.md", "")]);
        for path in ["", "a", "a/b", "a/b/c.rs", "d.md"] {
            assert!(tree.contains(path), "{path}");
        }
        for path in ["b", "a/c.rs", "a/b/", "d"] {
            assert!(!tree.contains(path), "{path}");
        }
    }

    #[test]
    fn ignored_files_are_left_unread() {
        let root = std::env::temp_dir().join(format!("xtask-tree-{}", std::process::id()));
        fs::create_dir_all(root.join("src")).unwrap();
        fs::create_dir_all(root.join("target")).unwrap();
        fs::write(root.join(".gitignore"), "/target\n").unwrap();
        fs::write(root.join("src/a.rs"), "fn a() {}\n").unwrap();
        fs::write(root.join("src/picture.png"), [0x89, 0xff]).unwrap();
        fs::write(root.join("target/made.rs"), "").unwrap();
        let tree = Tree::load(&root).unwrap();
        fs::remove_dir_all(&root).unwrap();

        assert_eq!(tree.text("src/a.rs"), Some("fn a() {}\n"));
        assert!(tree.contains("src/picture.png") && tree.contains(".gitignore"));
        assert_eq!(tree.text("src/picture.png"), None);
        assert!(!tree.contains("target"));
    }
}
