//! Messages of all readers over mutated values: no words of Rust, no endless numbers, no `NaN`.

use jointplay_format::{catalogue, cell, mechanism, robot, study};

use crate::message_words::{VALUES, check};

/// A reader: the message that it answers with, if it refuses the text.
type Read = fn(&str) -> Option<String>;

/// One file of every kind, with its reader.
fn files() -> Vec<(&'static str, String, Read)> {
    fn all(problems: cell::Errors) -> String {
        problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    }
    let mechanism: Read = |text| mechanism::parse(text).err().map(|error| error.to_string());
    let of_catalogue = |name| catalogue::find(name).unwrap().text.to_owned();
    let study_reader: Read =
        |text| study::parse(text, &mut study::included).err().map(|error| error.to_string());
    let mut files: Vec<(&'static str, String, Read)> = vec![
        ("robot", robot::PAPER.to_owned(), |text| robot::parse(text).err().map(|e| e.to_string())),
        ("mechanism", include_str!("../src/mechanism/sample.toml").to_owned(), mechanism),
        ("catalogue", of_catalogue("gpr-mechanism"), mechanism),
        ("arms", of_catalogue("dual-arm"), |text| cell::robot::parse(text).err().map(all)),
        ("cell", cell::EXAMPLE.to_owned(), |text| {
            cell::read(text, &mut |_| Err("no files".to_owned())).err().map(all)
        }),
        ("loops", LOOPS.to_owned(), |text| {
            let chain = mechanism::parse(CHAIN).unwrap().mechanism;
            mechanism::with_loops(&chain, text).err().map(|error| error.to_string())
        }),
    ];
    files.extend(study::examples().iter().map(|one| ("study", one.text.to_owned(), study_reader)));
    files
}

const CHAIN: &str = r#"kind = "mechanism"
name = "pair"
units = { length = "mm", angle = "deg" }
base = "base"
[[joint]]
name = "a"
kind = "revolute"
links = ["base", "left"]
point = [0, 0, 0]
axis = [0, 0, 1]
[[joint]]
name = "b"
kind = "revolute"
links = ["base", "right"]
point = [0, 0, 0]
axis = [0, 0, 1]
"#;

const LOOPS: &str = r#"kind = "loops"
units = { length = "mm", angle = "deg" }
[[joint]]
name = "tips"
kind = "spherical"
links = ["left", "right"]
in = "left"
point = [0, 0, 100]
"#;

#[test]
fn messages_over_mutated_values_use_the_words_of_the_field() {
    let mut refused = 0;
    let mut violations = Vec::new();
    for (kind, text, read) in files() {
        let lines: Vec<&str> = text.lines().collect();
        for (number, line) in lines.iter().enumerate() {
            let Some((key, _)) = line.split_once(" = ").filter(|_| !line.starts_with('#')) else {
                continue;
            };
            // A seventh of the values for each line of a long file, which is slow to read.
            let step = if lines.len() > 60 { 7 } else { 1 };
            for value in VALUES.into_iter().skip(number % step).step_by(step) {
                let changed = format!("{key} = {value}");
                let mut lines = lines.clone();
                lines[number] = &changed;
                let Some(message) = read(&lines.join("\n")) else { continue };
                refused += 1;
                if let Err(word) = check(&message, value) {
                    violations.push(format!("{kind}: {changed}: {word:?} in {message}"));
                }
            }
        }
    }
    assert!(
        violations.is_empty(),
        "{}:\n{}",
        violations.len(),
        violations[..violations.len().min(20)].join("\n")
    );
    assert!(refused > 1000, "{refused}");
}

#[test]
fn after_an_error_of_syntax_nothing_else_is_reported_of_a_cell() {
    let read = |text: &str| cell::read(text, &mut |_| Err("no files".to_owned())).unwrap_err();
    let lines: Vec<&str> = cell::EXAMPLE.lines().collect();
    for number in (0..lines.len()).filter(|&number| lines[number].matches('"').count() > 1) {
        // One quote is missing.
        let cut = lines[number].rfind('"').unwrap();
        let mut changed = lines.clone();
        let line = format!("{}{}", &lines[number][..cut], &lines[number][cut + 1..]);
        changed[number] = &line;
        if lines[number].trim_start().starts_with('#') {
            continue;
        }
        let problems = read(&changed.join("\n"));
        assert_eq!(problems.len(), 1, "{line}: {problems:?}");
        assert_eq!(problems[0].place.line, number + 1, "{line}: {}", problems[0]);
    }
}

/// An expression that does not start as one has this message, which once was taken for one of the library for TOML.
#[test]
fn a_brace_in_an_expression_is_reported_with_what_may_be_there() {
    let mut found = 0;
    for (kind, text, read) in files() {
        let changed = text.replacen("point = [0", "point = [\"{\"", 1);
        let message = if changed == text { String::new() } else { read(&changed).unwrap() };
        if message.contains("parenthesis") {
            let expected = "expected a number, a name or a parenthesis, found `{`";
            assert!(message.contains(expected), "{kind}: {message}");
            found += 1;
        }
    }
    assert!(found > 0);
}

/// Phrases of the library that parses TOML into types.
const PHRASES: [&str; 6] =
    ["invalid type", "invalid value", "missing field", "unknown field", "at line", ", expected a "];

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(400))]

    #[test]
    fn mutated_files_are_refused_in_the_words_of_the_field(
        file in 0..100_usize,
        cuts in proptest::collection::vec(
            (0.0..1.0, 0..30_usize, "[-\\[\\]\"={},.0-9a\n ]{0,3}|1979-05-27|nan|true"), 1..4
        ),
    ) {
        let mut files = files();
        let (kind, mut text, read) = files.swap_remove(file % files.len());
        for (part, length, replacement) in cuts {
            let start = text.floor_char_boundary((part * text.len() as f64) as usize);
            let end = text.floor_char_boundary((start + length).min(text.len()));
            text.replace_range(start..end, &replacement);
        }
        if let Some(message) = read(&text) {
            proptest::prop_assert!(!message.is_empty(), "{kind}");
            // Syntax errors are in the words of TOML.
            let is_about_syntax = toml::de::DeTable::parse(&text).is_err();
            let phrase = PHRASES.iter().find(|phrase| message.contains(**phrase));
            proptest::prop_assert!(is_about_syntax || phrase.is_none(), "{kind}: {message}");
        }
    }

    #[test]
    fn unknown_keys_of_two_tables_are_both_reported(
        file in 0..100_usize, one in 0..1000_usize, other in 0..1000_usize,
    ) {
        let mut files = files();
        let (kind, text, read) = files.swap_remove(file % files.len());
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let is_header = |line: &String| line.starts_with('[') && line != "[parameters]";
        let headers: Vec<usize> = (0..lines.len()).filter(|&k| is_header(&lines[k])).collect();
        if headers.len() < 2 {
            return Ok(());
        }
        let (one, other) = (one % headers.len(), other % headers.len());
        for (index, key) in [(one, "unknown_one = 1"), (other, "unknown_other = 1")] {
            lines[headers[index]] += "\n";
            lines[headers[index]] += key;
        }
        let message = read(&lines.join("\n")).unwrap_or_default();
        for key in ["`unknown_one`", "`unknown_other`"] {
            proptest::prop_assert!(message.contains(key), "{kind}: {message}");
        }
    }

    #[test]
    fn invalid_values_of_two_keys_are_both_reported(one in 0..1000_usize, other in 0..1000_usize) {
        let text = include_str!("../src/mechanism/sample.toml");
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        // A date is invalid for every key.
        let is_key = |line: &String| line.contains(" = ") && !line.starts_with(' ');
        let keys: Vec<usize> = (0..lines.len()).filter(|&k| is_key(&lines[k])).collect();
        let chosen = [keys[one % keys.len()], keys[other % keys.len()]];
        for line in chosen {
            let key = lines[line].split(" = ").next().unwrap_or_default().to_owned();
            // `frames` has several lines.
            if key == "frames" || key == "kind" && line == 0 {
                return Ok(());
            }
            lines[line] = format!("{key} = 1979-05-27");
        }
        let errors = mechanism::parse(&lines.join("\n")).unwrap_err();
        for line in chosen {
            let is_reported = errors.iter().any(|error| error.place.line == line + 1);
            proptest::prop_assert!(is_reported, "line {}: {errors}", line + 1);
        }
    }
}

#[test]
fn long_lists_of_errors_are_cut_and_counted() {
    let extra: String = (0..70).map(|number| format!("unknown_{number} = 1\n")).collect();
    let text = format!("{extra}{}", cell::EXAMPLE);
    let problems = cell::read(&text, &mut |_| Err("no files".to_owned())).unwrap_err();
    assert_eq!(problems.len(), 21);
    assert_eq!(problems[20].to_string(), "50 more errors from here on");
}
