//! `cargo xtask release --dry-run`: everything that a release consists of, built, tried out and listed; nothing is uploaded.
//!
//! | file | role |
//! | --- | --- |
//! | `components.rs`, `notices.rs`, `sbom.rs` | third-party libraries in the binaries, their licences, and their list |
//! | `licences.rs` | whether `deny.toml` allows these licences |
//! | `program.rs` | the command for Linux, with manuals and completions, as an archive |
//! | `debian.rs` | the Debian package |
//! | `container.rs` | the container image, or the same files in an empty root |
//! | `source.rs` | the source with that of all libraries |
//! | `wheels.rs` | source distribution and wheels of the Python package |
//! | `reproduction.rs` | whether another folder gives the same bytes |
//! | `trial.rs` | installation in fresh systems |
//! | `step.rs` | a step, and the folder of its results |
//! | `artefacts.rs` | the files for upload, with checksums and destinations |
//! | `changelog.rs` | whether the changes of the version have a date |
//! | `folders.rs` | folders of results; the commit |

mod artefacts;
mod changelog;
mod components;
mod container;
mod debian;
mod folders;
mod licences;
mod notices;
mod program;
mod reproduction;
mod sbom;
mod source;
mod step;
mod trial;
mod wheels;

use std::path::Path;
use std::process::{Command, Stdio};
use std::{fs, io};

use self::folders::Folders;
use self::step::Step;
use crate::{package, process};

/// All steps, in order: later ones use the files of earlier ones.
static STEPS: [Step; 7] = [
    Step { name: "source", run: source::build },
    Step { name: "notices", run: write_notices },
    Step { name: "crates", run: package_crates },
    Step { name: "command", run: program::build },
    Step { name: "debian", run: debian::build },
    Step { name: "container", run: container::build },
    Step { name: "wheels", run: wheels::build },
];

/// Runs the named steps, or all, for the workspace at `root`, and lists all that would be uploaded; true if each passed.
pub(crate) fn dry_run(chosen: &[&str], root: &Path) -> bool {
    reported(|| {
        let (folders, steps) = (Folders::new(root)?, chosen_steps(chosen)?);
        steps.iter().try_for_each(|step| step.write(&folders))?;
        artefacts::publish(&folders, &STEPS.each_ref().map(|step| step.name))?;
        let changes = fs::read_to_string(root.join("CHANGELOG.md"))?;
        if let Some(remark) = changelog::remark(&changes, folders::VERSION) {
            println!("release: {remark}");
        }
        Ok(())
    })
}

/// Runs the named steps, or all, also in a second folder, and compares the files; true if they are equal to the byte.
pub(crate) fn reproduce(chosen: &[&str], root: &Path) -> bool {
    reported(|| reproduction::run(&Folders::new(root)?, &chosen_steps(chosen)?))
}

/// Installs and runs the files of the last dry run in fresh systems; true if each passed.
pub(crate) fn try_out(root: &Path) -> bool {
    reported(|| trial::run(&Folders::new(root)?))
}

/// Whether an action succeeded; prints its error.
fn reported(action: impl FnOnce() -> io::Result<()>) -> bool {
    action().inspect_err(|error| eprintln!("release: {error}")).is_ok()
}

/// The steps of these names, or all, in their order.
fn chosen_steps(chosen: &[&str]) -> io::Result<Vec<&'static Step>> {
    if let Some(unknown) = chosen.iter().find(|name| STEPS.iter().all(|step| step.name != **name)) {
        let names: Vec<&str> = STEPS.iter().map(|step| step.name).collect();
        let message = format!("unknown step {unknown}; steps are {}", names.join(", "));
        return Err(io::Error::other(message));
    }
    Ok(STEPS.iter().filter(|step| chosen.is_empty() || chosen.contains(&step.name)).collect())
}

/// Licences and notices of the libraries in the binaries, and their list.
///
/// The licences of the page's libraries are read from `studio/node_modules`, which a fresh clone lacks.
fn write_notices(folders: &Folders) -> io::Result<()> {
    let studio = folders.root.join("studio");
    if !studio.join("node_modules").exists() {
        let mut install = Command::new("npm");
        install.args(["ci", "--no-progress", "--ignore-scripts"]).current_dir(studio);
        process::succeed(install.stdout(Stdio::null()))?;
    }
    let components = components::components(&folders.root, folders::PLATFORM)?;
    licences::check(&components, &folders.root)?;
    fs::write(folders.notices(), notices::text(&components, &folders.root)?)?;
    fs::write(folders.component_list(), sbom::document(&components, folders::VERSION))?;
    println!("release: {} third-party libraries", components.len());
    Ok(())
}

/// The archives of the crates, after a trial of them.
fn package_crates(folders: &Folders) -> io::Result<()> {
    if !package::run(&folders.root, true) {
        return Err(io::Error::other("the archives of the crates do not work"));
    }
    for archive in package::archives(&folders.root)? {
        folders.add(&archive)?;
    }
    Ok(())
}
