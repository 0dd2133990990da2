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
    write_copyright(folders, &documents)?;
    let changes = documents.join("changelog");
    fs::copy(program.join("CHANGELOG.md"), &changes)?;
    process::succeed(Command::new("gzip").args(["-n", "-9"]).arg(&changes))?;
    fs::write(root.join("DEBIAN/control"), control(installed_size(&usr)?))?;
    // The same modes for every umask.
    process::succeed(Command::new("chmod").args(["-R", "u=rwX,go=rX"]).arg(&root))?;
    let package = folders.out.join(format!("jointplay_{VERSION}_amd64.deb"));
    let mut build = Command::new("dpkg-deb");
    build.args(["--build", "--root-owner-group", "-Zxz"]).arg(&root).arg(&package);
    process::succeed(build.env("SOURCE_DATE_EPOCH", &folders.time))?;
    let unpacked = folders.empty("debian-unpacked")?;
    process::succeed(Command::new("dpkg-deb").arg("--extract").arg(&package).arg(&unpacked))?;
    package::exercise(|| Command::new(unpacked.join("usr/bin/jointplay")))
}

/// Licences of the package and of the libraries in it.
fn write_copyright(folders: &Folders, documents: &Path) -> io::Result<()> {
    let mit = fs::read_to_string(folders.root.join("LICENSE-MIT"))?;
    fs::write(documents.join("copyright"), copyright(&mit))?;
    fs::copy(folders.notices(), documents.join("THIRD-PARTY.txt")).map(|_| ())
}

/// Copyright and licences in the format of Debian, with the text of the MIT licence; that of Apache is part of each Debian system.
fn copyright(mit: &str) -> String {
    // The title and the line of the copyright have their own fields.
    let text = mit
        .split_once("\n\nPermission")
        .map_or(mit.to_owned(), |(_, rest)| format!("Permission{rest}"));
    format!(
        "\
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: jointplay
Source: https://github.com/jointplay/jointplay
Comment:
 /usr/bin/jointplay contains third-party libraries and a font.
 THIRD-PARTY.txt in the folder of this file lists them with their licences.

Files: *
Copyright: The jointplay developers
License: Expat or Apache-2.0

License: Expat
{}

License: Apache-2.0
 Licensed under the Apache License, Version 2.0.
 On Debian systems, its complete text is in the file
 /usr/share/common-licenses/Apache-2.0.
",
        continued(&text)
    )
}

/// A text as the continuation of a field: indented by a blank, with a dot in empty lines.
fn continued(text: &str) -> String {
    let lines = text.trim().lines().map(|line| match line.trim_end() {
        "" => " .".to_owned(),
        line => format!(" {line}"),
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Size of the files in a folder as Debian counts it (KiB): files rounded up, one for each folder.
fn installed_size(folder: &Path) -> io::Result<u64> {
    let mut size = 1;
    for entry in folder.read_dir()? {
        let path = entry?.path();
        let data = fs::symlink_metadata(&path)?;
        size += if data.is_dir() { installed_size(&path)? } else { data.len().div_ceil(1024) };
    }
    Ok(size)
}

/// The description of the package; `size` is that of its files (KiB).
fn control(size: u64) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copyright_has_a_stanza_for_each_licence_it_names() {
        let mit = fs::read_to_string(crate::root::find().join("LICENSE-MIT")).unwrap();
        let text = copyright(&mit);
        let stanzas: Vec<&str> = text.split("\n\n").collect();
        let fields = |stanza: &str| -> Vec<String> {
            let lines = stanza.lines().filter(|line| !line.starts_with(' '));
            lines.map(|line| line.split_once(':').unwrap().0.to_owned()).collect()
        };
        let found: Vec<_> = stanzas.iter().map(|stanza| fields(stanza)).collect();
        let header = ["Format", "Upstream-Name", "Source", "Comment"];
        assert_eq!(found[0], header, "{text}");
        assert_eq!(found[1], ["Files", "Copyright", "License"], "{text}");
        assert_eq!(found[2..], [["License"], ["License"]], "{text}");
        assert!(stanzas[1].ends_with("License: Expat or Apache-2.0"), "{text}");
        assert!(stanzas[2].starts_with("License: Expat\n Permission is hereby"), "{text}");
        assert!(stanzas[2].contains("\n .\n"), "{text}");
    }
}
