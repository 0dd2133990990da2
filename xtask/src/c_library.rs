//! `cargo xtask c-library`: the library for C, with its header and its file for pkg-config; `cargo xtask c` tests it.
//!
//! In the folder `target`, the façade has the name `libjointplay`; installed, the library for C has it.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::{command, process, python};

/// Libraries that an archive of Rust needs.
const PRIVATE: &str =
    if cfg!(target_os = "macos") { "-liconv -lm" } else { "-lgcc_s -lpthread -lm -ldl" };

/// Builds the optimized library of the workspace at `root`, shared and as an archive, and installs it into `prefix`; true if it succeeded.
pub(crate) fn install(prefix: &str, root: &Path) -> bool {
    let mut build = process::cargo();
    build.args(["rustc", "-p", "jointplay-c", "--lib", "--profile", "dist"]);
    build.args(["--crate-type", "cdylib,staticlib"]).current_dir(root);
    if !build.status().is_ok_and(|status| status.success()) {
        eprintln!("c-library: the library cannot be built");
        return false;
    }
    report(&copy(&process::target(root).join("dist"), Path::new(prefix), root))
}

/// Tests the library, built with the features of the tests, by programs in other languages; true if all passed.
pub(crate) fn run(root: &Path) -> bool {
    let mut build = process::cargo();
    build.args(["build", "--quiet", "--lib"]).args(command::AS_TESTED).current_dir(root);
    if !build.status().is_ok_and(|status| status.success()) {
        eprintln!("c: the library cannot be built");
        return false;
    }
    let prefix = process::target(root).join("c").join("prefix");
    report(&copy(&process::target(root).join("debug"), &prefix, root))
        && python::with_command(
            "crates/jointplay-c/test.py",
            root,
            Some(("JOINTPLAY_PREFIX", prefix)),
        )
}

fn report(copied: &io::Result<PathBuf>) -> bool {
    match copied {
        Ok(library) => println!("installed {}", library.display()),
        Err(error) => eprintln!("c-library: cannot install: {error}"),
    }
    copied.is_ok()
}

/// Copies library, header and file for pkg-config; returns the path of the library.
fn copy(built: &Path, prefix: &Path, root: &Path) -> io::Result<PathBuf> {
    let prefix = std::path::absolute(prefix)?;
    let (libraries, headers) = (prefix.join("lib"), prefix.join("include"));
    let configuration = libraries.join("pkgconfig");
    for folder in [&libraries, &headers, &configuration] {
        fs::create_dir_all(folder)?;
    }
    let (before, after) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let library = libraries.join(format!("{before}jointplay{after}"));
    fs::copy(built.join(format!("{before}jointplay_c{after}")), &library)?;
    let archive = built.join("libjointplay_c.a");
    if archive.exists() {
        fs::copy(archive, libraries.join("libjointplay.a"))?;
    }
    let source = root.join("crates").join("jointplay-c");
    fs::copy(source.join("include/jointplay.h"), headers.join("jointplay.h"))?;
    let template = fs::read_to_string(source.join("jointplay.pc.in"))?;
    let text = filled(&template, &prefix.display().to_string(), env!("CARGO_PKG_VERSION"));
    fs::write(configuration.join("jointplay.pc"), text)?;
    Ok(library)
}

/// The file for pkg-config.
fn filled(template: &str, prefix: &str, version: &str) -> String {
    let values = [("@PREFIX@", prefix), ("@VERSION@", version), ("@PRIVATE@", PRIVATE)];
    values.iter().fold(template.to_owned(), |text, (mark, value)| text.replace(mark, value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_built_is_installed_under_its_name() {
        let root = std::env::temp_dir().join(format!("xtask-c-{}", std::process::id()));
        let (built, source) = (root.join("built"), root.join("crates/jointplay-c"));
        fs::create_dir_all(&built).unwrap();
        fs::create_dir_all(source.join("include")).unwrap();
        let (before, after) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
        fs::write(built.join(format!("{before}jointplay_c{after}")), "library").unwrap();
        fs::write(source.join("include/jointplay.h"), "header").unwrap();
        fs::write(source.join("jointplay.pc.in"), "@PREFIX@ @VERSION@ @PRIVATE@").unwrap();
        let prefix = root.join("prefix");
        let library = copy(&built, &prefix, &root).unwrap();
        assert_eq!(library.file_name().unwrap(), format!("{before}jointplay{after}").as_str());
        assert_eq!(fs::read_to_string(library).unwrap(), "library");
        assert_eq!(fs::read_to_string(prefix.join("include/jointplay.h")).unwrap(), "header");
        let text = fs::read_to_string(prefix.join("lib/pkgconfig/jointplay.pc")).unwrap();
        assert!(text.starts_with(&format!("{} ", prefix.display())) && !text.contains('@'));
        assert!(!prefix.join("lib/libjointplay.a").exists());
        fs::remove_dir_all(&root).unwrap();
    }
}
