//! `cargo xtask release --dry-run`: everything that a release consists of, built, tried out and listed; nothing is uploaded.
//!
//! | file | role |
//! | --- | --- |
//! | `components.rs`, `notices.rs`, `sbom.rs` | libraries of others in the binaries, their licences, and their list |
//! | `licences.rs` | whether `deny.toml` allows these licences |
//! | `program.rs` | the command for Linux, with manuals and completions, as an archive |
//! | `debian.rs` | the Debian package |
//! | `python.rs` | wheels and the source distribution |
//! | `container.rs` | the container image, or the same files in an empty root |
//! | `source.rs` | the source with that of all libraries |
//! | `artefacts.rs` | checksums, and the table of what would be uploaded |

mod artefacts;
mod components;
mod container;
mod debian;
mod licences;
mod notices;
mod place;
mod program;
mod python;
mod sbom;
mod source;

use std::path::Path;
use std::{fs, io};

use self::place::Place;
use crate::package;

/// A step of a release.
struct Step {
    name: &'static str,
    run: fn(&Place) -> io::Result<()>,
}

/// All steps, in order: later ones use the files of earlier ones.
const STEPS: [Step; 7] = [
    Step { name: "source", run: source::build },
    Step { name: "notices", run: write_notices },
    Step { name: "crates", run: package_crates },
    Step { name: "command", run: program::build },
    Step { name: "debian", run: debian::build },
    Step { name: "container", run: container::build },
    Step { name: "python", run: python::build },
];

/// Runs the named steps, or all, for the workspace at `root`, and lists all that would be uploaded; true if each passed.
pub(crate) fn dry_run(chosen: &[&str], root: &Path) -> bool {
    if let Some(unknown) = chosen.iter().find(|name| STEPS.iter().all(|step| step.name != **name)) {
        let names: Vec<&str> = STEPS.iter().map(|step| step.name).collect();
        eprintln!("release: unknown step {unknown}; steps are {}", names.join(", "));
        return false;
    }
    let place = match Place::new(root) {
        Ok(place) => place,
        Err(error) => {
            eprintln!("release: {error}");
            return false;
        }
    };
    for step in STEPS.iter().filter(|step| chosen.is_empty() || chosen.contains(&step.name)) {
        println!("\n=== {}", step.name);
        if let Err(error) = (step.run)(&place) {
            eprintln!("release: {}: {error}", step.name);
            return false;
        }
    }
    match artefacts::list(&place) {
        Ok(()) => true,
        Err(error) => {
            eprintln!("release: {error}");
            false
        }
    }
}

/// Licences and notices of the libraries in the binaries, and their list.
fn write_notices(place: &Place) -> io::Result<()> {
    let components = components::components(&place.root, place::PLATFORM)?;
    licences::check(&components, &place.root)?;
    fs::write(place.notices(), notices::text(&components, &place.root)?)?;
    fs::write(place.bill(), sbom::document(&components, place::VERSION))?;
    println!("release: {} libraries of others", components.len());
    Ok(())
}

/// The archives of the crates, after a trial of them.
fn package_crates(place: &Place) -> io::Result<()> {
    if !package::run(&place.root, true) {
        return Err(io::Error::other("the archives of the crates do not work"));
    }
    for archive in package::archives(&place.root)? {
        place.keep(&archive)?;
    }
    Ok(())
}
