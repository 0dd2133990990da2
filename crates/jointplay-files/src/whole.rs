//! Files that are written whole: under a temporary name, and renamed when they are complete.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// Prefix of temporary names; a file with this prefix was left by a killed run.
pub const PARTIAL_PREFIX: &str = ".jointplay-partial-";

/// The future contents of a file, under a temporary name in the folder of that file.
///
/// Contents that are dropped before they get their final name are removed.
#[derive(Debug)]
pub struct NewFile {
    /// Path of the file, with symbolic links resolved.
    target: PathBuf,
    file: NamedTempFile,
    is_synced: bool,
}

impl NewFile {
    /// Starts the future contents of the file at `path`.
    ///
    /// Where `path` is a symbolic link, the file that it leads to is replaced, and the link stays.
    /// A file that is replaced keeps its permissions; a new file has those that the system gives to new files.
    ///
    /// # Errors
    /// The reason of the system, and a folder or a device at `path`.
    pub fn begin(path: &Path) -> io::Result<Self> {
        let replaced = match path.metadata() {
            Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(found) if !found.is_file() => {
                return Err(io::Error::other("a device or a pipe has this name"));
            }
            Ok(found) => Some(found.permissions()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        let mut target = path.to_owned();
        while let Ok(link) = target.read_link() {
            target = folder_of(&target).join(link);
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(PARTIAL_PREFIX);
        #[cfg(unix)]
        builder.permissions(initial_permissions(replaced.as_ref()));
        // The temporary name in the error would be of no use to the user.
        let file = builder.tempfile_in(folder_of(&target));
        let file = file.map_err(|error| io::Error::from(error.kind()))?;
        if cfg!(unix)
            && let Some(replaced) = replaced
        {
            // A file system without permissions returns an error; the initial ones are no wider.
            drop(file.as_file().set_permissions(replaced));
        }
        Ok(Self { target, file, is_synced: false })
    }

    /// Path of the contents until they get their final name.
    #[must_use]
    pub fn temporary_path(&self) -> &Path {
        self.file.path()
    }

    /// Length of the contents, in bytes.
    ///
    /// # Errors
    /// The reason of the system.
    pub fn length(&self) -> io::Result<u64> {
        Ok(self.file.as_file().metadata()?.len())
    }

    /// Waits until the disk has the contents, so that the file is complete even after a power cut.
    ///
    /// # Errors
    /// The reason of the system.
    pub fn sync(&mut self) -> io::Result<()> {
        self.file.as_file().sync_all()?;
        self.is_synced = true;
        Ok(())
    }

    /// Gives the contents their final name; a file of this name is replaced.
    ///
    /// # Errors
    /// The reason of the system; a file of this name is unchanged then.
    pub fn replace(self) -> io::Result<()> {
        let Self { target, file, is_synced } = self;
        file.persist(&target).map_err(|error| error.error)?;
        if is_synced {
            sync_folder(&target);
        }
        Ok(())
    }

    /// Gives the contents their final name, unless a file has this name.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`] for a file of this name, else the reason of the system.
    pub fn create(self) -> io::Result<()> {
        let Self { target, file, is_synced } = self;
        file.persist_noclobber(&target).map_err(|error| error.error)?;
        if is_synced {
            sync_folder(&target);
        }
        Ok(())
    }

    /// The present contents of the file that is to be replaced, under another temporary name; `None` without such a file.
    fn previous(&self) -> io::Result<Option<Self>> {
        let mut present = match File::open(&self.target) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error),
        };
        let mut previous = Self::begin(&self.target)?;
        io::copy(&mut present, &mut previous)?;
        if self.is_synced {
            previous.sync()?;
        }
        Ok(Some(previous))
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.as_file_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.as_file_mut().flush()
    }
}

/// Replaces a file by complete contents, which the disk has afterwards; a failure changes nothing.
///
/// # Errors
/// See [`NewFile::begin`] and [`NewFile::replace`].
pub fn write_durable(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = NewFile::begin(path)?;
    file.write_all(bytes)?;
    file.sync()?;
    file.replace()
}

/// Replaces two files; where the second cannot be replaced, the first gets its previous contents back.
///
/// # Errors
/// The path of the file that cannot be replaced, with the reason of the system.
pub fn replace_both(first: NewFile, second: NewFile) -> Result<(), (PathBuf, io::Error)> {
    let (first_path, second_path) = (first.target.clone(), second.target.clone());
    // Copied before anything is replaced: a full disk cannot prevent the restoration.
    let previous = first.previous().map_err(|error| (first_path.clone(), error))?;
    first.replace().map_err(|error| (first_path.clone(), error))?;
    second.replace().map_err(|error| {
        let restored = match previous {
            Some(previous) => previous.replace(),
            None => std::fs::remove_file(&first_path),
        };
        match restored {
            Ok(()) => (second_path, error),
            Err(error) => (first_path, error),
        }
    })
}

/// Makes the renaming of a file durable across a power cut, on systems that can sync folders.
pub fn sync_folder(path: &Path) {
    if let Ok(folder) = File::open(folder_of(path)) {
        // Systems that cannot sync folders return an error; the file is complete all the same.
        drop(folder.sync_all());
    }
}

/// The folder of a file; the current one for a bare name.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Permissions of temporary files, which the system restricts by its mask: those of the file to be replaced, else those of new files.
#[cfg(unix)]
fn initial_permissions(replaced: Option<&std::fs::Permissions>) -> std::fs::Permissions {
    use std::os::unix::fs::PermissionsExt as _;
    /// Permissions among the bits of a mode.
    const PERMISSIONS: u32 = 0o777;
    /// Permissions that programs ask for where files are not private.
    const NEW: u32 = 0o666;
    let mode = replaced.map_or(NEW, |replaced| replaced.mode() & PERMISSIONS);
    std::fs::Permissions::from_mode(mode)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }

    fn begun(path: &Path, text: &str) -> NewFile {
        let mut file = NewFile::begin(path).unwrap();
        file.write_all(text.as_bytes()).unwrap();
        file
    }

    #[test]
    fn a_file_is_replaced_whole_or_not_at_all_and_no_other_file_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        write_durable(&path, b"first").unwrap();
        let second = begun(&path, "second");
        assert_eq!(std::fs::read(&path).unwrap(), b"first");
        assert_eq!(second.length().unwrap(), 6);
        assert!(second.temporary_path().starts_with(folder.path()));
        drop(second);
        assert_eq!(names(folder.path()), ["a.toml"]);
        assert_eq!(std::fs::read(&path).unwrap(), b"first");
        begun(&path, "second").replace().unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"second");
        assert_eq!(names(folder.path()), ["a.toml"]);
    }

    #[test]
    fn a_file_or_a_folder_of_the_same_name_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        let new = begun(&path, "new");
        std::fs::write(&path, "by another program").unwrap();
        assert_eq!(new.create().unwrap_err().kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(std::fs::read(&path).unwrap(), b"by another program");
        let below = folder.path().join("folder");
        let new = begun(&below, "new");
        std::fs::create_dir(&below).unwrap();
        assert!(new.replace().is_err());
        assert_eq!(NewFile::begin(&below).unwrap_err().kind(), io::ErrorKind::IsADirectory);
        assert!(NewFile::begin(&folder.path().join("missing/a.toml")).is_err());
        assert_eq!(names(folder.path()), ["a.toml", "folder"]);
    }

    #[test]
    fn of_two_files_neither_is_replaced_if_the_second_cannot_be() {
        for existed in [true, false] {
            let folder = tempfile::tempdir().unwrap();
            let (a, b) = (folder.path().join("a"), folder.path().join("b"));
            if existed {
                std::fs::write(&a, "previous").unwrap();
            }
            let (first, second) = (begun(&a, "new"), begun(&b, "new"));
            std::fs::create_dir(&b).unwrap();
            let (path, _) = replace_both(first, second).unwrap_err();
            assert_eq!(path, b);
            assert_eq!(std::fs::read(&a).ok(), existed.then(|| b"previous".to_vec()));
            assert_eq!(names(folder.path()), if existed { &["a", "b"][..] } else { &["b"] });
            std::fs::remove_dir(&b).unwrap();
            replace_both(begun(&a, "new"), begun(&b, "new")).unwrap();
            assert_eq!(
                (std::fs::read(&a).unwrap(), std::fs::read(&b).unwrap()),
                (b"new".to_vec(), b"new".to_vec())
            );
            assert_eq!(names(folder.path()), ["a", "b"]);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_replaced_file_keeps_its_permissions_and_a_new_one_has_the_usual_ones() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let mode =
            |name: &str| folder.path().join(name).metadata().unwrap().permissions().mode() & 0o777;
        std::fs::write(folder.path().join("usual"), "").unwrap();
        write_durable(&folder.path().join("new"), b"").unwrap();
        assert_eq!(mode("new"), mode("usual"));
        for kept in [0o600, 0o640, 0o666, 0o755] {
            let path = folder.path().join("new");
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(kept)).unwrap();
            write_durable(&path, b"again").unwrap();
            assert_eq!(mode("new"), kept);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_symbolic_link_stays_and_its_target_is_replaced() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("below")).unwrap();
        std::fs::write(at("below/real"), "previous").unwrap();
        symlink("below/real", at("link")).unwrap();
        symlink("link", at("chain")).unwrap();
        symlink("below/future", at("dangling")).unwrap();
        write_durable(&at("chain"), b"new").unwrap();
        write_durable(&at("dangling"), b"new").unwrap();
        for link in ["link", "chain", "dangling"] {
            assert!(at(link).symlink_metadata().unwrap().is_symlink(), "{link}");
            assert_eq!(std::fs::read(at(link)).unwrap(), b"new", "{link}");
        }
        assert_eq!(names(&at("below")), ["future", "real"]);
        assert_eq!(names(folder.path()), ["below", "chain", "dangling", "link"]);
        symlink("circle", at("circle")).unwrap();
        assert!(NewFile::begin(&at("circle")).is_err());
    }
}
