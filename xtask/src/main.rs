//! The project's own chores, run as `cargo xtask NAME`.
//!
//! | chore    | what it answers                                     |
//! | -------- | --------------------------------------------------- |
//! | `test`   | May this change go in? Runs everything below too.   |
//! | `tidy`   | Do the documents and sources keep the house rules?  |
//! | `circles` | Do the files of each crate import each other in one direction? |
//! | `words` | Do documents, messages and names use the field's terms? |
//! | `deps`   | Does each crate import only what its ring may?      |
//! | `python` | Does the Python package work where it is installed? |
//! | `cell`   | Do other programs read exported motions?             |
//! | `c-library` | Installs the library for C.                        |
//! | `c`      | Do programs in C, C++ and C#, and simulators, work with it? |
//! | `embedded` | Does a microcontroller compute the same numbers, without standard library and heap? |
//! | `wasm` | Builds the WebAssembly module. |
//! | `studio` | Does the studio's server keep its own description?   |
//! | `page`   | Does the studio's page work in a browser?           |
//! | `book`   | Does the documentation build, without dead links?   |
//! | `release --dry-run` | Can everything that a release consists of be built, installed and run? |
//! | `release --try` | Do its files work in fresh systems without Rust and Node? |
//! | `release --reproduce` | Does another folder give the same bytes? |
//! | `interface` | Is the public interface of the libraries the recorded one? |
//! | `package` | Do the archives of the published crates have all they need? |

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a chore reports to the person who runs it"
)]

mod book;
mod c_library;
mod cell;
mod circles;
mod command;
mod deps;
mod embedded;
mod finding;
mod interface;
mod markdown;
mod package;
mod page;
mod process;
mod python;
mod release;
mod root;
mod rust_source;
mod studio;
mod test;
mod tidy;
mod tree;
mod wasm;
mod words;

use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask CHORE
       cargo xtask c-library --prefix FOLDER    install the library for C
       cargo xtask release --dry-run [STEP…]    all that a release consists of; nothing is uploaded
       cargo xtask release --reproduce [STEP…]  the same files from another folder, compared to the byte
       cargo xtask release --try                the files installed and run in fresh Debian systems; needs root

  test     everything a change must pass, stopping at the first failure
  tidy     paths, links, source keys, sizes and unfinished code
  circles  files that import each other
  deps     who may import whom
  words    words to avoid, and the field's terms for them
  python   the Python package: its wheel, tested in clean environments
  cell     exported motions, read by other programs
  c        the library for C, called by programs in C, C++ and C#, and in units by FMPy
  embedded the core without the standard library, on a simulated microcontroller
  wasm     the WebAssembly module, built; with --check, the one in the repository is tested
  studio   the studio's server, checked against its own description
  page     the studio's page: built, and tested in a browser; with --build or --browse, one of both
  book     the documentation as a book, with every link checked
  interface the public interface of the libraries, compared with the recorded one; with --update, recorded
  package  the archives of the published crates; with --build, compiled and run from the archives alone; with --test, also tested";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let root = root::find();
    let passed = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["test"] => test::run(&root),
        ["tidy"] => tidy::run(&root),
        ["circles"] => circles::run(&root),
        ["words"] => words::run(&root),
        ["deps"] => deps::run(&root),
        ["python"] => python::run(&root),
        ["cell"] => cell::run(&root),
        ["c"] => c_library::run(&root),
        ["c-library", "--prefix", prefix] => c_library::install(prefix, &root),
        ["embedded"] => embedded::run(&root),
        ["embedded", "--check"] => embedded::check(&root),
        ["wasm"] => wasm::run(&root),
        ["wasm", "--check"] => wasm::check(&root),
        ["studio"] => studio::run(&root),
        ["page"] => page::run(&root),
        ["page", "--build"] => page::build(&root),
        ["page", "--browse"] => page::browse(&root),
        ["release", "--dry-run", ref steps @ ..] => release::dry_run(steps, &root),
        ["release", "--reproduce", ref steps @ ..] => release::reproduce(steps, &root),
        ["release", "--try"] => release::try_out(&root),
        ["book"] => book::run(&root),
        ["interface"] => interface::run(&root, false),
        ["interface", "--update"] => interface::run(&root, true),
        ["package"] => package::run(&root, package::Trial::Contents),
        ["package", "--build"] => package::run(&root, package::Trial::Command),
        ["package", "--test"] => package::run(&root, package::Trial::Tests),
        // Asked by mdbook alone.
        ["chapters"] => book::chapters(),
        ["chapters", "supports", renderer] => renderer == "html",
        // Asked by maturin alone.
        ["rustc", ref arguments @ ..] => python::rustc(arguments, &root),
        [] | ["help" | "-h" | "--help"] => {
            println!("{USAGE}");
            true
        }
        _ => {
            eprintln!("unknown chore: {}\n\n{USAGE}", arguments.join(" "));
            return ExitCode::from(2);
        }
    };
    if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
