//! Documents and help texts: every command that they show runs, and prints the output shown.

use std::path::Path;

use crate::page;
use crate::sandbox::Sandbox;

/// Commands of a document: fenced lines and code spans that start with the program's name, without comments.
fn commands(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (i, part) in text.split("```").enumerate() {
        let pieces: Vec<&str> = if i % 2 == 1 {
            part.lines().collect()
        } else {
            part.split('`').skip(1).step_by(2).collect()
        };
        found.extend(pieces.into_iter().filter_map(|piece| piece.strip_prefix("jointplay ")));
    }
    let bare = |line: &str| line.split('#').next().unwrap_or_default().trim().to_owned();
    // Words in capitals are placeholders, completions need a shell, and the studio runs until Ctrl-C.
    let whole = |line: &String| {
        !line.starts_with("completions")
            && !line.starts_with("studio")
            && !line.split(' ').any(|word| word.chars().all(|c| c.is_ascii_uppercase()))
    };
    found.into_iter().map(bare).filter(whole).collect()
}

/// A command as it is run here: those that plan the example's lot of 25 wafers take a program of one, all else alike.
fn quick(line: &str) -> String {
    let plans = ["cell check", "cell run", "cell export", "cell optimise"]
        .iter()
        .any(|one| line.starts_with(one));
    let bare = line.strip_suffix(" example").unwrap_or(line);
    if plans { format!("{bare} example one.program") } else { line.to_owned() }
}

/// A folder with the files that the examples of `import` name.
fn sandbox_with_a_model() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write(
        "assembly.asmt",
        include_str!("../../../../validation/golden/models/slider-crank.asmt"),
    );
    let archive = include_bytes!("../../../../validation/golden/models/crank-press.FCStd");
    std::fs::write(sandbox.file("assembly.FCStd"), archive).unwrap();
    sandbox.write("one.program", crate::cell::SMALL);
    sandbox.write("robot.urdf", crate::import::URDF);
    sandbox.write("loops.toml", crate::import::LOOPS);
    sandbox.write("loop_closures.yaml", crate::import::CLOSURES);
    sandbox.write("my-study.toml", crate::study::SMALL);
    sandbox
}

#[test]
fn commands_in_code_spans_run() {
    let documents = [
        include_str!("../../../../README.md"),
        include_str!("../../../../docs/explanation/paper-to-code.md"),
        include_str!("../../../../docs/reference/catalogue.md"),
    ];
    let mut all: Vec<String> = documents.into_iter().flat_map(commands).collect();
    all.sort();
    all.dedup();
    assert!(all.len() >= 10, "{all:?}");
    for line in all {
        let sandbox = sandbox_with_a_model();
        let run = sandbox.run(&quick(&line));
        assert_eq!(run.code, 0, "{line}: {}", run.stderr);
    }
}

#[test]
fn commands_of_the_book_run_in_order_and_print_what_it_shows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut pages = vec![root.join("README.md")];
    for folder in ["docs", "docs/tutorials", "docs/how-to", "docs/reference", "docs/explanation"] {
        let entries =
            std::fs::read_dir(root.join(folder)).unwrap().map(|entry| entry.unwrap().path());
        pages.extend(entries.filter(|path| path.extension().is_some_and(|end| end == "md")));
    }
    pages.sort();
    let count: usize = pages.iter().map(|path| page::check(path, &sandbox_with_a_model())).sum();
    assert!(count > 60, "{count}");
}

#[test]
fn every_example_in_a_help_text_runs() {
    let helper = Sandbox::new();
    for command in [
        "",
        "simulate",
        "study",
        "forward",
        "inverse",
        "mobility",
        "sensitivity",
        "compare",
        "assemble",
        "move",
        "jacobian",
        "draw",
        "suggest",
        "catalogue",
        "import",
        "export",
        "cell",
        "cell check",
        "cell run",
        "cell export",
        "cell optimise",
        "cell teach",
        "cell displacement",
        "cell format",
        "cell expand",
        "cell example",
    ] {
        let help = helper.done(&format!("{command} --help"));
        let (_, examples) = help.split_once("Examples:").expect("every command has examples");
        // A reader tries the examples of a command one after the other in a folder.
        let sandbox = sandbox_with_a_model();
        for line in examples.lines().map(str::trim) {
            let Some(line) = line.strip_prefix("jointplay ") else { continue };
            // Text after two spaces explains the line.
            let line = line.split("  ").next().unwrap();
            let line = line.split(" > ").next().unwrap();
            // The controller serves until it is ended; it has tests of its own.
            if line.starts_with("cell serve") {
                continue;
            }
            let run = sandbox.run(&quick(line));
            assert_eq!(run.code, 0, "{line}: {}", run.stderr);
        }
    }
}
