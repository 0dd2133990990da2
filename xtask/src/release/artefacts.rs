//! The files of a release: one list, from which they are copied, printed and uploaded.

use std::path::PathBuf;
use std::{fs, io};

use sha2::{Digest as _, Sha256};

use super::folders::{Folders, VERSION};
use super::program::file_name;

/// The files of the release page with their checksums, as `sha256sum --check` reads it; the workflow uploads what it lists.
const CHECKSUMS: &str = "SHA256SUMS";

/// Where a file is uploaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Destination {
    CargoRegistry,
    PythonIndex,
    ReleasePage,
}

impl Destination {
    /// Destination of a file by its name.
    fn of(name: &str) -> Self {
        if name.ends_with(".crate") {
            Self::CargoRegistry
        } else if name.ends_with(".whl") || name == format!("jointplay-{VERSION}.tar.gz") {
            Self::PythonIndex
        } else {
            Self::ReleasePage
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::CargoRegistry => "Cargo registry",
            Self::PythonIndex => "Python package index",
            Self::ReleasePage => "release page",
        }
    }
}

/// Copies the results of all finished steps into the empty folder for uploads, with their checksums, and prints them with sizes and destinations.
pub(super) fn publish(folders: &Folders, steps: &[&str]) -> io::Result<()> {
    let mut files: Vec<PathBuf> = Vec::new();
    let mut unfinished = Vec::new();
    for step in steps {
        let found = folders.finished(step)?;
        if !folders.is_finished(step) {
            unfinished.push(*step);
        }
        files.extend(found);
    }
    files.sort_by_key(|file| file_name(file));
    if folders.out.exists() {
        fs::remove_dir_all(&folders.out)?;
    }
    fs::create_dir_all(&folders.out)?;
    let mut sums = String::new();
    println!("\n{:>12}  {:<64}  {:<20}  file", "bytes", "SHA-256", "destination");
    let print = |name: &str, bytes: &[u8], destination: Destination| {
        let sum = hexadecimal(&Sha256::digest(bytes));
        println!("{:>12}  {sum}  {:<20}  {name}", bytes.len(), destination.name());
    };
    for file in &files {
        let (bytes, name) = (fs::read(file)?, file_name(file));
        let destination = Destination::of(&name);
        if destination == Destination::ReleasePage {
            sums += &format!("{}  {name}\n", hexadecimal(&Sha256::digest(&bytes)));
        }
        print(&name, &bytes, destination);
        fs::write(folders.out.join(name), bytes)?;
    }
    print(CHECKSUMS, sums.as_bytes(), Destination::ReleasePage);
    fs::write(folders.out.join(CHECKSUMS), sums)?;
    for step in steps {
        for what in folders.absent(step) {
            println!("not made on this machine: {what}");
        }
    }
    if !unfinished.is_empty() {
        println!("\nrelease: not complete; steps without results: {}", unfinished.join(", "));
    }
    println!(
        "\nrelease: {} files in {}; nothing was uploaded",
        files.len() + 1,
        folders.out.display()
    );
    Ok(())
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_the_release_page_are_those_with_checksums() {
        let root = std::env::temp_dir().join(format!("xtask-artefacts-{}", std::process::id()));
        fs::create_dir_all(root.join("files")).unwrap();
        let folders = Folders {
            out: root.join("files"),
            work: root.join("work"),
            commit: "a".to_owned(),
            time: String::new(),
            root: root.clone(),
        };
        fs::write(folders.out.join("stale.deb"), "old").unwrap();
        let write =
            |name: &'static str| move |folders: &Folders| fs::write(folders.out.join(name), "abc");
        folders.run("one", write("a.deb")).unwrap();
        folders.run("two", write("a.crate")).unwrap();
        for _ in 0..2 {
            publish(&folders, &["one", "two", "three"]).unwrap();
        }
        let sums = fs::read_to_string(folders.out.join(CHECKSUMS)).unwrap();
        let mut names: Vec<String> = folders
            .out
            .read_dir()
            .unwrap()
            .map(|entry| file_name(&entry.unwrap().path()))
            .collect();
        names.sort();
        fs::remove_dir_all(&root).unwrap();
        // FIPS 180-2, B.1.
        let expect = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sums, format!("{expect}  a.deb\n"));
        assert_eq!(names, [CHECKSUMS, "a.crate", "a.deb"]);
    }
}
