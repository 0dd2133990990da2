//! The Debian package of the command.

use std::path::Path;
use std::process::Command;
use std::{fs, io};

use super::folders::{Folders, VERSION};
use crate::{package, process};

/// Builds the package from the files of the archive of the command, unpacks it, and tries it out.
pub(super) fn build(folders: &Folders) -> io::Result<()> {
    let program = folders.program();
    let root = folders.empty("debian")?;
    let (usr, documents) = (root.join("usr"), root.join("usr/share/doc/jointplay"));
    fs::create_dir_all(&documents)?;
    fs::create_dir_all(root.join("DEBIAN"))?;
    process::succeed(
        Command::new("cp").arg("-r").arg(program.join("bin")).arg(program.join("share")).arg(&usr),
    )?;
    let vendor = usr.join("share/zsh/site-functions");
    if vendor.exists() {
        // Where the zsh of Debian looks.
        fs::rename(vendor, usr.join("share/zsh/vendor-completions"))?;
    }
    for page in usr.join("share/man/man1").read_dir()? {
        process::succeed(Command::new("gzip").args(["-n", "-9"]).arg(page?.path()))?;
    }
    copyright(folders, &documents)?;
    let changes = documents.join("changelog");
    fs::copy(program.join("CHANGELOG.md"), &changes)?;
    process::succeed(Command::new("gzip").args(["-n", "-9"]).arg(&changes))?;
    let size = process::output(Command::new("du").args(["-sk", "--apparent-size"]).arg(&usr))?;
    let size = size.split_whitespace().next().unwrap_or_default();
    fs::write(root.join("DEBIAN/control"), control(size))?;
    let package = folders.out.join(format!("jointplay_{VERSION}_amd64.deb"));
    let mut build = Command::new("dpkg-deb");
    build.args(["--build", "--root-owner-group", "-Zxz"]).arg(&root).arg(&package);
    process::succeed(build.env("SOURCE_DATE_EPOCH", &folders.time))?;
    let unpacked = folders.empty("debian-unpacked")?;
    process::succeed(Command::new("dpkg-deb").arg("--extract").arg(&package).arg(&unpacked))?;
    package::exercise(&unpacked.join("usr/bin/jointplay"))
}

/// Licences of the package and of the libraries in it.
fn copyright(folders: &Folders, documents: &Path) -> io::Result<()> {
    let mut text = "\
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: jointplay
Source: https://github.com/jointplay/jointplay

Files: *
Copyright: the jointplay developers
License: MIT or Apache-2.0
"
    .to_owned();
    for file in ["LICENSE-MIT", "LICENSE-APACHE"] {
        text += &format!("\n{}", fs::read_to_string(folders.root.join(file))?);
    }
    fs::write(documents.join("copyright"), text)?;
    fs::copy(folders.notices(), documents.join("THIRD-PARTY.txt")).map(|_| ())
}

/// The description of the package; `size` is that of its files (KiB).
fn control(size: &str) -> String {
    format!(
        "\
Package: jointplay
Version: {VERSION}
Architecture: amd64
Maintainer: The jointplay developers <jointplay@users.noreply.github.com>
Installed-Size: {size}
Section: science
Priority: optional
Homepage: https://github.com/jointplay/jointplay
Description: model, analyse and simulate overconstrained robots
 Some motions of overconstrained robots need play in the joints. jointplay
 represents it by virtual joints and computes mobility, sensitivity,
 kinematics and motion. It also plans and checks programs of wafer robots,
 and has a 3D page for the browser.
"
    )
}
