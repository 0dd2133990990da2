//! Sizes and widths of text, and its writing in XML.

/// Size of the title of a figure (px).
pub(crate) const TITLE: f64 = 15.0;
/// Size of axis labels and panel captions (px).
pub(crate) const LABEL: f64 = 13.0;
/// Size of tick labels, legend entries, markers and labels at points (px).
pub(crate) const TICK: f64 = 12.0;

/// From line to line of a text, as a multiple of its size.
pub(crate) const LEADING: f64 = 1.25;
/// From the middle of capitals and digits down to their base line, as a multiple of the size.
pub(crate) const HALF_CAPITAL: f64 = 0.36;

/// Font families, the embedded one first; the second has nearly the same widths.
pub(crate) const FAMILIES: &str = "'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif";

/// Advance widths of the characters from space to tilde in DejaVu Sans [em/2048].
#[rustfmt::skip]
const ADVANCES: [u16; 95] = [
    651, 821, 942, 1716, 1303, 1946, 1597, 563, 799, 799, 1024, 1716,
    651, 739, 651, 690, 1303, 1303, 1303, 1303, 1303, 1303, 1303, 1303,
    1303, 1303, 690, 690, 1716, 1716, 1716, 1087, 2048, 1401, 1405, 1430,
    1577, 1294, 1178, 1587, 1540, 604, 604, 1343, 1141, 1767, 1532, 1612,
    1235, 1612, 1423, 1300, 1251, 1499, 1401, 2025, 1403, 1251, 1403, 799,
    690, 799, 1716, 1024, 1024, 1255, 1300, 1126, 1300, 1260, 721, 1300,
    1298, 569, 569, 1186, 569, 1995, 1298, 1253, 1300, 1300, 842, 1067,
    803, 1298, 1212, 1675, 1212, 1212, 1075, 1303, 690, 1303, 1716,
];

/// Width of `text` set in DejaVu Sans at `size` (px), exact for ASCII and the signs of tick labels (px).
///
/// A formula between two `$` has about the width of its signs.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    if text.matches('$').count() >= 2 {
        return width(&signs(text), size);
    }
    text.chars().map(|letter| f64::from(advance(letter))).sum::<f64>() * size / 2048.0
}

/// Text with one letter in place of each command of its formulas, and without their marks.
fn signs(text: &str) -> String {
    let parts = text.split('$').enumerate().map(|(k, part)| {
        if k % 2 == 0 {
            return part.to_owned();
        }
        let mut found = String::new();
        let mut letters = part.chars().peekable();
        while let Some(letter) = letters.next() {
            match letter {
                '\\' => {
                    found.push('n');
                    while letters.next_if(char::is_ascii_alphabetic).is_some() {}
                }
                '{' | '}' | '_' | '^' => {}
                other => found.push(other),
            }
        }
        found
    });
    parts.collect()
}

/// Advance width of a character [em/2048].
fn advance(letter: char) -> u16 {
    match letter {
        ' '..='~' => ADVANCES[letter as usize - ' ' as usize],
        '−' | '×' | '≤' | '≥' => 1716,
        '⁰'..='⁹' | '¹' | '²' | '³' => 821,
        '⁻' => 1081,
        '·' => 651,
        '°' => 1024,
        'α'..='ω' | 'µ' => 1303,
        // Combining accents take no room of their own.
        '\u{300}'..='\u{36f}' => 0,
        // Scripts of which every sign fills a square.
        '\u{1100}'..='\u{11ff}' | '\u{2e80}'..='\u{ffff}' => 2048,
        _ => 1400,
    }
}

/// `text` in lines no wider than `room` (px) at `size` (px), broken at spaces; a longer word keeps its own line.
pub(crate) fn wrap(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(line, size) + width(" ", size) + width(word, size) <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_string()),
        }
    }
    lines
}

/// `text` escaped for an element or a quoted attribute of XML, with line breaks and tabs as references.
///
/// Characters that XML cannot represent are replaced by U+FFFD.
pub fn escape_xml(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push_str("&#10;"),
            '\t' => escaped.push_str("&#9;"),
            '\r' => escaped.push_str("&#13;"),
            // XML cannot represent these.
            '\0'..='\x1f' | '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            _ => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fit_their_room() {
        let lines = wrap("the quick brown fox jumps over the lazy dog", 12.0, 100.0);
        assert!(lines.len() > 2 && lines.iter().all(|line| width(line, 12.0) <= 100.0));
        assert_eq!(lines.join(" "), "the quick brown fox jumps over the lazy dog");
        assert!(wrap("  ", 12.0, 100.0).is_empty());
    }

    #[test]
    fn formulas_are_as_wide_as_their_signs() {
        assert_eq!(width("$\\theta_{12}$ (°)", 12.0), width("n12 (°)", 12.0));
        assert!(width("5 $", 12.0) > width("5 ", 12.0));
    }

    #[test]
    fn escapes() {
        assert_eq!(escape_xml("a<b & \"c\"\0\n"), "a&lt;b &amp; &quot;c&quot;\u{fffd}&#10;");
    }
}
