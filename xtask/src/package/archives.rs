//! The archives of the published crates, and what is in them.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{fs, io};

use crate::process;

/// Folder of the unpacked crates.
const FOLDER: &str = "target/archives";

/// Archives of the published crates, as uploaded; they are made now.
///
/// # Errors
/// If cargo cannot make them.
pub(crate) fn archives(root: &Path) -> io::Result<Vec<PathBuf>> {
    let mut package = process::cargo();
    package.args(["package", "--workspace", "--no-verify", "--allow-dirty", "--quiet"]);
    for name in packages(root, false)? {
        package.args(["--exclude", &name]);
    }
    process::succeed(package.current_dir(root))?;
    let folder = process::target(root).join("package");
    let names = packages(root, true)?;
    let version = env!("CARGO_PKG_VERSION");
    Ok(names.iter().map(|name| folder.join(format!("{name}-{version}.crate"))).collect())
}

/// The published crates, unpacked.
pub(super) struct Unpacked {
    /// The folder that holds them, as a workspace of its own.
    pub(super) folder: PathBuf,
    /// The name of each package, and its archive.
    pub(super) packages: Vec<(String, PathBuf)>,
}

impl Unpacked {
    /// The folder of a package.
    pub(super) fn of(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}-{}", env!("CARGO_PKG_VERSION")))
    }
}

/// Makes all archives and unpacks them into an empty folder, in which they replace those of the registry.
pub(super) fn unpack(root: &Path) -> io::Result<Unpacked> {
    let archives = archives(root)?;
    let folder = root.join(FOLDER);
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    for archive in &archives {
        process::succeed(Command::new("tar").arg("xzf").arg(archive).arg("-C").arg(&folder))?;
    }
    let packages: Vec<_> = packages(root, true)?.into_iter().zip(archives).collect();
    let unpacked = Unpacked { folder, packages };
    let profile = dev_profile(&fs::read_to_string(root.join("Cargo.toml"))?)?;
    fs::write(unpacked.folder.join("Cargo.toml"), manifest(&unpacked) + &profile)?;
    // The same versions of libraries as in the repository; cargo drops those that are not needed.
    fs::copy(root.join("Cargo.lock"), unpacked.folder.join("Cargo.lock"))?;
    Ok(unpacked)
}

/// The manifest of a workspace of the unpacked crates, in which each takes the others from here.
fn manifest(unpacked: &Unpacked) -> String {
    let mut text =
        "[workspace]\nresolver = \"3\"\nmembers = [\"jointplay*\"]\n\n[patch.crates-io]\n"
            .to_owned();
    for (name, _) in &unpacked.packages {
        text += &format!("{name} = {{ path = \"{name}-{}\" }}\n", env!("CARGO_PKG_VERSION"));
    }
    text
}

/// The profile of development and tests in a manifest, alone: without its levels of optimisation, tests take many times as long.
fn dev_profile(manifest: &str) -> io::Result<String> {
    let manifest: toml::Table = manifest.parse().map_err(io::Error::other)?;
    let dev = manifest.get("profile").and_then(|profiles| profiles.get("dev"));
    let dev = dev.ok_or_else(|| io::Error::other("Cargo.toml has no [profile.dev]"))?;
    let table = |key: &str, value| toml::Table::from_iter([(key.to_owned(), value)]);
    let alone = table("profile", toml::Value::Table(table("dev", dev.clone())));
    toml::to_string(&alone).map(|text| format!("\n{text}")).map_err(io::Error::other)
}

/// Names of the workspace's packages that are published, or of those that are not.
fn packages(root: &Path, published: bool) -> io::Result<Vec<String>> {
    let metadata = cargo_metadata::MetadataCommand::new()
        .current_dir(root)
        .no_deps()
        .exec()
        .map_err(io::Error::other)?;
    let is_published = |package: &cargo_metadata::Package| package.publish.is_none();
    let chosen = metadata.packages.iter().filter(|package| is_published(package) == published);
    Ok(chosen.map(|package| package.name.to_string()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_of_archives_are_optimised_as_those_of_the_repository() {
        let manifest = "[package]\nname = \"a\"\n\n[profile.dev]\ndebug = 0\n\n[profile.dev.package]\n\"*\" = { debug = false }\nb = { opt-level = 2 }\n\n[profile.release]\nlto = \"off\"\n";
        let alone: toml::Table = dev_profile(manifest).unwrap().parse().unwrap();
        let dev = alone["profile"]["dev"].as_table().unwrap();
        assert_eq!(dev["package"]["b"]["opt-level"].as_integer(), Some(2));
        assert_eq!((alone.len(), alone["profile"].as_table().unwrap().len()), (1, 1));
        assert!(dev_profile("[package]\n").is_err());
    }
}
