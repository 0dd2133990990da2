//! The container image: the static command alone, for an ordinary user and a read-only root.
//!
//! Where no builder of images is installed, or only buildah, whose containers have a writable root, the same files are also run in an empty, read-only root.

use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, Stdio};
use std::{fs, io};

use super::folders::{Folders, VERSION};
use super::health;
use crate::{package, process};

/// Programs that build images, in order of preference.
const BUILDERS: [&str; 3] = ["podman", "buildah", "docker"];

/// Name of the container in which the image is tried.
const CONTAINER: &str = "jointplay-release";

/// Builds the image and runs it, or runs the command as it would be in one.
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
        folders.report_absent(&format!(
            "no container image: none of {} works here; the command was run in an empty root",
            BUILDERS.join(", ")
        ))?;
        return in_read_only_root(folders);
    };
    let image = format!("jointplay:{VERSION}");
    let archive = folders.out.join(format!("jointplay-{VERSION}-image.tar"));
    for arguments in image_commands(builder, &image, &context, &archive, &folders.time) {
        let mut step = Command::new(builder);
        process::succeed(step.args(arguments).env("SOURCE_DATE_EPOCH", &folders.time))?;
    }
    let containerfile = fs::read_to_string(context.join("Containerfile"))?;
    try_image(builder, &image, &archive, &containerfile)?;
    if *builder == "buildah" { in_read_only_root(folders) } else { Ok(()) }
}

/// Commands of a builder that make the image and write it as an archive of Docker, whose format has the health check.
fn image_commands(
    builder: &str,
    image: &str,
    context: &Path,
    archive: &Path,
    time: &str,
) -> [Vec<OsString>; 2] {
    let words = |words: &[&str]| words.iter().map(OsString::from).collect::<Vec<_>>();
    let mut build = words(&["build", "--tag", image]);
    // Images of the format OCI have no health check; docker has its own format only, and reads the time from its environment.
    if builder != "docker" {
        build.extend(words(&["--format", "docker", "--timestamp", time]));
    }
    build.extend([OsString::from("--file"), context.join("Containerfile").into()]);
    build.push(context.into());
    let write = if builder == "buildah" {
        let mut target = from_archive(archive);
        target.push(format!(":{image}"));
        [words(&["push", image]), vec![target]].concat()
    } else {
        [words(&["save", "--output"]), vec![archive.into()], words(&[image])].concat()
    };
    [build, write]
}

/// An image in an archive, as buildah names it.
fn from_archive(archive: &Path) -> OsString {
    let mut name = OsString::from("docker-archive:");
    name.push(archive);
    name
}

/// Runs the command of the image in a container, and its server until it is healthy: of podman and docker as its users do, of buildah from the archive.
fn try_image(builder: &str, image: &str, archive: &Path, containerfile: &str) -> io::Result<()> {
    let command = |words: &[&str]| {
        let mut command = Command::new(builder);
        command.args(words);
        command
    };
    let remove = || {
        let force: &[&str] = if builder == "buildah" { &[] } else { &["--force"] };
        let mut remove = command(&["rm"]);
        remove.args(force).arg(CONTAINER);
        remove.stdout(Stdio::null()).stderr(Stdio::null()).status()
    };
    // An earlier run that was stopped has not removed its container.
    remove()?;
    let tried = if builder == "buildah" {
        let mut make = command(&["from", "--name", CONTAINER]);
        process::succeed(make.arg(from_archive(archive)).stdout(Stdio::null()))?;
        let run = || command(&["run", "--isolation", "chroot", CONTAINER, "--", "/bin/jointplay"]);
        package::exercise(run).and_then(|()| health::check(containerfile, run, run))
    } else {
        let options = ["run", "--rm", "--name", CONTAINER, "--network", "host", "--read-only"];
        let run = || command(&[&options[..], &[image]].concat());
        let probe = || command(&["exec", CONTAINER, "/bin/jointplay"]);
        package::exercise(run).and_then(|()| health::check(containerfile, run, probe))
    };
    remove()?;
    tried
}

/// The layers of an image in an archive, by the sums of their contents; none in another file.
///
/// Two images of the same files differ in names that the builder invents for each.
pub(super) fn layers(archive: &Path) -> Option<Vec<String>> {
    let mut tar = Command::new("tar");
    tar.arg("-xOf").arg(archive).arg("manifest.json").stderr(Stdio::null());
    let images: serde_json::Value = serde_json::from_slice(&tar.output().ok()?.stdout).ok()?;
    let layers = images.get(0)?.get("Layers")?.as_array()?;
    layers.iter().map(|layer| layer.as_str().map(str::to_owned)).collect()
}

/// Makes a folder read-only in a mount namespace of its own, and starts a program in it as an ordinary user.
const READ_ONLY: &str = r#"
set -e
mount --bind "$0" "$0"
mount -o remount,ro,bind "$0"
if touch "$0/written" 2>/dev/null; then echo "$0 is not read-only" >&2; exit 1; fi
exec chroot --userspec=65532:65532 "$0" /jointplay "$@"
"#;

/// Runs the command, and its server until it is healthy, with nothing else in a read-only root.
fn in_read_only_root(folders: &Folders) -> io::Result<()> {
    let root = folders.empty("empty-root")?;
    fs::copy(folders.program().join("bin/jointplay"), root.join("jointplay"))?;
    let run = || {
        let mut run = Command::new("unshare");
        run.args(["--mount", "sh", "-c", READ_ONLY]).arg(&root);
        run
    };
    package::exercise(run)?;
    health::check(&fs::read_to_string(folders.root.join("Containerfile"))?, run, run)?;
    println!(
        "release: the command and its server run in a read-only root, and the health check passes"
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::folders::tests::folders;
    use super::*;

    #[test]
    fn each_builder_makes_an_archive_of_docker_with_the_health_check() {
        for (builder, built, written) in [
            ("docker", "build --tag j:1 --file c/Containerfile c", "save --output a.tar j:1"),
            (
                "podman",
                "build --tag j:1 --format docker --timestamp 7 --file c/Containerfile c",
                "save --output a.tar j:1",
            ),
            (
                "buildah",
                "build --tag j:1 --format docker --timestamp 7 --file c/Containerfile c",
                "push j:1 docker-archive:a.tar:j:1",
            ),
        ] {
            let found = image_commands(builder, "j:1", Path::new("c"), Path::new("a.tar"), "7");
            let line = |words: &Vec<OsString>| {
                words.iter().map(|word| word.to_str().unwrap()).collect::<Vec<_>>().join(" ")
            };
            assert_eq!(found.each_ref().map(line), [built, written], "{builder}");
        }
    }

    #[test]
    fn images_of_the_same_files_have_the_same_layers() {
        let root = folders("image").root;
        let image = |name: &str, manifest: &str| {
            let (folder, archive) = (root.join(name), root.join(format!("{name}.tar")));
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("manifest.json"), manifest).unwrap();
            let mut tar = Command::new("tar");
            process::succeed(
                tar.arg("-cf").arg(&archive).arg("-C").arg(&folder).arg("manifest.json"),
            )
            .unwrap();
            layers(&archive)
        };
        let one = image("one", r#"[{"Config": "1.json", "Layers": ["a.tar", "b.tar"]}]"#);
        assert_eq!(one, Some(vec!["a.tar".to_owned(), "b.tar".to_owned()]));
        assert_eq!(one, image("two", r#"[{"Config": "2.json", "Layers": ["a.tar", "b.tar"]}]"#));
        assert_ne!(one, image("three", r#"[{"Config": "1.json", "Layers": ["a.tar", "c.tar"]}]"#));
        assert_eq!(layers(&root.join("one/manifest.json")), None, "no archive");
        fs::remove_dir_all(&root).unwrap();
    }
}
