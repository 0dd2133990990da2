//! The kind of a file.

use toml::de::DeTable;

/// The `kind` that a file names, such as `gpr` or `mechanism`; also found in a file with errors below it.
#[must_use]
pub fn kind_of(text: &str) -> Option<String> {
    let kind = |text: &str| {
        let document = DeTable::parse(text).ok()?;
        Some(document.get_ref().get("kind")?.get_ref().as_str()?.to_owned())
    };
    kind(text).or_else(|| {
        let mut top = text.lines().take_while(|line| !line.trim_start().starts_with('['));
        top.find_map(kind)
    })
}
