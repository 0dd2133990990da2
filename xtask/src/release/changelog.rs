//! Whether the changelog has a dated section of the version.

/// Advice on the changelog before the version is tagged; `None` if its changes have a date and no others follow.
pub(super) fn remark(changelog: &str, version: &str) -> Option<String> {
    let heading = format!("## {version} – ");
    let mut sections = changelog.lines().filter(|line| line.starts_with("## "));
    match sections.next() {
        Some(first) if first.strip_prefix(&heading).is_some_and(is_date) => None,
        Some(first) => Some(format!(
            "CHANGELOG.md begins with {first:?}: before the version is tagged, this has to be \"{heading}\" and the date"
        )),
        None => Some("CHANGELOG.md has no section".to_owned()),
    }
}

/// Whether a text is a date such as 2026-01-31.
fn is_date(text: &str) -> bool {
    let parts: Vec<&str> = text.split('-').collect();
    let is_number = |part: &&str| part.bytes().all(|byte| byte.is_ascii_digit());
    parts.iter().all(is_number) && parts.iter().map(|part| part.len()).eq([4, 2, 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_without_a_date_are_reported() {
        assert_eq!(remark("# Changelog\n\n## 0.1.0 – 2026-01-31\n", "0.1.0"), None);
        for text in ["# Changelog\n", "## Unreleased\n\n## 0.1.0 – 2026-01-31\n"] {
            assert!(remark(text, "0.1.0").is_some(), "{text}");
        }
        for heading in ["## 0.1.0", "## 0.1.0 – soon", "## 0.2.0 – 2026-01-31"] {
            assert!(remark(heading, "0.1.0").is_some_and(|text| text.contains(heading)));
        }
    }
}
