//! Code spans and the targets of links and images in Markdown, read by `pulldown-cmark`.

use pulldown_cmark::{Event, Options, Parser, Tag};

/// Reference of a document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Reference {
    /// Target of a link or image, or an HTML `src` or `href`.
    Target(String),
    /// Text of a code span.
    Code(String),
}

/// All references of a Markdown text, each with its line from 1; code blocks are not read.
pub(crate) fn references(text: &str) -> Vec<(usize, Reference)> {
    let events = Parser::new_ext(text, Options::ENABLE_TABLES | Options::ENABLE_FOOTNOTES);
    let mut references = Vec::new();
    for (event, range) in events.into_offset_iter() {
        let line = text[..range.start].matches('\n').count() + 1;
        let mut add = |reference| references.push((line, reference));
        match event {
            Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                add(Reference::Target(dest_url.into_string()));
            }
            Event::Code(code) => add(Reference::Code(code.into_string())),
            Event::Html(html) | Event::InlineHtml(html) => {
                for target in ["src=\"", "href=\""].iter().flat_map(|key| html.split(key).skip(1)) {
                    add(Reference::Target(target.split('"').next().unwrap_or_default().to_owned()));
                }
            }
            _ => {}
        }
    }
    references
}

/// Where a reference of the file `from` points, as a path from the top folder.
///
/// `Ok(None)` for what lies outside the repository or is only an anchor.
///
/// # Errors
/// If the path climbs above the top folder.
pub(crate) fn resolve(from: &str, target: &str) -> Result<Option<String>, &'static str> {
    let path = target.split(['#', '?']).next().unwrap_or_default();
    let scheme = path.split('/').next().is_some_and(|first| first.contains(':'));
    if path.is_empty() || path.starts_with("//") || scheme {
        return Ok(None);
    }
    let folder = from.rsplit_once('/').map_or("", |(folder, _)| folder);
    let start = if path.starts_with('/') { "" } else { folder };
    let mut parts: Vec<&str> = Vec::new();
    for part in start.split('/').chain(path.split('/')) {
        match part {
            "" | "." => {}
            ".." => _ = parts.pop().ok_or("leaves the repository")?,
            part => parts.push(part),
        }
    }
    Ok(Some(parts.join("/")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_images_html_and_code_spans() {
        let text = "See [a](b.md#c) and ![d](e/f.svg \"g\").\n\n<img src=\"h.png\">\n\n| `i.rs` |\n| --- |\n\n```text\n[a](b) `c`\n```\n";
        let target = |target: &str| Reference::Target(target.to_owned());
        let expect = [
            (1, target("b.md#c")),
            (1, target("e/f.svg")),
            (3, target("h.png")),
            (5, Reference::Code("i.rs".into())),
        ];
        assert_eq!(references(text), expect);
    }

    #[test]
    fn targets_are_resolved_from_their_file() {
        let check = |from, target, expect: Result<Option<&str>, ()>| {
            let expect = expect.map(|path| path.map(str::to_owned));
            assert_eq!(resolve(from, target).map_err(|_| ()), expect, "{target}");
        };
        check("README.md", "docs/a.md#b", Ok(Some("docs/a.md")));
        check("docs/theory/a.md", "../figures/b.svg", Ok(Some("docs/figures/b.svg")));
        check("docs/a.md", "/LICENSE-MIT", Ok(Some("LICENSE-MIT")));
        check("docs/a.md", "https://example.org/a", Ok(None));
        check("docs/a.md", "mailto:a@example.org", Ok(None));
        check("docs/a.md", "#anchor", Ok(None));
        check("docs/a.md", "../../b.md", Err(()));
    }
}
