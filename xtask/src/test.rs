//! `cargo xtask test`: everything a change must pass, stopping at the first failure.
//!
//! Quick steps come first; while the others compile, what they need from the network is fetched. Benches are compiled by clippy's `--all-targets`.
//! Steps that run other programs are last, some of them at the same time: the tests of the page wait for pictures, and those of Python for answers.

mod ahead;
mod concurrent;
mod logged;

use self::ahead::Ahead;
use self::concurrent::Concurrent;
use crate::{
    book, c_library, cell, circles, deps, embedded, interface, package, page, python, studio, tidy,
    wasm, words,
};
use std::io::{self, IsTerminal};
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// One thing a change must pass.
struct Step {
    /// Arguments of cargo.
    arguments: Vec<String>,
    /// Environment of this step alone.
    environment: Option<(&'static str, &'static str)>,
    /// Advice for a failure.
    cure: String,
}

impl Step {
    fn new(arguments: &str, cure: impl Into<String>) -> Self {
        let arguments = arguments.split_whitespace().map(str::to_owned).collect();
        Self { arguments, environment: None, cure: cure.into() }
    }

    /// The line a user would type to run this step alone.
    fn command_line(&self) -> String {
        let quoted =
            self.environment.map(|(key, value)| format!("{key}=\"{value}\" ")).unwrap_or_default();
        format!("{quoted}cargo {}", self.arguments.join(" "))
    }
}

/// The folder of the examples.
const EXAMPLES: &str = "crates/jointplay/examples";

/// Arguments of cargo before the name of an example.
const EXAMPLE: &str = "run -p jointplay --example ";

/// Random cases are the same in each run, so that a failure speaks of the change; `cargo test` alone draws new ones.
const SAME_CASES: (&str, &str) = ("PROPTEST_RNG_SEED", "1");

/// The first step that takes long.
const CLIPPY: &str = "clippy --workspace --all-targets --all-features -- -D warnings";

/// The command as `cargo install` builds it, with default features alone; with other packages it would have the features that they ask for.
const DEFAULT_FEATURES: &str = "clippy -p jointplay-cli --bins -- -D warnings";

/// The documentation of all crates, in which a broken link is an error.
const DOC: &str = "doc --workspace --all-features --no-deps";

/// The two halves of the tests of the page, of which the first needs no book.
const PAGE_BUILD: &str = "page --build";
const PAGE_BROWSE: &str = "page --browse";

/// Runs all steps in the workspace at `root`; true if each passed.
pub(crate) fn run(root: &Path) -> bool {
    let examples = match examples(root) {
        Ok(examples) => examples,
        Err(error) => {
            eprintln!("test: cannot read {EXAMPLES}: {error}");
            return false;
        }
    };
    let (mut ahead, mut concurrent) = (Ahead::default(), Concurrent::default());
    run_steps(&steps(&examples), |step| match step.arguments.join(" ").as_str() {
        // Already in this program: no need to start it again.
        "xtask tidy" => tidy::run(root),
        "xtask deps" => deps::run(root),
        "xtask circles" => circles::run(root),
        "xtask words" => words::run(root),
        CLIPPY => {
            ahead.start(root);
            run_cargo(step, root)
        }
        DOC => {
            if !ahead.wait("page") {
                return false;
            }
            // It needs nothing of the crates, which keep one processor busy at a time while they compile.
            concurrent.start(PAGE_BUILD, root);
            run_cargo(step, root)
        }
        "xtask interface" => interface::run(root, false),
        "xtask package" => package::run(root, package::Trial::Contents),
        "xtask book" => {
            for chore in ["studio", "python"] {
                if !ahead.wait(chore) {
                    return false;
                }
                concurrent.start(chore, root);
            }
            let done = book::run(root);
            if !concurrent.finish(PAGE_BUILD).unwrap_or_else(|| page::build(root)) || !done {
                return false;
            }
            // Its tests open the book.
            concurrent.start(PAGE_BROWSE, root);
            true
        }
        "xtask embedded --check" => embedded::check(root),
        "xtask wasm --check" => wasm::check(root),
        "xtask cell" => ahead.wait("cell") && cell::run(root),
        "xtask c" => ahead.wait("c") && c_library::run(root),
        "xtask studio" => concurrent.finish("studio").unwrap_or_else(|| studio::run(root)),
        "xtask page" => concurrent.finish(PAGE_BROWSE).unwrap_or_else(|| page::browse(root)),
        "xtask python" => concurrent.finish("python").unwrap_or_else(|| python::run(root)),
        line if line.starts_with(EXAMPLE) => run_example(&line[EXAMPLE.len()..], root),
        _ => run_cargo(step, root),
    })
}

/// The steps in order, for the given names of examples.
fn steps(examples: &[String]) -> Vec<Step> {
    let mut steps = vec![
        Step::new("fmt --all --check", "run `cargo fmt --all`"),
        Step::new("xtask tidy", "correct each line listed above"),
        Step::new(
            "xtask deps",
            "drop the import, or move the code to the ring it belongs to (ARCHITECTURE.md)",
        ),
        Step::new("xtask circles", "move the item that both files need to a file of its own"),
        Step::new(
            "xtask words",
            "write the field's term (NOTATION.md), or list an exception with its reason in xtask/words.toml",
        ),
        Step::new(
            "xtask wasm --check",
            "run `cargo xtask wasm` and commit crates/jointplay-wasm/js; if its numbers differ, see crates/jointplay-wasm/tests/native.rs",
        ),
        Step::new(
            CLIPPY,
            "correct what clippy names above; much of it `cargo clippy --fix --workspace --all-targets --all-features` does",
        ),
        Step::new(
            DEFAULT_FEATURES,
            "put what only a feature needs under its `#[cfg(feature = …)]`, and correct what clippy names above",
        ),
    ];
    let docs = Step::new(DOC, "correct the doc comments that rustdoc names above");
    steps.push(Step { environment: Some(("RUSTDOCFLAGS", "-D warnings")), ..docs });
    steps.push(Step::new(
        "xtask interface",
        "if the change is wanted, run `cargo xtask interface --update`, and name it in CHANGELOG.md",
    ));
    steps.push(Step::new(
        "xtask package",
        "add what is missing to `include` in the crate's manifest, or move it into the crate's folder",
    ));
    let tests = Step::new(
        "test --workspace --all-features",
        "run the failing test alone: `cargo test -p CRATE NAME`; after a wanted change of snapshots, `INSTA_UPDATE=always cargo test` and read the difference",
    );
    steps.push(Step { environment: Some(SAME_CASES), ..tests });
    for name in examples {
        let cure = format!("correct crates/jointplay/examples/{name}.rs");
        steps.push(Step::new(&format!("{EXAMPLE}{name}"), cure));
    }
    steps.push(Step::new(
        "xtask embedded --check",
        "use only what `core` has in the parts of jointplay-core that need no `std`, or put it under `#[cfg(feature = \"std\")]`",
    ));
    steps.push(Step::new("xtask book", "correct the formula or link listed above"));
    steps.push(Step::new(
        "xtask cell",
        "run `jointplay cell export --to …` with the kind that failed, and the reader named above",
    ));
    steps.push(Step::new(
        "xtask c",
        "run the command that failed; see docs/how-to/c.md for the programs and their flags",
    ));
    steps.push(Step::new(
        "xtask studio",
        "send the request that failed by the `curl` line shown, to `jointplay studio`",
    ));
    steps.push(Step::new(
        "xtask page",
        "run the failing test alone, see CONTRIBUTING.md, \"The studio's page\"",
    ));
    steps.push(Step::new(
        "xtask python",
        "run the failing test alone, see CONTRIBUTING.md, \"Python\"",
    ));
    steps
}

/// Names of the files `crates/jointplay/examples/*.rs`, in order.
fn examples(root: &Path) -> io::Result<Vec<String>> {
    let folder = root.join(EXAMPLES);
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut names = Vec::new();
    for entry in folder.read_dir()? {
        let path = entry?.path();
        if path.extension().is_some_and(|end| end == "rs") {
            names.extend(path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
        }
    }
    names.sort();
    Ok(names)
}

/// Announces and runs each step until one fails; true if none did.
fn run_steps(steps: &[Step], mut run: impl FnMut(&Step) -> bool) -> bool {
    let start = Instant::now();
    for (i, step) in steps.iter().enumerate() {
        println!("\n=== {}/{}  {}", i + 1, steps.len(), step.command_line());
        let step_start = Instant::now();
        let passed = run(step);
        let time = seconds(step_start.elapsed());
        if !passed {
            println!("=== FAILED after {time}: {}", step.command_line());
            println!("=== cure: {}", step.cure);
            return false;
        }
        println!("=== passed in {time}");
    }
    println!("\n=== all {} steps passed in {}", steps.len(), seconds(start.elapsed()));
    true
}

fn seconds(time: Duration) -> String {
    format!("{:.1} s", time.as_secs_f64())
}

/// A step's cargo, not yet started.
fn cargo(step: &Step, root: &Path) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(&step.arguments).current_dir(root).envs(step.environment);
    if std::env::var_os("CARGO_TERM_COLOR").is_none() {
        let unwanted = std::env::var_os("NO_COLOR").is_some();
        command.env("CARGO_TERM_COLOR", color(io::stderr().is_terminal(), unwanted));
    }
    command
}

/// Runs a step's cargo with our own input and output; true if it succeeded.
fn run_cargo(step: &Step, root: &Path) -> bool {
    match cargo(step, root).status() {
        Ok(status) => status.success(),
        Err(error) => {
            eprintln!("cannot start cargo: {error}");
            false
        }
    }
}

/// Runs an example as the tests have built it: alone, it would be built again with the features that it needs.
fn run_example(name: &str, root: &Path) -> bool {
    let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    let name = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    let built = root.join(target).join("debug").join("examples").join(name);
    match Command::new(&built).current_dir(root).status() {
        Ok(status) => status.success(),
        Err(error) => {
            eprintln!("cannot start {}: {error}", built.display());
            false
        }
    }
}

/// Colours on a terminal, none in log files or where `NO_COLOR` asks for none.
fn color(is_terminal: bool, unwanted: bool) -> &'static str {
    if is_terminal && !unwanted { "always" } else { "never" }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(examples: &[&str]) -> Vec<String> {
        let names: Vec<String> = examples.iter().map(|name| (*name).to_owned()).collect();
        steps(&names).iter().map(Step::command_line).collect()
    }

    #[test]
    fn every_step_is_there() {
        let expect = [
            "cargo fmt --all --check",
            "cargo xtask tidy",
            "cargo xtask deps",
            "cargo xtask circles",
            "cargo xtask words",
            "cargo xtask wasm --check",
            "cargo clippy --workspace --all-targets --all-features -- -D warnings",
            "cargo clippy -p jointplay-cli --bins -- -D warnings",
            &format!("RUSTDOCFLAGS=\"-D warnings\" cargo {DOC}"),
            "cargo xtask interface",
            "cargo xtask package",
            "PROPTEST_RNG_SEED=\"1\" cargo test --workspace --all-features",
            "cargo run -p jointplay --example 01_a",
            "cargo xtask embedded --check",
            "cargo xtask book",
            "cargo xtask cell",
            "cargo xtask c",
            "cargo xtask studio",
            "cargo xtask page",
            "cargo xtask python",
        ];
        assert_eq!(lines(&["01_a"]), expect);
        assert_eq!(lines(&[]).len(), expect.len() - 1);
    }

    #[test]
    fn the_first_failure_is_the_last_step() {
        let mut seen = Vec::new();
        let passed = run_steps(&steps(&[]), |step| {
            seen.push(step.command_line());
            !step.arguments.contains(&"deps".to_owned())
        });
        assert!(!passed);
        assert_eq!(seen, &lines(&[])[..3]);
        assert!(run_steps(&steps(&[]), |_| true));
    }

    #[test]
    fn examples_are_found_in_order() {
        let root = std::env::temp_dir().join(format!("xtask-examples-{}", std::process::id()));
        assert_eq!(examples(&root).unwrap(), Vec::<String>::new());
        std::fs::create_dir_all(root.join(EXAMPLES)).unwrap();
        for name in ["02_b.rs", "01_a.rs", "notes.md"] {
            std::fs::write(root.join(EXAMPLES).join(name), "").unwrap();
        }
        let found = examples(&root).unwrap();
        std::fs::remove_dir_all(&root).unwrap();
        assert_eq!(found, ["01_a", "02_b"]);
    }

    #[test]
    fn colours() {
        assert_eq!(color(true, false), "always");
        assert_eq!(color(true, true), "never");
        assert_eq!(color(false, false), "never");
    }
}
