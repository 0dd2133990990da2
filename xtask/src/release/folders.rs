//! Folders of a release, and the circumstances that decide its bytes.

use std::ffi::{OsStr, OsString};
use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs, io};

use crate::process;

/// The version that is released.
pub(super) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The platform of the binaries.
pub(super) const PLATFORM: &str = "x86_64-unknown-linux-gnu";

/// Name of the file that a finished step leaves in the folder of its results: the commit they are made of.
const COMMIT: &str = ".commit";

/// Name of the file in the folder of results that lists what this machine could not make.
const ABSENT: &str = ".absent";

/// Folders, commit and time of a release.
#[derive(Clone)]
pub(super) struct Folders {
    /// The top folder of the repository.
    pub(super) root: PathBuf,
    /// Files for upload.
    pub(super) out: PathBuf,
    /// Intermediate files.
    pub(super) work: PathBuf,
    /// The last commit.
    pub(super) commit: String,
    /// The time of the last commit, in seconds since 1970: that of all files in archives.
    pub(super) time: String,
}

impl Folders {
    /// The folders below `target` of the workspace at `root`.
    ///
    /// # Errors
    /// If git does not know the commit, or files differ from it.
    pub(super) fn new(root: &Path) -> io::Result<Self> {
        let git = |words: &[&str]| {
            let output = process::output(Command::new("git").args(words).current_dir(root))?;
            Ok::<_, io::Error>(output.trim().to_owned())
        };
        let changes = git(&["status", "--porcelain"])?;
        if !changes.is_empty() {
            let message = format!(
                "a release is made of a commit, but these files differ from the last one; commit or remove them:\n{changes}"
            );
            return Err(io::Error::other(message));
        }
        let target = process::target(root);
        Ok(Self {
            root: root.to_owned(),
            out: target.join("release-files"),
            work: target.join("release-work"),
            commit: git(&["rev-parse", "HEAD"])?,
            time: git(&["log", "-1", "--format=%ct"])?,
        })
    }

    /// The folder with the results of a step.
    pub(super) fn results(&self, step: &str) -> PathBuf {
        self.work.join("results").join(step)
    }

    /// Runs a step into an empty folder of its results; only those of finished steps are for upload.
    pub(super) fn run(
        &self,
        step: &str,
        action: impl FnOnce(&Self) -> io::Result<()>,
    ) -> io::Result<()> {
        let out = self.results(step);
        if out.exists() {
            fs::remove_dir_all(&out)?;
        }
        fs::create_dir_all(&out)?;
        action(&Self { out: out.clone(), ..self.clone() })?;
        fs::write(out.join(COMMIT), &self.commit)
    }

    /// Whether a step finished for this commit.
    pub(super) fn is_finished(&self, step: &str) -> bool {
        let commit = fs::read_to_string(self.results(step).join(COMMIT));
        commit.is_ok_and(|commit| commit == self.commit)
    }

    /// Refuses if a step did not finish for this commit.
    pub(super) fn require(&self, step: &str) -> io::Result<()> {
        if self.is_finished(step) {
            return Ok(());
        }
        let message = format!(
            "the step {step} has no results of this commit; run `cargo xtask release --dry-run {step}` first"
        );
        Err(io::Error::other(message))
    }

    /// Prints and records what this step cannot make on this machine, with the reason.
    pub(super) fn report_absent(&self, what: &str) -> io::Result<()> {
        println!("release: {what}");
        let file = OpenOptions::new().create(true).append(true).open(self.out.join(ABSENT));
        writeln!(file?, "{what}")
    }

    /// What a finished step could not make on this machine.
    pub(super) fn absent(&self, step: &str) -> Vec<String> {
        let text = fs::read_to_string(self.results(step).join(ABSENT)).unwrap_or_default();
        text.lines().map(str::to_owned).collect()
    }

    /// The files of a step; none if it did not finish for this commit.
    pub(super) fn finished(&self, step: &str) -> io::Result<Vec<PathBuf>> {
        let folder = self.results(step);
        if !self.is_finished(step) {
            return Ok(Vec::new());
        }
        let files = folder.read_dir()?.map(|entry| Ok(entry?.path()));
        let mut files: Vec<PathBuf> = files.collect::<io::Result<_>>()?;
        files.retain(|file| file.file_name().is_some_and(|name| name != COMMIT && name != ABSENT));
        files.sort();
        Ok(files)
    }

    /// Licences and notices of third parties, as one text; a result of the step `notices`.
    pub(super) fn notices(&self) -> PathBuf {
        self.results("notices").join("THIRD-PARTY.txt")
    }

    /// The list of libraries in the binaries; a result of the step `notices`.
    pub(super) fn component_list(&self) -> PathBuf {
        self.results("notices").join(format!("jointplay-{VERSION}.cdx.json"))
    }

    /// The folder that the archive of the command holds.
    pub(super) fn program(&self) -> PathBuf {
        self.work.join(format!("jointplay-{VERSION}-{PLATFORM}"))
    }

    /// Copies a file to the results of the step.
    pub(super) fn add(&self, file: &Path) -> io::Result<()> {
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

    /// Makes the binaries of a build independent of folders and time; `others` are more folders with the names that replace them.
    pub(super) fn reproducible<'a>(
        &self,
        build: &'a mut Command,
        flags: &[&str],
        others: &[(PathBuf, &str)],
    ) -> &'a mut Command {
        let libraries = env::var_os("CARGO_HOME")
            .map(PathBuf::from)
            .or_else(|| env::var_os("HOME").map(|home| PathBuf::from(home).join(".cargo")));
        let mut paths =
            vec![(self.root.clone(), "/jointplay"), (libraries.unwrap_or_default(), "/cargo")];
        paths.extend_from_slice(others);
        build
            .env("CARGO_ENCODED_RUSTFLAGS", encoded(flags, &paths))
            .env("CARGO_INCREMENTAL", "0")
            .env("SOURCE_DATE_EPOCH", &self.time)
    }
}

/// Flags of the compiler with names in place of folders, as cargo separates them where folders may contain spaces.
pub(super) fn encoded(flags: &[&str], paths: &[(PathBuf, &str)]) -> OsString {
    let mut all: Vec<OsString> = flags.iter().map(OsString::from).collect();
    all.extend(paths.iter().map(|(path, name)| {
        let mut flag = OsString::from("--remap-path-prefix=");
        flag.push(path);
        flag.push(format!("={name}"));
        flag
    }));
    all.join(OsStr::new("\u{1f}"))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Empty folders of a test.
    pub(in crate::release) fn folders(name: &str) -> Folders {
        let root = std::env::temp_dir().join(format!("xtask-{name}-{}", std::process::id()));
        fs::create_dir_all(&root).unwrap();
        Folders {
            out: root.join("files"),
            work: root.join("work"),
            commit: "a".to_owned(),
            time: "0".to_owned(),
            root,
        }
    }

    #[test]
    fn only_results_of_finished_steps_of_this_commit_are_files_of_the_release() {
        let folders = folders("folders");
        let names = |folders: &Folders| {
            let files = folders.finished("step").unwrap();
            files.iter().map(|file| file.file_name().unwrap().to_owned()).collect::<Vec<_>>()
        };
        folders.run("step", |folders| fs::write(folders.out.join("old"), "1")).unwrap();
        assert_eq!(names(&folders), ["old"]);
        folders.run("step", |folders| fs::write(folders.out.join("new"), "2")).unwrap();
        assert_eq!(names(&folders), ["new"]);
        let half = |folders: &Folders| {
            fs::write(folders.out.join("half"), "3")?;
            Err(io::Error::other("stopped"))
        };
        folders.run("step", half).unwrap_err();
        assert!(names(&folders).is_empty(), "a step that failed");
        folders.run("step", |folders| fs::write(folders.out.join("new"), "4")).unwrap();
        let other = Folders { commit: "b".to_owned(), ..folders.clone() };
        assert!(names(&other).is_empty(), "another commit");
        assert_eq!(names(&folders), ["new"]);
        fs::remove_dir_all(&folders.root).unwrap();
    }

    #[test]
    fn folders_with_spaces_are_one_flag_of_the_compiler() {
        let found = encoded(&["-C", "a=b"], &[("/my folder".into(), "/jointplay")]);
        let flags: Vec<&str> = found.to_str().unwrap().split('\u{1f}').collect();
        assert_eq!(flags, ["-C", "a=b", "--remap-path-prefix=/my folder=/jointplay"]);
    }

    #[test]
    fn a_release_of_changed_files_is_refused() {
        let root = folders("changed").root;
        let git = |words: &[&str]| {
            let mut git = Command::new("git");
            git.args(["-c", "user.name=a", "-c", "user.email=a@b.c"]).args(words);
            process::output(git.current_dir(&root)).unwrap();
        };
        git(&["init", "--quiet"]);
        fs::write(root.join("a"), "1").unwrap();
        git(&["add", "a"]);
        git(&["commit", "--quiet", "--message", "A"]);
        let clean = Folders::new(&root).unwrap();
        assert_eq!(clean.commit.len(), 40);
        fs::write(root.join("b"), "2").unwrap();
        let refused = Folders::new(&root).err().unwrap().to_string();
        fs::remove_dir_all(&root).unwrap();
        assert!(refused.contains("commit or remove them") && refused.contains("?? b"), "{refused}");
    }
}
