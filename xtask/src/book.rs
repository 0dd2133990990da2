//! `cargo xtask book`: build the documentation as a book, and check every link and anchor in it.
//!
//! `mdbook` is installed into `target/tools` where it is missing.
//! It passes its chapters through `cargo xtask chapters`, which sets formulas as MathML (no script and no network is needed to read them),
//! makes links to files of the repository lead to copies in the book, and writes the reference of the HTTP interface.
//! The documentation of the library is next to the chapters, as rustdoc writes it.

mod accessible;
mod chapters;
mod http;
mod links;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{fs, io};

use crate::process;
use links::{FILES, RUST};

pub(crate) use chapters::run as chapters;

/// The version that is installed where there is none.
const VERSION: &str = "0.5.4";

/// Where `book.toml` puts the book.
const BOOK: &str = "target/book";

/// Builds the book of the repository at `root` and checks its links; true if all passed.
pub(crate) fn run(root: &Path) -> bool {
    let Some(mdbook) = installed(root) else { return false };
    let built = Command::new(mdbook).arg("build").current_dir(root).status();
    if !built.is_ok_and(|status| status.success()) {
        eprintln!("book: mdbook failed, see above");
        return false;
    }
    let book = root.join(BOOK);
    match accessible::change(&book)
        .and_then(|()| add_rust(root, &book))
        .and_then(|()| links::files(&book))
        .and_then(|files| copy(&files, root, &book))
        .and_then(|()| links::dead(&book))
    {
        Ok(dead) => {
            dead.iter().for_each(|link| eprintln!("book: {link}"));
            println!("book: {BOOK}/index.html, {} dead links", dead.len());
            dead.is_empty()
        }
        Err(error) => {
            eprintln!("book: {BOOK}: {error}");
            false
        }
    }
}

/// Adds the documentation of the library, made as the tests make it; its links are those that rustdoc checks.
fn add_rust(root: &Path, book: &Path) -> io::Result<()> {
    let mut doc = process::cargo();
    doc.args(["doc", "--quiet", "--workspace", "--all-features", "--no-deps"]).current_dir(root);
    process::succeed(doc.env("RUSTDOCFLAGS", "-D warnings"))?;
    let (made, place) = (process::target(root).join("doc"), book.join(RUST));
    if place.exists() {
        fs::remove_dir_all(&place)?;
    }
    link_all(&made, &place)
}

/// Copies a folder, by hard links where the file system has them.
fn link_all(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in from.read_dir()? {
        let path = entry?.path();
        let place = to.join(path.file_name().unwrap_or_default());
        if path.is_dir() {
            link_all(&path, &place)?;
        } else if fs::hard_link(&path, &place).is_err() {
            fs::copy(&path, &place)?;
        }
    }
    Ok(())
}

/// The path of an `mdbook` of our version, installed now if it is missing.
fn installed(root: &Path) -> Option<PathBuf> {
    let tools = root.join("target").join("tools");
    let mdbook = tools.join("bin").join(format!("mdbook{}", std::env::consts::EXE_SUFFIX));
    let is_ours = |program: &Path| {
        let output = Command::new(program).arg("--version").output();
        output.is_ok_and(|found| String::from_utf8_lossy(&found.stdout).contains(VERSION))
    };
    if is_ours(Path::new("mdbook")) {
        return Some("mdbook".into());
    }
    if is_ours(&mdbook) || install(&tools) {
        return Some(mdbook);
    }
    eprintln!("book: mdbook {VERSION} cannot be installed into {}", tools.display());
    None
}

/// Installs `mdbook` with its search, without its server, and not optimised: that would take longer than the book.
pub(crate) fn install(tools: &Path) -> bool {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut install = Command::new(cargo);
    install.args(["install", "--debug", "--quiet", "--locked", "mdbook", "--version", VERSION]);
    install.args(["--no-default-features", "--features", "search", "--root"]).arg(tools);
    install.arg("--target-dir").arg(tools.join("build"));
    install.status().is_ok_and(|status| status.success())
}

/// Copies the files of the repository that the book links.
fn copy(files: &[String], root: &Path, book: &Path) -> io::Result<()> {
    for file in files {
        let from = root.join(file);
        let from = if from.exists() { from } else { from.with_extension("md") };
        let to = book.join(FILES).join(file);
        // What is missing is reported as a dead link.
        if from.is_file() {
            fs::create_dir_all(to.parent().unwrap_or(book))?;
            fs::copy(from, to)?;
        }
    }
    Ok(())
}
