//! The container image: the static command alone, for an ordinary user and a read-only root.
//!
//! Where no builder of images is installed, the same files are run in an empty root without one.

use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, Stdio};
use std::{fs, io};

use super::folders::{Folders, VERSION};
use crate::process;

/// Programs that build images, in order of preference.
const BUILDERS: [&str; 3] = ["podman", "buildah", "docker"];

/// Builds the image, or runs the command as it would be in one.
pub(super) fn build(folders: &Folders) -> io::Result<()> {
    let context = folders.empty("container")?;
    let program = folders.program();
    fs::copy(program.join("bin/jointplay"), context.join("jointplay"))?;
    for name in ["LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.txt"] {
        fs::copy(program.join(name), context.join(name))?;
    }
    fs::copy(folders.root.join("Containerfile"), context.join("Containerfile"))?;
    let works = |builder: &&&str| {
        let mut info = Command::new(builder);
        info.arg("info").stdout(Stdio::null()).stderr(Stdio::null());
        info.status().is_ok_and(|status| status.success())
    };
    let Some(builder) = BUILDERS.iter().find(works) else {
        println!("release: no builder of images works here; the command is run in an empty root");
        return in_empty_root(folders);
    };
    let image = format!("jointplay:{VERSION}");
    let archive = folders.out.join(format!("jointplay-{VERSION}-image.tar"));
    for arguments in image_commands(builder, &image, &context, &archive) {
        process::succeed(Command::new(builder).args(arguments))?;
    }
    Ok(())
}

/// Commands of a builder that make the image and write it as an archive of Docker, whose format has the health check.
fn image_commands(
    builder: &str,
    image: &str,
    context: &Path,
    archive: &Path,
) -> [Vec<OsString>; 2] {
    let words = |words: &[&str]| words.iter().map(OsString::from).collect::<Vec<_>>();
    let mut build = words(&["build", "--tag", image]);
    // Images of the format OCI have no health check; docker has its own format only.
    if builder != "docker" {
        build.extend(words(&["--format", "docker"]));
    }
    build.extend([OsString::from("--file"), context.join("Containerfile").into()]);
    build.push(context.into());
    let write = if builder == "buildah" {
        let mut target = OsString::from("docker-archive:");
        target.push(archive);
        target.push(format!(":{image}"));
        [words(&["push", image]), vec![target]].concat()
    } else {
        [words(&["save", "--output"]), vec![archive.into()], words(&[image])].concat()
    };
    [build, write]
}

/// Runs the command with nothing else in its root, as an ordinary user who cannot write there.
fn in_empty_root(folders: &Folders) -> io::Result<()> {
    let root = folders.empty("empty-root")?;
    fs::copy(folders.program().join("bin/jointplay"), root.join("jointplay"))?;
    for line in ["--version", "mobility hexapod", "cell check"] {
        let mut run = Command::new("chroot");
        run.args(["--userspec=65532:65532"]).arg(&root).arg("/jointplay").args(line.split(' '));
        process::succeed(run.stdout(Stdio::null()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_builder_makes_an_archive_of_docker_with_the_health_check() {
        for (builder, built, written) in [
            ("docker", "build --tag j:1 --file c/Containerfile c", "save --output a.tar j:1"),
            (
                "podman",
                "build --tag j:1 --format docker --file c/Containerfile c",
                "save --output a.tar j:1",
            ),
            (
                "buildah",
                "build --tag j:1 --format docker --file c/Containerfile c",
                "push j:1 docker-archive:a.tar:j:1",
            ),
        ] {
            let found = image_commands(builder, "j:1", Path::new("c"), Path::new("a.tar"));
            let line = |words: &Vec<OsString>| {
                words.iter().map(|word| word.to_str().unwrap()).collect::<Vec<_>>().join(" ")
            };
            assert_eq!(found.each_ref().map(line), [built, written], "{builder}");
        }
    }
}
