//! `cargo xtask release --reproduce`: whether the same commit in another folder gives the same bytes.

use std::path::PathBuf;
use std::process::Command;
use std::{env, fs, io};

use super::container::layers;
use super::folders::Folders;
use super::program::file_name;
use super::step::{self, Step};
use crate::process;

/// Name of the other folder; spaces are where build flags break.
const CLONE: &str = "second copy of the source";

/// Runs the steps in a clone of the commit, after those that have no results yet here, and compares their files.
///
/// `steps` has those that the others need, in order. A step that fails or differs does not stop the others.
///
/// # Errors
/// With the files that differ, or if a step fails.
pub(super) fn run(folders: &Folders, steps: &[&Step]) -> io::Result<()> {
    if env::var_os("CARGO_TARGET_DIR").is_some_and(|folder| PathBuf::from(folder).is_absolute()) {
        let message = "CARGO_TARGET_DIR is absolute: both builds would be in the same folder";
        return Err(io::Error::other(message));
    }
    let unfinished = steps.iter().filter(|step| !folders.is_finished(step.name));
    let written = step::all(unfinished.map(|step| step.write(folders)));
    let clone = folders.work.join(CLONE);
    if clone.exists() {
        fs::remove_dir_all(&clone)?;
    }
    let mut git = Command::new("git");
    git.args(["clone", "--quiet", "--shared", "--no-checkout"]).arg(&folders.root).arg(&clone);
    process::succeed(&mut git)?;
    let mut git = Command::new("git");
    git.args(["checkout", "--quiet", "--detach", &folders.commit]).current_dir(&clone);
    process::succeed(&mut git)?;
    let other = Folders::new(&clone)?;
    let reproduced = step::all(steps.iter().map(|step| {
        folders.require(step.name)?;
        step.write(&other)?;
        let differences = compared(folders, &other, step.name)?;
        if differences.is_empty() {
            return Ok(());
        }
        let message = format!("{}: not reproducible: {}", step.name, differences.join(", "));
        Err(io::Error::other(message))
    }));
    written.and(reproduced)
}

/// Files of a step that are not in both folders with the same bytes; prints the others.
fn compared(one: &Folders, other: &Folders, step: &str) -> io::Result<Vec<String>> {
    let (files, others) = (one.finished(step)?, other.finished(step)?);
    let mut differences: Vec<String> = others
        .iter()
        .map(|file| file_name(file))
        .filter(|name| files.iter().all(|file| file_name(file) != *name))
        .collect();
    for file in files {
        let name = file_name(&file);
        let copy = other.results(step).join(&name);
        if fs::read(&copy).ok() == Some(fs::read(&file)?) {
            println!("release: {name}: equal in both folders");
        } else if layers(&file).is_some_and(|found| layers(&copy) == Some(found)) {
            println!("release: {name}: equal layers in both folders, other names by the builder");
        } else {
            differences.push(name);
        }
    }
    Ok(differences)
}

#[cfg(test)]
mod tests {
    use super::super::folders::tests::folders;
    use super::*;

    #[test]
    fn files_that_differ_or_are_missing_are_reported() {
        let (one, other) = (folders("reproduction-1"), folders("reproduction-2"));
        let write = |folders: &Folders, files: &[(&str, &str)]| {
            let all = |folders: &Folders| {
                files.iter().try_for_each(|(name, text)| fs::write(folders.out.join(name), text))
            };
            folders.run("step", all).unwrap();
        };
        write(&one, &[("a", "1"), ("b", "1"), ("c", "1")]);
        write(&other, &[("a", "1"), ("b", "2"), ("d", "1")]);
        let mut found = compared(&one, &other, "step").unwrap();
        found.sort();
        assert_eq!(found, ["b", "c", "d"]);
        write(&other, &[("a", "1"), ("b", "1"), ("c", "1")]);
        assert!(compared(&one, &other, "step").unwrap().is_empty());
        fs::remove_dir_all(&one.root).unwrap();
        fs::remove_dir_all(&other.root).unwrap();
    }
}
