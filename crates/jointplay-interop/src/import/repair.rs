//! Texts that the parsers of simulators accept although they are not well-formed XML.

use std::ops::Range;

use jointplay_format::mechanism::MAX_BYTES;
use roxmltree::Error;

use super::xml::tree;

/// Most prefixes that a text may use without a declaration.
const MOST_PREFIXES: usize = 32;

/// A well-formed text for one that only deviates as simulators allow: hyphens in comments, a declaration that is not at the start, prefixes of elements of other tools without a declaration of their own or with two colons.
///
/// FreeCAD writes well-formed documents: longer texts than those of simulators are not repaired.
/// Lines stay where they are, and what is on them except on the line of the root element.
pub(super) fn repaired(text: &str) -> Option<String> {
    if text.len() > MAX_BYTES {
        return None;
    }
    let mut repaired = text.to_owned();
    single_colons(&mut repaired);
    blank_declaration(&mut repaired);
    blank_hyphens(&mut repaired);
    for _ in 0..MOST_PREFIXES {
        let prefix = match tree(&repaired) {
            Err(Error::UnknownNamespace(prefix, _)) => prefix,
            // Another error is reported at its place in the repaired text.
            _ => return (repaired != text).then_some(repaired),
        };
        let at = end_of_root_name(&repaired)?;
        repaired.insert_str(at, &format!(" xmlns:{prefix}=\"urn:undeclared:{prefix}\""));
    }
    None
}

/// Replaces bytes by spaces, and leaves the ends of lines.
fn blank(text: &mut String, range: Range<usize>) {
    let is_end = |c: char| c == '\n' || c == '\r';
    let blanks: String = text[range.clone()]
        .chars()
        .flat_map(|c| std::iter::repeat_n(if is_end(c) { c } else { ' ' }, c.len_utf8()))
        .collect();
    text.replace_range(range, &blanks);
}

/// A declaration `<?xml … ?>` after spaces or comments.
fn blank_declaration(text: &mut String) {
    let Some(start) = text.find("<?xml ").filter(|&start| start > 0) else { return };
    let Some(length) = text[start..].find("?>") else { return };
    let Some(root) = end_of_root_name(text) else { return };
    if start < root {
        blank(text, start..start + length + 2);
    }
}

/// Hyphens inside of comments, of which two in a row are not allowed.
fn blank_hyphens(text: &mut String) {
    let mut from = 0;
    while let Some(start) = text[from..].find("<!--").map(|at| from + at + 4) {
        let Some(end) = text[start..].find("-->").map(|at| start + at) else { return };
        let inner = text[start..end].replace('-', " ");
        text.replace_range(start..end, &inner);
        from = end + 3;
    }
}

/// Names of elements such as `gz::policy`, with an underscore in place of the second colon.
fn single_colons(text: &mut String) {
    let mut from = 0;
    while let Some(start) = text[from..].find('<').map(|at| from + at + 1) {
        let start = start + usize::from(text[start..].starts_with('/'));
        let is_end = |c: char| c.is_whitespace() || matches!(c, '>' | '/' | '<');
        let end = text[start..].find(is_end).map_or(text.len(), |length| start + length);
        if let Some(colons) = text[start..end].find("::").filter(|&length| length > 0) {
            text.replace_range(start + colons + 1..start + colons + 2, "_");
        }
        from = end;
    }
}

/// Where the attributes of the root element begin.
fn end_of_root_name(text: &str) -> Option<usize> {
    let mut at = 0;
    loop {
        at += text[at..].find('<')?;
        let rest = &text[at..];
        let skipped = if rest.starts_with("<!--") {
            rest.find("-->")? + 3
        } else if rest.starts_with("<?") {
            rest.find("?>")? + 2
        } else if rest.starts_with("<!") {
            rest.find('>')? + 1
        } else {
            let name = rest[1..].find(|c: char| c.is_whitespace() || c == '>' || c == '/')?;
            return Some(at + 1 + name);
        };
        at += skipped;
    }
}

#[cfg(test)]
mod tests {
    use roxmltree::Document;

    use super::*;
    use crate::import::{parse, testing};

    const WORLD: &str = "<?xml version=\"1.0\"?>\n<!-- a world -->\n<sdf version=\"1.9\"><model name=\"m\">\n<link name=\"a\"/><link name=\"b\"/>\n<joint name=\"j\" type=\"revolute\"><parent>a</parent><child>b</child></joint></model></sdf>";

    #[test]
    fn texts_that_simulators_accept_are_the_same_mechanism() {
        let expected = testing::read(&WORLD.replace("</joint>", "<axis/></joint>"));
        let world = WORLD.replace("</joint>", "<axis/></joint>");
        for (from, to, listed) in [
            ("<!-- a world -->", "<!-- run: gz sim --verbose -- -r ---->", ""),
            ("<?xml", "\n  <?xml", ""),
            ("<link name=\"a\"/>", "<link name=\"a\"/><drake:joint_order/>", "1 × joint_order"),
            ("<link name=\"a\"/>", "<link name=\"a\"><gz:mass/><other:mass/></link>", "2 × mass"),
            ("<link name=\"a\"/>", "<link name=\"a\"/><plugin><gz::wait>1</gz::wait></plugin>", ""),
        ] {
            let text = world.replacen(from, to, 1);
            assert!(Document::parse(&text).is_err(), "{text}");
            let read = testing::read(&text);
            assert_eq!(read.mechanism, expected.mechanism, "{text}");
            let is_listed = read.ignored.iter().any(|one| one == listed);
            assert!(listed.is_empty() || is_listed, "{:?}", read.ignored);
        }
    }

    #[test]
    fn errors_of_repaired_texts_have_their_places() {
        let text = WORLD.replace("a world", "a -- world").replace("<child>b", "<child>c");
        let message = parse(&text).unwrap_err().with_excerpt("w.sdf");
        assert!(message.contains("w.sdf:5:58"), "{message}");
        assert!(repaired(WORLD).is_none());
        assert!(repaired("").is_none() && repaired("<?xml").is_none());
        // Nothing that is not well-formed for other reasons.
        assert!(parse("<sdf version=\"1.9\"><!-- -- --><a></sdf>").is_err());
    }
}
