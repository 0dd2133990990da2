//! The container image: the static command alone, for an ordinary user and a read-only root.
//!
//! Where no builder of images is installed, the same files are run in an empty root without one.

use std::process::{Command, Stdio};
use std::{fs, io};

use super::place::{Place, VERSION};
use crate::process;

/// Programs that build images, in order of preference.
const BUILDERS: [&str; 3] = ["podman", "buildah", "docker"];

/// Builds the image, or runs the command as it would be in one.
pub(super) fn build(place: &Place) -> io::Result<()> {
    let context = place.empty("container")?;
    let program = place.program();
    fs::copy(program.join("bin/jointplay"), context.join("jointplay"))?;
    for name in ["LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.txt"] {
        fs::copy(program.join(name), context.join(name))?;
    }
    fs::copy(place.root.join("Containerfile"), context.join("Containerfile"))?;
    let works = |builder: &&&str| {
        let mut info = Command::new(builder);
        info.arg("info").stdout(Stdio::null()).stderr(Stdio::null());
        info.status().is_ok_and(|status| status.success())
    };
    let Some(builder) = BUILDERS.iter().find(works) else {
        println!("release: no builder of images works here; the command is run in an empty root");
        return in_empty_root(place);
    };
    let image = format!("jointplay:{VERSION}");
    let mut build = Command::new(builder);
    build
        .args(["build", "--tag", &image, "--file"])
        .arg(context.join("Containerfile"))
        .arg(&context);
    process::succeed(&mut build)?;
    let archive = place.out.join(format!("jointplay-{VERSION}-image.tar"));
    process::succeed(Command::new(builder).args(["save", "--output"]).arg(archive).arg(&image))
}

/// Runs the command with nothing else in its root, as an ordinary user who cannot write there.
fn in_empty_root(place: &Place) -> io::Result<()> {
    let root = place.empty("empty-root")?;
    fs::copy(place.program().join("bin/jointplay"), root.join("jointplay"))?;
    for line in ["--version", "mobility hexapod", "cell check"] {
        let mut run = Command::new("chroot");
        run.args(["--userspec=65532:65532"]).arg(&root).arg("/jointplay").args(line.split(' '));
        process::succeed(run.stdout(Stdio::null()))?;
    }
    Ok(())
}
