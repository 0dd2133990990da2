//! A page of the book, followed as a reader follows it: files are saved and changed, commands run, outputs compared.
//!
//! | block | is |
//! | --- | --- |
//! | `sh` | commands, run in order; a comment `exit code 1` names the exit code that is expected |
//! | `text` directly below it | the whole output of the last of these commands; where a line is `…`, the parts around it |
//! | any other below a line that starts with "Save this as `NAME`" or "Add this to `NAME`" | a file, or its end |
//! | `diff` below a line that names a file in code marks | lines of this file that are replaced |
//!
//! `INSTA_UPDATE=always` writes the present outputs into the page, but for those with a `…`.

use std::path::Path;

use crate::sandbox::Sandbox;

/// Follows the page and returns how many commands it has run.
pub(crate) fn check(path: &Path, sandbox: &Sandbox) -> usize {
    let text = std::fs::read_to_string(path).unwrap();
    let name = path.file_name().unwrap().to_string_lossy();
    let mut written = String::new();
    let mut output: Option<String> = None;
    let mut count = 0;
    for (i, part) in text.split("```").enumerate() {
        if i % 2 == 0 {
            if !part.trim().is_empty() {
                output = None;
            }
            written += part;
            continue;
        }
        let (kind, body) = part.split_once('\n').unwrap_or((part, ""));
        let mut shown = part.to_owned();
        match kind {
            "sh" => {
                for line in body.lines().filter_map(|line| line.strip_prefix("jointplay ")) {
                    if let Some(printed) = run(sandbox, line, &name) {
                        output = Some(printed);
                        count += 1;
                    }
                }
            }
            "text" => {
                if let Some(printed) = output.take() {
                    if std::env::var_os("INSTA_UPDATE").is_some_and(|how| how == "always")
                        && !body.lines().any(|line| line == "…")
                    {
                        shown = format!("text\n{printed}");
                    } else {
                        compare(body, &printed, &name);
                    }
                }
            }
            _ => save(sandbox, kind, body, written.trim_end().lines().last().unwrap_or_default()),
        }
        written += &format!("```{shown}```");
    }
    if written != text {
        std::fs::write(path, written).unwrap();
    }
    count
}

/// Runs a command and returns all that it prints; nothing where it cannot run here.
fn run(sandbox: &Sandbox, line: &str, page: &str) -> Option<String> {
    let (line, comment) = line.split_once(" #").unwrap_or((line, ""));
    let (line, file) =
        line.split_once(" > ").map_or((line, None), |(line, file)| (line, Some(file)));
    let line = line.trim();
    // The studio and the controller serve until they are ended, completions are for some shell, and words in capitals are placeholders.
    let is_placeholder =
        |word: &str| word.len() > 2 && word.chars().all(|c| c.is_ascii_uppercase());
    if line.starts_with("studio")
        || line.starts_with("cell serve")
        || line.starts_with("completions")
        || line.split(' ').any(is_placeholder)
    {
        return None;
    }
    let run = sandbox.run(&quick(line));
    let expected =
        comment.split_once("exit code ").map_or(0, |(_, code)| code.trim().parse().unwrap());
    assert_eq!(run.code, expected, "{page}: {line}: {}", run.stderr);
    if let Some(file) = file {
        sandbox.write(file.trim(), &run.stdout);
    }
    Some(run.stdout + &run.stderr)
}

/// A command as it is run here: exports, figures and searches of the example's lot of 25 wafers take a program of one unless they name a program, all else is the same.
pub(crate) fn quick(line: &str) -> String {
    let long = ["cell run", "cell export", "cell optimise"];
    let names_a_program = line.split(' ').any(|word| word.ends_with(".program"));
    if names_a_program || !long.iter().any(|command| line.starts_with(command)) {
        return line.to_owned();
    }
    let names_a_cell = line.split(' ').any(|word| word.ends_with(".toml"));
    format!("{line} {}one.program", if names_a_cell { "" } else { "example " })
}

/// Compares an output with the one shown; numbers that are zero but for round-off differ from machine to machine.
fn compare(shown: &str, printed: &str, page: &str) {
    let rounded = |text: &str| {
        let words = text.split_inclusive([' ', '\n']).map(|word| {
            let number = word.trim().parse::<f64>();
            let is_round_off = number.is_ok_and(|number| number.abs() < 1e-9);
            if is_round_off { "0" } else { word.trim_end() }
        });
        words.filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ")
    };
    let printed = rounded(printed);
    let mut rest = printed.as_str();
    let parts: Vec<String> = shown.split("…\n").map(rounded).collect();
    if let [all] = &parts[..] {
        assert_eq!(
            all, &printed,
            "{page}: run the tests with INSTA_UPDATE=always, and read the difference"
        );
    }
    for part in parts {
        let at =
            rest.find(&part).unwrap_or_else(|| panic!("{page}: {part:?} is not in {rest:.3000}"));
        rest = &rest[at + part.len()..];
    }
}

/// Saves or changes the file that the line before a block names.
fn save(sandbox: &Sandbox, kind: &str, body: &str, line: &str) {
    let Some(name) = line.split('`').nth(1) else { return };
    if line.starts_with("Save this as ") {
        sandbox.write(name, body);
    } else if line.starts_with("Add this to ") {
        sandbox.write(name, &(sandbox.read(name) + "\n" + body));
    } else if kind == "diff" {
        let mut text = sandbox.read(name);
        let changed = |sign: char| {
            let lines = body.lines().filter_map(|line| line.strip_prefix(sign));
            lines.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect::<Vec<_>>()
        };
        let (removed, mut added) = (changed('-'), changed('+'));
        // More lines than before follow the last one that is replaced.
        let further = added.split_off(removed.len().min(added.len()));
        for (index, (from, to)) in removed.iter().zip(added).enumerate() {
            assert!(text.contains(from), "{from} is not in {name}");
            let mut lines = vec![to];
            if index + 1 == removed.len() {
                lines.extend(&further);
            }
            text = text.replacen(from, &lines.join("\n"), 1);
        }
        sandbox.write(name, &text);
    }
}
