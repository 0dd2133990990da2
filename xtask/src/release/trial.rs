//! `cargo xtask release --try`: the files of a release, installed and run in fresh Debian systems without Rust and Node.
//!
//! Each system is a folder that `chroot` enters, so this needs root, and `debootstrap`.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{fs, io};

use super::folders::{Folders, PLATFORM, VERSION};
use super::program::file_name;
use super::{step, wheels};
use crate::{package, process};

/// The release of Debian in the systems.
const DEBIAN: &str = "bookworm";

/// The version of Python in that release, which decides about the wheel of numpy.
const PYTHON: &str = "3.11";

/// Programs that no system may have.
const BUILDERS: [&str; 5] = ["cargo", "rustc", "node", "npm", "cc"];

/// Installs the wheel, the archive and the Debian package in a fresh system each, and runs them.
///
/// # Errors
/// If a file of this commit is missing, a system cannot be made, or a command fails in it.
pub(super) fn run(folders: &Folders) -> io::Result<()> {
    let trials: [(&str, Trial, &[&str]); 3] = [
        ("command", archive, &[]),
        ("debian", debian, &[]),
        ("wheels", python, &["python3", "python3-venv"]),
    ];
    step::all(trials.into_iter().map(|(step, trial, packages)| {
        folders.require(step)?;
        let name = if packages.is_empty() { "plain" } else { "python" };
        trial(folders, &Root::new(folders, name, packages)?)
    }))
}

/// Installs and runs the files of a step in a fresh system.
type Trial = fn(&Folders, &Root) -> io::Result<()>;

/// The wheel, installed by pip without a network, with the Python section of the README and the studio.
fn python(folders: &Folders, root: &Root) -> io::Result<()> {
    root.lacks(&BUILDERS)?;
    let wheel = wheels::wheel(&folders.results("wheels"), "manylinux_2_17_x86_64")?;
    let packages = root.add(&wheel, "packages")?;
    let mut fetch = Command::new(crate::python::find().unwrap_or("python3"));
    fetch.args(["-m", "pip", "download", "--quiet", "--only-binary", ":all:"]);
    fetch.args(["--python-version", PYTHON, "--platform", "manylinux2014_x86_64", "--dest"]);
    process::succeed(fetch.arg(packages).arg("numpy"))?;
    root.succeed("python3 -m venv /opt/jointplay")?;
    let mut pip = Command::new("unshare");
    pip.args(["--net", "chroot"]).arg(&root.0).arg("/opt/jointplay/bin/pip");
    pip.args(["install", "--quiet", "--no-index", "--find-links", "/packages", "jointplay"]);
    process::succeed(&mut pip)?;
    let readme = fs::read_to_string(folders.root.join("README.md"))?;
    let program = readme.split("```python\n").nth(1).and_then(|rest| rest.split("```").next());
    let program = program.ok_or_else(|| io::Error::other("README.md has no Python section"))?;
    fs::write(root.0.join("readme.py"), format!("{program}\nprint(poses.origin_m)\n"))?;
    root.succeed("/opt/jointplay/bin/python /readme.py")?;
    package::exercise(|| root.user("/opt/jointplay/bin/jointplay"))?;
    println!("release: {}: installed and run without Rust and Node", file_name(&wheel));
    Ok(())
}

/// The unpacked archive of the command, with the studies of the paper.
fn archive(folders: &Folders, root: &Root) -> io::Result<()> {
    root.lacks(&[&BUILDERS[..], &["python3"]].concat())?;
    let name = format!("jointplay-{VERSION}-{PLATFORM}");
    let archive = folders.results("command").join(format!("{name}.tar.gz"));
    root.add(&archive, "packages")?;
    root.succeed(&format!("tar xzf /packages/{name}.tar.gz -C /opt"))?;
    let command = format!("/opt/{name}/bin/jointplay");
    let mut studies = root.user(&command);
    studies.args(["simulate", "--quiet", "--out", "/tmp/paper"]).stdout(Stdio::null());
    process::succeed(&mut studies)?;
    package::exercise(|| root.user(&command))?;
    println!("release: {}: run without Rust, Node and Python", file_name(&archive));
    Ok(())
}

/// The Debian package, installed by dpkg, run, and removed without a rest.
fn debian(folders: &Folders, root: &Root) -> io::Result<()> {
    let name = format!("jointplay_{VERSION}_amd64.deb");
    root.add(&folders.results("debian").join(&name), "packages")?;
    root.succeed(&format!("dpkg --install /packages/{name}"))?;
    package::exercise(|| root.user("jointplay"))?;
    let listed = process::output(&mut root.shell("dpkg --listfiles jointplay"))?;
    let files: Vec<&str> = listed.lines().filter(|line| line.contains("jointplay")).collect();
    let is_there = |file: &&&str| root.0.join(file.trim_start_matches('/')).exists();
    if !files.iter().any(|file| is_there(&file) && file.ends_with("jointplay.1.gz")) {
        return Err(io::Error::other(format!("{name} has no manual")));
    }
    root.succeed("dpkg --remove jointplay")?;
    if let Some(rest) = files.iter().find(is_there) {
        return Err(io::Error::other(format!("{rest} is there after {name} was removed")));
    }
    println!("release: {name}: installed, run and removed by dpkg");
    Ok(())
}

/// A fresh Debian system in a folder.
struct Root(PathBuf);

impl Root {
    /// A copy of a system with these packages, which is made once.
    fn new(folders: &Folders, name: &str, packages: &[&str]) -> io::Result<Self> {
        let base = process::target(&folders.root).join("clean-roots").join(name);
        if !base.exists() {
            println!("release: debootstrap makes a Debian system for this trial");
            let unfinished = base.with_extension("unfinished");
            if unfinished.exists() {
                fs::remove_dir_all(&unfinished)?;
            }
            fs::create_dir_all(&unfinished)?;
            let mut make = Command::new("debootstrap");
            make.arg("--variant=minbase");
            if !packages.is_empty() {
                make.arg(format!("--include={}", packages.join(",")));
            }
            process::succeed(make.arg(DEBIAN).arg(&unfinished).stdout(Stdio::null()))?;
            fs::rename(unfinished, &base)?;
        }
        let root = folders.work.join(format!("root-{name}"));
        if root.exists() {
            fs::remove_dir_all(&root)?;
        }
        process::succeed(Command::new("cp").arg("-a").arg(&base).arg(&root))?;
        Ok(Self(root))
    }

    /// Copies a file into a folder of the system, and returns that folder as seen from outside.
    fn add(&self, file: &Path, folder: &str) -> io::Result<PathBuf> {
        let folder = self.0.join(folder);
        fs::create_dir_all(&folder)?;
        let copy = folder.join(file_name(file));
        fs::copy(file, copy).map_err(|error| {
            let step = "run `cargo xtask release --dry-run` first";
            io::Error::other(format!("{}: {error}; {step}", file.display()))
        })?;
        Ok(folder)
    }

    /// A command line in the system, as its administrator.
    fn shell(&self, line: &str) -> Command {
        let mut command = Command::new("chroot");
        command.arg(&self.0).args(["/bin/sh", "-c", line]).env("HOME", "/root");
        command
    }

    fn succeed(&self, line: &str) -> io::Result<()> {
        process::succeed(self.shell(line).stdout(Stdio::null()))
    }

    /// A program in the system, started by an ordinary user.
    fn user(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new("chroot");
        command.arg("--userspec=65534:65534").arg(&self.0).arg(program).env("HOME", "/tmp");
        command
    }

    /// Refuses a system that has one of these programs.
    fn lacks(&self, programs: &[&str]) -> io::Result<()> {
        for program in programs {
            let mut look = self.shell(&format!("command -v {program}"));
            if look.stdout(Stdio::null()).status()?.success() {
                return Err(io::Error::other(format!("the system of the trial has {program}")));
            }
        }
        Ok(())
    }
}
