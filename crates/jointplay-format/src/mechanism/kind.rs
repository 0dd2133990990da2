//! The kind of a file.

use serde::Deserialize;

/// The `kind` that a file says it is, such as `gpr` or `mechanism`; also where the rest of it is malformed.
#[must_use]
pub fn kind_of(text: &str) -> Option<String> {
    #[derive(Deserialize)]
    struct Kind {
        kind: String,
    }
    let kind = |text: &str| toml::from_str(text).ok().map(|Kind { kind }| kind);
    kind(text).or_else(|| {
        let mut top = text.lines().take_while(|line| !line.trim_start().starts_with('['));
        top.find_map(kind)
    })
}
