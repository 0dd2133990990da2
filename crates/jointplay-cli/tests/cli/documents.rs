//! The documents keep their word: every command that they show runs.

use crate::sandbox::Sandbox;

/// Commands of a document: fenced lines and code spans that start with the program's name, without comments.
pub(crate) fn commands(text: &str) -> Vec<String> {
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
    let plans = ["cell check", "cell run", "cell export"].iter().any(|one| line.starts_with(one));
    let bare = line.strip_suffix(" example").unwrap_or(line);
    if plans { format!("{bare} example one.program") } else { line.to_owned() }
}

/// A folder with the files that the examples of `import` name.
fn sandbox_with_a_model() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("one.program", crate::cell::SMALL);
    sandbox.write("robot.urdf", crate::import::URDF);
    sandbox.write("loops.toml", crate::import::LOOPS);
    sandbox.write("my-study.toml", crate::study::SMALL);
    sandbox
}

#[test]
fn every_command_that_a_document_shows_runs() {
    let documents = [
        include_str!("../../../../README.md"),
        include_str!("../../../../docs/explanation/paper-to-code.md"),
        include_str!("../../../../docs/reference/catalogue.md"),
        include_str!("../../../../docs/reference/study-files.md"),
        include_str!("../../../../docs/reference/command.md"),
        include_str!("../../../../docs/reference/exports.md"),
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
        "draw",
        "catalogue",
        "import",
        "cell",
        "cell check",
        "cell run",
        "cell export",
        "cell teach",
        "cell format",
        "cell example",
    ] {
        let help = helper.done(&format!("{command} --help"));
        let (_, examples) = help.split_once("Examples:").expect("every command has examples");
        for line in examples.lines().map(str::trim) {
            let Some(line) = line.strip_prefix("jointplay ") else { continue };
            // Text after two spaces explains the line.
            let line = line.split("  ").next().unwrap();
            let line = line.split(" > ").next().unwrap();
            let sandbox = sandbox_with_a_model();
            let run = sandbox.run(&quick(line));
            assert_eq!(run.code, 0, "{line}: {}", run.stderr);
        }
    }
}

#[test]
fn the_reference_of_cell_files_reports_its_faults_as_shown() {
    let page = include_str!("../../../../docs/reference/cell-files.md");
    let (_, part) = page.split_once("## Break it, and mend it").unwrap();
    let (part, _) = part.split_once("\n## ").unwrap();
    let sandbox = Sandbox::new();
    let shown: Vec<&str> =
        part.lines().filter_map(|line| line.strip_prefix("jointplay ")).collect();
    let shown: Vec<&str> =
        shown.iter().map(|line| line.split('#').next().unwrap().trim()).collect();
    for line in &shown {
        sandbox.done(line);
    }
    let check = shown.last().unwrap();
    let files: Vec<(String, String)> = sandbox
        .names("my-cell")
        .into_iter()
        .map(|name| format!("my-cell/{name}"))
        .map(|name| (sandbox.read(&name), name))
        .map(|(text, name)| (name, text))
        .collect();
    assert_eq!(files.len(), 3);
    let rows = part.lines().filter(|line| line.contains(" → ") && line.contains('`'));
    let mut broken = 0;
    for row in rows {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let spans = |cell: &'static str| cell.split('`').skip(1).step_by(2);
        let changes: Vec<&str> = spans(cells[2]).collect();
        let mut texts = files.clone();
        for change in changes.chunks(2) {
            let (_, text) = texts.iter_mut().find(|(_, text)| text.contains(change[0])).unwrap();
            *text = text.replace(change[0], change[1]);
        }
        for (name, text) in &texts {
            sandbox.write(name, text);
        }
        let run = sandbox.run(check);
        assert_ne!(run.code, 0, "{row}");
        let output = run.stdout + &run.stderr;
        for words in spans(cells[3]) {
            assert!(output.contains(words), "{words}: {output:.2000}");
        }
        broken += 1;
    }
    assert_eq!(broken, 4);
}
