//! `cargo xtask release --dry-run`: everything that a release consists of, built, tried out and listed; nothing is uploaded.
//!
//! | file | role |
//! | --- | --- |
//! | `components.rs`, `notices.rs`, `sbom.rs` | third-party libraries in the binaries, their licences, and their list |
//! | `licences.rs` | whether `deny.toml` allows these licences |
//! | `program.rs` | the command for Linux, with manuals and completions, as an archive |
//! | `debian.rs` | the Debian package |
//! | `container.rs`, `health.rs` | the container image, or the same files in an empty root; its server and health check |
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
mod health;
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
    Step { name: "source", needs: &[], run: source::build },
    Step { name: "notices", needs: &[], run: write_notices },
    Step { name: "crates", needs: &[], run: package_crates },
    Step { name: "command", needs: &["notices"], run: program::build },
    Step { name: "debian", needs: &["notices", "command"], run: debian::build },
    Step { name: "container", needs: &["command"], run: container::build },
    Step { name: "wheels", needs: &["source", "notices"], run: wheels::build },
];

/// Runs the named steps, or all, for the workspace at `root`, and lists all that would be uploaded; true if each passed.
///
/// A step that fails does not stop those that do not need it.
pub(crate) fn dry_run(chosen: &[&str], root: &Path) -> bool {
    reported(|| {
        let (folders, steps) = (Folders::new(root)?, chosen_steps(chosen)?);
        let written = step::all(steps.iter().map(|step| step.write(&folders)));
        artefacts::publish(&folders, &STEPS.each_ref().map(|step| step.name))?;
        let changes = fs::read_to_string(root.join("CHANGELOG.md"))?;
        if let Some(remark) = changelog::remark(&changes, folders::VERSION) {
            println!("release: {remark}");
        }
        written
    })
}

/// Runs the named steps with those that they need, or all, also in a second folder, and compares the files; true if they are equal to the byte.
pub(crate) fn reproduce(chosen: &[&str], root: &Path) -> bool {
    reported(|| reproduction::run(&Folders::new(root)?, &with_needed(&chosen_steps(chosen)?)))
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

/// Steps with those that they need, in order.
fn with_needed(steps: &[&'static Step]) -> Vec<&'static Step> {
    let mut names: Vec<&str> = steps.iter().map(|step| step.name).collect();
    // Later steps need earlier ones.
    for step in STEPS.iter().rev() {
        if names.contains(&step.name) {
            names.extend(step.needs);
        }
    }
    STEPS.iter().filter(|step| names.contains(&step.name)).collect()
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
    if !package::run(&folders.root, package::Trial::Tests) {
        return Err(io::Error::other("the archives of the crates do not work"));
    }
    for archive in package::archives(&folders.root)? {
        folders.add(&archive)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_come_with_those_that_they_need() {
        let needed = |chosen: &[&str]| {
            let steps = with_needed(&chosen_steps(chosen).unwrap());
            steps.iter().map(|step| step.name).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(needed(&["debian"]), "notices command debian");
        assert_eq!(needed(&["container", "crates"]), "notices crates command container");
        assert_eq!(needed(&["wheels"]), "source notices wheels");
        assert_eq!(needed(&[]), STEPS.each_ref().map(|step| step.name).join(" "));
        // Each step needs earlier ones only.
        for (place, step) in STEPS.iter().enumerate() {
            for need in step.needs {
                assert!(STEPS[..place].iter().any(|earlier| earlier.name == *need), "{need}");
            }
        }
    }
}
