//! The source of the commit with that of all libraries: it builds without a network.

use std::fs::{self, OpenOptions};
use std::io::{self, Write as _};
use std::path::Path;
use std::process::Command;

use super::folders::{Folders, VERSION};
use crate::process;

/// Packs the committed files and the libraries that `Cargo.lock` names, after a trial without a network.
pub(super) fn build(folders: &Folders) -> io::Result<()> {
    let name = format!("jointplay-{VERSION}-vendored");
    let folder = folders.empty(&name)?;
    let committed = folders.work.join("committed.tar");
    let mut archive = Command::new("git");
    archive.args(["archive", "--output"]).arg(&committed).arg("HEAD").current_dir(&folders.root);
    process::succeed(&mut archive)?;
    process::succeed(Command::new("tar").arg("xf").arg(&committed).arg("-C").arg(&folder))?;
    let mut vendor = process::cargo();
    // Not `--quiet`: with it, cargo does not print the settings.
    vendor.args(["vendor", "--locked"]).current_dir(&folder);
    let settings = process::output_without_progress(&mut vendor)?;
    let configuration = folder.join(".cargo").join("config.toml");
    write!(OpenOptions::new().append(true).open(configuration)?, "\n{settings}")?;
    try_out(folders, &folder)?;
    // Two threads at least: with one, the same files give other bytes.
    folders.pack(&name, "tar.xz", "xz -T2 -6")
}

/// Builds a crate with libraries, where cargo has no downloads.
fn try_out(folders: &Folders, folder: &Path) -> io::Result<()> {
    let home = folders.empty("cargo-home")?;
    let built = folders.work.join("vendored-build");
    let mut check = process::cargo();
    check.args(["check", "--quiet", "--locked", "--offline", "-p", "jointplay-core"]);
    check.env("CARGO_HOME", &home).env("CARGO_TARGET_DIR", &built).current_dir(folder);
    process::succeed(&mut check)?;
    fs::remove_dir_all(built)
}
