//! Line ends of changed texts: `toml_edit` writes `\n` at the end of each line, and no byte order mark.

/// A changed text with the line ends and the byte order mark of the text before the change.
///
/// Line ends that differ from line to line become `\n`.
pub(crate) fn as_before(changed: String, before: &str) -> String {
    const MARK: char = '\u{feff}';
    let lines = before.matches('\n').count();
    let is_crlf = lines > 0 && before.matches("\r\n").count() == lines;
    let mut text =
        if is_crlf { changed.replace("\r\n", "\n").replace('\n', "\r\n") } else { changed };
    if before.starts_with(MARK) && !text.starts_with(MARK) {
        text.insert(0, MARK);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::as_before;

    #[test]
    fn changed_texts_have_the_line_ends_of_the_text_before() {
        for (changed, before, expected) in [
            ("a = 2\nb = 1\n", "a = 1\r\nb = 1\r\n", "a = 2\r\nb = 1\r\n"),
            ("a = 1\r\nb = 2\n", "a = 1\r\n", "a = 1\r\nb = 2\r\n"),
            ("a = 2\n", "\u{feff}a = 1\r\n", "\u{feff}a = 2\r\n"),
            ("a = 2\n", "a = 1\n", "a = 2\n"),
            ("a = 2\n", "a = 1", "a = 2\n"),
            ("a = 2\nb = 1\n", "a = 1\r\nb = 1\n", "a = 2\nb = 1\n"),
        ] {
            assert_eq!(as_before(changed.to_owned(), before), expected);
        }
    }
}
