//! Messages of the reader of dialects over mutated values: no words of Rust, no endless numbers, no `NaN`.

use jointplay_interop::export::dialect::{DIALECTS, Dialect};

const VALUES: [&str; 28] = [
    "1e308",
    "-1e308",
    "5e-324",
    "1e-17",
    "nan",
    "-inf",
    "-1",
    "0",
    "1.0000000000000002",
    "9223372036854775807",
    "99999999999999999999999999999999999999999999",
    "true",
    "\"\"",
    "\"x\"",
    "\"9e999\"",
    "[]",
    "[1]",
    "[1e308, 1e308, 1e308]",
    "[nan, 1, 2]",
    "[[]]",
    "{}",
    "{ a = 1 }",
    "{ normal = [0, 1e308] }",
    "{ uniform = [-1e308, 1e308] }",
    "1979-05-27T07:32:00Z",
    "07:32:00",
    "{ length = 1979-05-27, angle = 3 }",
    "\"1979\\u001b\"",
];

/// Words that only a programmer of Rust knows.
const RUST: [&str; 24] = [
    "usize",
    "isize",
    "u8",
    "u16",
    "u32",
    "u64",
    "u128",
    "i8",
    "i16",
    "i32",
    "i64",
    "i128",
    "f32",
    "f64",
    "sequence",
    "map",
    "struct",
    "tuple",
    "serde",
    "toml_private",
    "variant",
    "NaN",
    "inf",
    "None",
];

fn check(message: &str, value: &str) -> Result<(), String> {
    // Messages may quote the file.
    let message = message.replace(value.trim_matches('"'), "");
    let words = message.split(|letter: char| !letter.is_ascii_alphanumeric() && letter != '_');
    for word in words {
        let is_long = word.len() > 17 && word.chars().all(|letter| letter.is_ascii_digit());
        if is_long || RUST.contains(&word) || word.starts_with("__") {
            return Err(word.to_owned());
        }
    }
    Ok(())
}

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
