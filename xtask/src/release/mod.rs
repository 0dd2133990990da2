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
//! | `artefacts.rs` | the files for upload, with checksums and destinations |
//! | `folders.rs` | folders of results; the commit |

mod artefacts;
mod components;
mod container;
mod debian;
mod folders;
mod licences;
mod notices;
mod program;
mod sbom;
mod source;

use std::path::Path;
use std::{fs, io};

use self::folders::Folders;
use crate::package;

/// A step of a release.
struct Step {
    name: &'static str,
    run: fn(&Folders) -> io::Result<()>,
}

/// All steps, in order: later ones use the files of earlier ones.
const STEPS: [Step; 6] = [
    Step { name: "source", run: source::build },
    Step { name: "notices", run: write_notices },
    Step { name: "crates", run: package_crates },
    Step { name: "command", run: program::build },
    Step { name: "debian", run: debian::build },
    Step { name: "container", run: container::build },
];

/// Runs the named steps, or all, for the workspace at `root`, and lists all that would be uploaded; true if each passed.
pub(crate) fn dry_run(chosen: &[&str], root: &Path) -> bool {
    if let Some(unknown) = chosen.iter().find(|name| STEPS.iter().all(|step| step.name != **name)) {
        let names: Vec<&str> = STEPS.iter().map(|step| step.name).collect();
        eprintln!("release: unknown step {unknown}; steps are {}", names.join(", "));
        return false;
    }
    let folders = match Folders::new(root) {
        Ok(folders) => folders,
        Err(error) => {
            eprintln!("release: {error}");
            return false;
        }
    };
    for step in STEPS.iter().filter(|step| chosen.is_empty() || chosen.contains(&step.name)) {
        println!("\n=== {}", step.name);
        if let Err(error) = folders.run(step.name, step.run) {
            eprintln!("release: {}: {error}", step.name);
            return false;
        }
    }
    match artefacts::publish(&folders, &STEPS.map(|step| step.name)) {
        Ok(()) => true,
        Err(error) => {
            eprintln!("release: {error}");
            false
        }
    }
}

/// Licences and notices of the libraries in the binaries, and their list.
fn write_notices(folders: &Folders) -> io::Result<()> {
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
