//! Messages of the reader of dialects over mutated values: no words of Rust, no endless numbers, no `NaN`.

use jointplay_interop::export::dialect::{DIALECTS, Dialect};

use crate::message_words::{VALUES, check};

#[test]
fn messages_over_mutated_values_use_the_words_of_the_field() {
    let (mut refused, mut violations) = (0, Vec::new());
    let lines: Vec<&str> = DIALECTS[0].text.lines().collect();
    for (number, line) in lines.iter().enumerate() {
        let Some((key, _)) = line.split_once(" = ").filter(|_| !line.starts_with('#')) else {
            continue;
        };
        for value in VALUES {
            let changed = format!("{key} = {value}");
            let mut lines = lines.clone();
            lines[number] = &changed;
            let Some(error) = Dialect::parse(&lines.join("\n")).err() else { continue };
            refused += 1;
            if let Err(word) = check(&error.to_string(), value) {
                violations.push(format!("{changed}: {word:?} in {error}"));
            }
        }
    }
    assert!(violations.is_empty(), "{}:\n{}", violations.len(), violations.join("\n"));
    assert!(refused > 100, "{refused}");
}
