//! `cargo xtask wasm`: builds the WebAssembly module, which is part of the repository; `--check` tests the one that is there.
//!
//! The target of the compiler comes from rustup; types and JavaScript are compiled by the TypeScript of the studio.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{fs, io};

use sha2::{Digest, Sha256};

use crate::{embedded, page, process};

const TARGET: &str = "wasm32-unknown-unknown";
const FOLDER: &str = "crates/jointplay-wasm/js";
/// Digests of all sources of the module, from the list that the compiler writes.
const SOURCES: &str = "crates/jointplay-wasm/js/dist/sources.txt";
/// Sources that the compiler does not list.
const OTHERS: [&str; 4] = [
    "crates/jointplay-core/Cargo.toml",
    "crates/jointplay-wasm/Cargo.toml",
    "crates/jointplay-wasm/js/jointplay.ts",
    "crates/jointplay-wasm/js/tsconfig.json",
];

/// Builds the module at `root` and tests it; true if it passed.
pub(crate) fn run(root: &Path) -> bool {
    build(root).inspect_err(|error| eprintln!("wasm: {error}")).is_ok() && check(root)
}

/// Whether the module is built from the present sources, and its numbers are those of the library.
pub(crate) fn check(root: &Path) -> bool {
    let outdated = fs::read_to_string(root.join(SOURCES)).and_then(|list| outdated(root, &list));
    match outdated {
        Err(error) => eprintln!("wasm: {SOURCES}: {error}"),
        Ok(files) if !files.is_empty() => {
            eprintln!("wasm: the module is older than its sources; run `cargo xtask wasm`");
            files.iter().for_each(|file| eprintln!("  {file} has changed"));
        }
        Ok(_) => {
            let Some(node) = page::find() else { return false };
            let mut test = Command::new(node);
            let tested = process::succeed(test.arg(format!("{FOLDER}/test.mjs")).current_dir(root));
            return tested.inspect_err(|error| eprintln!("wasm: {error}")).is_ok();
        }
    }
    false
}

fn build(root: &Path) -> io::Result<()> {
    embedded::add_target(TARGET)?;
    let target = process::target(root).join("wasm");
    let mut cargo = process::cargo();
    cargo.args(["build", "-p", "jointplay-wasm", "--lib", "--profile", "wasm", "--target", TARGET]);
    cargo.arg("--target-dir").arg(&target).current_dir(root);
    // Paths of this computer do not belong into the module.
    let flags = format!("--remap-path-prefix={}=jointplay", root.display());
    process::succeed(cargo.env("CARGO_ENCODED_RUSTFLAGS", flags))?;
    let built = target.join(TARGET).join("wasm");
    let mut tsc = Command::new(root.join("studio/node_modules/.bin/tsc"));
    process::succeed(tsc.arg("-p").arg(FOLDER).current_dir(root))
        .map_err(|error| io::Error::other(format!("{error}; run `npm ci` in the folder studio")))?;
    let module = root.join(FOLDER).join("dist/jointplay.wasm");
    fs::write(&module, fs::read(built.join("jointplay_wasm.wasm"))?)?;
    let list = fs::read_to_string(built.join("jointplay_wasm.d"))?;
    fs::write(root.join(SOURCES), digests(root, &sources(root, &list))?)?;
    println!("{} has {} bytes", module.display(), fs::metadata(&module)?.len());
    Ok(())
}

/// Sources in a list of the compiler, by their path in the repository, and the others.
fn sources(root: &Path, list: &str) -> BTreeSet<PathBuf> {
    let listed = list.split_once(": ").map_or("", |(_, sources)| sources);
    let listed =
        listed.split_whitespace().filter_map(|path| Path::new(path).strip_prefix(root).ok());
    listed.chain(OTHERS.iter().map(Path::new)).map(Path::to_owned).collect()
}

/// A line with digest and path for each file.
fn digests(root: &Path, files: &BTreeSet<PathBuf>) -> io::Result<String> {
    let mut text = String::new();
    for file in files {
        let _ = writeln!(text, "{} {}", digest(&root.join(file))?, file.display());
    }
    Ok(text)
}

fn digest(file: &Path) -> io::Result<String> {
    let digest = Sha256::digest(fs::read(file)?);
    Ok(digest.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Files of a list of digests that are not there any more, or differ.
fn outdated(root: &Path, list: &str) -> io::Result<Vec<String>> {
    let lines: Vec<_> = list.lines().filter_map(|line| line.split_once(' ')).collect();
    if lines.is_empty() {
        return Err(io::Error::other("no sources are listed"));
    }
    let same = |digest_then: &str, file: &str| {
        digest(&root.join(file)).is_ok_and(|now| now == digest_then)
    };
    Ok(lines
        .iter()
        .filter(|(then, file)| !same(then, file))
        .map(|(_, file)| (*file).to_owned())
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_and_missing_sources_are_found() {
        let root = std::env::temp_dir().join(format!("xtask-wasm-{}", std::process::id()));
        fs::create_dir_all(root.join("src")).unwrap();
        for name in ["a.rs", "b.rs", "c.rs"] {
            fs::write(root.join("src").join(name), name).unwrap();
        }
        let [a, b, c] = ["a.rs", "b.rs", "c.rs"].map(|name| Path::new("src").join(name));
        let list = digests(&root, &[a, b, c].into_iter().collect()).unwrap();
        assert_eq!(outdated(&root, &list).unwrap(), <[String; 0]>::default());
        fs::write(root.join("src/b.rs"), "changed").unwrap();
        fs::remove_file(root.join("src/c.rs")).unwrap();
        let found = outdated(&root, &list).unwrap();
        assert!(outdated(&root, "").is_err());
        fs::remove_dir_all(&root).unwrap();
        assert_eq!(found, ["src/b.rs", "src/c.rs"]);
    }

    #[test]
    fn sources_outside_of_the_repository_are_left_to_the_lock_file() {
        let found = sources(Path::new("/r"), "/r/target/a.wasm: /r/crates/x.rs /home/libm.rs");
        assert_eq!(found.len(), 1 + OTHERS.len());
        assert!(found.contains(Path::new("crates/x.rs")));
    }
}
