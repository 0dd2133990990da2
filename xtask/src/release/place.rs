//! Where a release is made, and the circumstances that decide its bytes.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs, io};

use crate::process;

/// The version that is released.
pub(super) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The platform of the binaries.
pub(super) const PLATFORM: &str = "x86_64-unknown-linux-gnu";

/// Folders and time of a release.
pub(super) struct Place {
    /// The top folder of the repository.
    pub(super) root: PathBuf,
    /// What would be uploaded.
    pub(super) out: PathBuf,
    /// Intermediate files.
    pub(super) work: PathBuf,
    /// The time of the last commit, in seconds since 1970: that of all files in archives.
    pub(super) time: String,
}

impl Place {
    /// The place below `target` of the workspace at `root`.
    ///
    /// # Errors
    /// If git does not know the time, or a folder cannot be made.
    pub(super) fn new(root: &Path) -> io::Result<Self> {
        let mut git = Command::new("git");
        let time = process::output(git.args(["log", "-1", "--format=%ct"]).current_dir(root))?;
        let target = process::target(root);
        let place = Self {
            root: root.to_owned(),
            out: target.join("release-files"),
            work: target.join("release-work"),
            time: time.trim().to_owned(),
        };
        fs::create_dir_all(&place.out)?;
        fs::create_dir_all(&place.work)?;
        Ok(place)
    }

    /// Licences and notices of others, as one text.
    pub(super) fn notices(&self) -> PathBuf {
        self.out.join("THIRD-PARTY.txt")
    }

    /// The list of libraries in the binaries.
    pub(super) fn bill(&self) -> PathBuf {
        self.out.join(format!("jointplay-{VERSION}.cdx.json"))
    }

    /// The folder that the archive of the command holds.
    pub(super) fn program(&self) -> PathBuf {
        self.work.join(format!("jointplay-{VERSION}-{PLATFORM}"))
    }

    /// Copies a file to those that would be uploaded.
    pub(super) fn keep(&self, file: &Path) -> io::Result<()> {
        let name = file.file_name().ok_or_else(|| io::Error::other("a file without name"))?;
        fs::copy(file, self.out.join(name)).map(|_| ())
    }

    /// An empty folder for intermediate files.
    pub(super) fn empty(&self, name: &str) -> io::Result<PathBuf> {
        let folder = self.work.join(name);
        if folder.exists() {
            fs::remove_dir_all(&folder)?;
        }
        fs::create_dir_all(&folder)?;
        Ok(folder)
    }

    /// Packs a folder among the intermediate files for upload, so that the same files give the same bytes.
    pub(super) fn pack(&self, name: &str, end: &str, compressor: &str) -> io::Result<()> {
        let mut tar = Command::new("tar");
        tar.args(["--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--mode=go-w,a+rX"]);
        tar.arg(format!("--mtime=@{}", self.time)).args(["--use-compress-program", compressor]);
        tar.arg("-cf").arg(self.out.join(format!("{name}.{end}"))).arg("-C").arg(&self.work);
        process::succeed(tar.arg(name))
    }

    /// Makes the binaries of a build independent of folders and time.
    pub(super) fn reproducible<'a>(&self, build: &'a mut Command, flags: &str) -> &'a mut Command {
        let libraries = env::var_os("CARGO_HOME")
            .map(PathBuf::from)
            .or_else(|| env::var_os("HOME").map(|home| PathBuf::from(home).join(".cargo")));
        let libraries = libraries.unwrap_or_default();
        let paths = [(self.root.as_path(), "/jointplay"), (libraries.as_path(), "/cargo")];
        let mapped =
            paths.map(|(path, name)| format!("--remap-path-prefix={}={name}", path.display()));
        let flags = format!("{flags} {}", mapped.join(" "));
        build.env("RUSTFLAGS", flags.trim()).env("SOURCE_DATE_EPOCH", &self.time)
    }
}
