//! The command for Linux: one file that needs no library of the system, in an archive with manuals and completions.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{fs, io};

use super::folders::{Folders, PLATFORM, VERSION};
use crate::{package, process};

/// Completion scripts: the shell, and where it looks for them below `share`.
const COMPLETIONS: [(&str, &str); 3] = [
    ("bash", "bash-completion/completions/jointplay"),
    ("zsh", "zsh/site-functions/_jointplay"),
    ("fish", "fish/vendor_completions.d/jointplay.fish"),
];

/// Texts of the repository in the archive.
const TEXTS: [&str; 5] =
    ["README.md", "CHANGELOG.md", "CITATION.cff", "LICENSE-MIT", "LICENSE-APACHE"];

/// Builds the command, tries it out, and packs it.
pub(super) fn build(folders: &Folders) -> io::Result<()> {
    let built = compile(folders)?;
    let folder = folders.empty(&file_name(&folders.program()))?;
    let command = folder.join("bin").join("jointplay");
    fs::create_dir_all(folder.join("bin"))?;
    fs::copy(&built, &command)?;
    is_static(&command)?;
    package::exercise(|| Command::new(&command))?;
    manuals(&command, &folder.join("share"))?;
    for text in TEXTS {
        fs::copy(folders.root.join(text), folder.join(text))?;
    }
    fs::copy(folders.notices(), folder.join("THIRD-PARTY.txt"))?;
    fs::copy(folders.component_list(), folder.join(file_name(&folders.component_list())))?;
    println!("release: jointplay {VERSION}, {} bytes", fs::metadata(&command)?.len());
    folders.pack(&file_name(&folder), "tar.gz", "gzip -n -9")
}

/// The command, optimised; its C library is part of it.
fn compile(folders: &Folders) -> io::Result<PathBuf> {
    let mut build = process::cargo();
    build.args(["build", "--locked", "--profile", "dist", "-p", "jointplay-cli"]);
    build.args(["--features", "parquet,mcap", "--target", PLATFORM]).current_dir(&folders.root);
    let built = process::target(&folders.root);
    let others = [(built.clone(), "/jointplay/target")];
    process::succeed(folders.reproducible(
        &mut build,
        &["-C", "target-feature=+crt-static"],
        &others,
    ))?;
    Ok(built.join(PLATFORM).join("dist").join("jointplay"))
}

/// Refuses a program that needs an interpreter or libraries of the system.
fn is_static(command: &Path) -> io::Result<()> {
    let headers = process::output(
        Command::new("readelf").args(["--program-headers", "--dynamic"]).arg(command),
    )?;
    let needs = headers.lines().find(|line| line.contains("INTERP") || line.contains("(NEEDED)"));
    needs.map_or(Ok(()), |line| Err(io::Error::other(format!("the command is not static: {line}"))))
}

/// Writes manuals and completions of `command` below the folder `share`.
fn manuals(command: &Path, share: &Path) -> io::Result<()> {
    let pages = share.join("man").join("man1");
    fs::create_dir_all(&pages)?;
    process::succeed(
        Command::new(command)
            .args(["manual", "--force", "--out"])
            .arg(&pages)
            .stdout(Stdio::null()),
    )?;
    for (shell, path) in COMPLETIONS {
        let script = process::output(Command::new(command).args(["completions", shell]))?;
        let path = share.join(path);
        fs::create_dir_all(path.parent().unwrap_or(share))?;
        fs::write(path, script)?;
    }
    Ok(())
}

pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
