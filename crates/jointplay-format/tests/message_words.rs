//! Values with which files are mutated, and the words that messages about them may have; shared by the tests of several crates.

/// Values in place of those of a file.
pub(crate) const VALUES: [&str; 28] = [
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

/// The first word of a message that only a programmer of Rust knows, or an endless number.
///
/// # Arguments
/// * `value` – the value that the message may quote
pub(crate) fn check(message: &str, value: &str) -> Result<(), String> {
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
