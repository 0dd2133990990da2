//! Limits of XML texts, checked before they are parsed: the time and memory of a parser grow with the square or the cube of what they bound.

use std::ops::Range;

use super::problem::Problem;

/// Greatest depth of nested elements; a chain of that many links is no robot.
const DEEPEST: usize = 1000;
/// Most attributes of an element; each is compared with all others of its element.
const MOST_ATTRIBUTES: usize = 256;
/// Most namespaces that are declared in the elements around a place; each element that declares one copies them.
const MOST_NAMESPACES: usize = 64;

/// Checks a text against the limits.
///
/// A text that is not well-formed is within them where its start is; its parser reports the error.
///
/// # Errors
/// The first problem, with its range.
pub(super) fn check(text: &str) -> Result<(), (Range<usize>, Problem)> {
    // Namespaces that each of the open elements declares, and their sum.
    let (mut open, mut namespaces) = (Vec::new(), 0);
    let mut at = 0;
    while let Some(start) = text[at..].find('<').map(|found| at + found) {
        let rest = &text[start..];
        let skipped = |end: &str| rest.find(end).map(|found| start + found + end.len());
        let next = if rest.starts_with("<!--") {
            skipped("-->")
        } else if rest.starts_with("<![CDATA[") {
            skipped("]]>")
        } else if rest.starts_with("<?") {
            skipped("?>")
        } else if rest.starts_with("</") {
            namespaces -= open.pop().unwrap_or(0);
            skipped(">")
        } else {
            let tag = Tag::of(rest);
            let span = start..start + tag.name;
            let many = |what, allowed| Err((span.clone(), Problem::TooMany { what, allowed }));
            if tag.attributes > MOST_ATTRIBUTES {
                return many("attributes of an element", MOST_ATTRIBUTES);
            }
            if namespaces + tag.namespaces > MOST_NAMESPACES {
                return many("namespaces around an element", MOST_NAMESPACES);
            }
            if !tag.is_empty {
                open.push(tag.namespaces);
                namespaces += tag.namespaces;
            }
            if open.len() > DEEPEST {
                return Err((span, Problem::TooDeep { allowed: DEEPEST }));
            }
            Some(start + tag.length)
        };
        let Some(next) = next else { return Ok(()) };
        at = next;
    }
    Ok(())
}

/// The start of an element.
#[derive(Default)]
struct Tag {
    /// Length (bytes).
    length: usize,
    /// Length of its beginning with the name (bytes).
    name: usize,
    attributes: usize,
    namespaces: usize,
    /// Whether it also ends the element.
    is_empty: bool,
}

impl Tag {
    /// The tag that a text begins with.
    fn of(text: &str) -> Self {
        let bytes = text.as_bytes();
        let is_end = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b'/' | b'>');
        let name = bytes.iter().position(is_end).unwrap_or(bytes.len());
        let mut tag = Self { name, length: name, ..Self::default() };
        while let Some(&byte) = bytes.get(tag.length) {
            match byte {
                b'>' => {
                    tag.is_empty = bytes[tag.length - 1] == b'/';
                    tag.length += 1;
                    return tag;
                }
                b'"' | b'\'' => {
                    tag.attributes += 1;
                    let value = &bytes[tag.length + 1..];
                    let end = value.iter().position(|&other| other == byte);
                    tag.length += end.map_or(value.len(), |end| end + 1);
                }
                b'x' if bytes[tag.length..].starts_with(b"xmlns") => tag.namespaces += 1,
                _ => {}
            }
            tag.length += 1;
        }
        tag.length = tag.length.min(bytes.len());
        tag
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check_all(cases: &[(String, Option<&str>)]) {
        for (text, expected) in cases {
            let found = check(text).err().map(|(_, problem)| problem.to_string());
            let shown: String = text.chars().take(60).collect();
            assert_eq!(found.as_deref(), *expected, "{shown}");
        }
    }

    #[test]
    fn texts_at_the_limits_are_accepted_and_beyond_them_refused() {
        let attributes = |count: usize| {
            let all: String = (0..count).map(|k| format!(" a{k} = '>'")).collect();
            format!("<a><b{all}/></a>")
        };
        let nested =
            |count: usize| format!("{}{}", "<a b='/'>".repeat(count), "</a>".repeat(count));
        let namespaces = |count: usize, inner: &str| {
            let open: String = (0..count).map(|k| format!("<a xmlns:n{k}=\"u\">")).collect();
            format!("{open}{inner}{}", "</a>".repeat(count))
        };
        let many = "at most 256 attributes of an element are allowed; here are more";
        let around = "at most 64 namespaces around an element are allowed; here are more";
        check_all(&[
            (attributes(256), None),
            (attributes(257), Some(many)),
            (nested(1000), None),
            (nested(1001), Some("elements are nested more than 1000 deep")),
            ("<a/>".repeat(5000), None),
            ("<a></a>".repeat(5000), None),
            (namespaces(64, ""), None),
            (namespaces(65, ""), Some(around)),
            (namespaces(64, "<b xmlns='v'/>"), Some(around)),
            (namespaces(32, "").repeat(100), None),
        ]);
    }

    #[test]
    fn comments_data_and_instructions_are_no_elements() {
        let quotes = "a='b' ".repeat(300);
        check_all(&[
            (format!("<!-- <a {quotes} --><a/>"), None),
            (format!("<a><![CDATA[<b {quotes}>]]></a>"), None),
            (format!("<?xml {quotes}?><a/>"), None),
            (format!("<a>{quotes}</a>"), None),
        ]);
    }

    #[test]
    fn incomplete_texts_do_not_panic() {
        let whole = "<?xml v='1'?><!-- c --><ä xmlns:b=\"u\" c='>'>t<![CDATA[d]]><e/></ä>";
        for cut in (0..whole.len()).filter(|&cut| whole.is_char_boundary(cut)) {
            assert!(check(&whole[..cut]).is_ok() && check(&whole[cut..]).is_ok());
        }
    }
}
