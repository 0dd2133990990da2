//! What the chores read from Markdown: prose, code spans, and the targets of links and images.

/// The target of a link, an image, a link definition, or an HTML `src`, `srcset` or `href`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Reference {
    /// Line, counted from 1.
    pub(crate) line: usize,
    /// The target as written, without title.
    pub(crate) target: String,
}

/// A line of Markdown and whether it lies in a fenced code block (the fences count as inside).
pub(crate) struct Line<'a> {
    /// Number, counted from 1.
    pub(crate) number: usize,
    /// The line's text.
    pub(crate) text: &'a str,
    /// True from the opening to the closing fence.
    pub(crate) fenced: bool,
}

/// Lines of `text`, each with its place relative to fenced code blocks.
pub(crate) fn lines(text: &str) -> Vec<Line<'_>> {
    let mut fences = Fences::default();
    let number = |(i, line)| Line { number: i + 1, text: line, fenced: fences.covers(line) };
    text.lines().enumerate().map(number).collect()
}

/// Follows fenced code blocks line by line.
#[derive(Default)]
pub(crate) struct Fences {
    /// Mark that opened the block, and its length.
    open: Option<(char, usize)>,
}

impl Fences {
    /// Whether the next line belongs to a fenced block, its fences included.
    pub(crate) fn covers(&mut self, line: &str) -> bool {
        let trimmed = line.trim_start();
        let mark = trimmed.chars().next().unwrap_or(' ');
        let length = trimmed.chars().take_while(|c| *c == mark).count();
        let fence = (mark == '`' || mark == '~') && length >= 3;
        match self.open {
            None if fence && !trimmed[length..].contains('`') => self.open = Some((mark, length)),
            None => return false,
            Some((opened, least)) => {
                let closes = fence && mark == opened && length >= least;
                if closes && trimmed[length..].trim().is_empty() {
                    self.open = None;
                }
            }
        }
        true
    }
}

/// Contents of the code spans of a line, and the line with those spans blank.
pub(crate) fn code_spans(line: &str) -> (Vec<&str>, String) {
    let (mut spans, mut prose, mut rest) = (Vec::new(), String::new(), line);
    while let Some(start) = rest.find('`') {
        let (before, opened) = rest.split_at(start);
        prose.push_str(before);
        let ticks = opened.len() - opened.trim_start_matches('`').len();
        let body = &opened[ticks..];
        let Some(length) = closing_ticks(body, ticks) else {
            prose.push_str(&opened[..ticks]);
            rest = body;
            continue;
        };
        spans.push(body[..length].trim());
        prose.push(' ');
        rest = &body[length + ticks..];
    }
    prose.push_str(rest);
    (spans, prose)
}

/// Where the run of exactly `ticks` backticks starts in `body`.
fn closing_ticks(body: &str, ticks: usize) -> Option<usize> {
    let mut at = 0;
    loop {
        at += body[at..].find('`')?;
        let run = body[at..].len() - body[at..].trim_start_matches('`').len();
        if run == ticks {
            return Some(at);
        }
        at += run;
    }
}

/// All references of a Markdown text, outside code.
pub(crate) fn references(text: &str) -> Vec<Reference> {
    let mut references = Vec::new();
    for line in lines(text).iter().filter(|line| !line.fenced) {
        let (_, prose) = code_spans(line.text);
        let targets = inline_targets(&prose).into_iter().chain(definition_target(&prose));
        let all = targets.chain(html_targets(&prose));
        references.extend(all.map(|target| Reference { line: line.number, target }));
    }
    references
}

/// Targets of `[text](target "title")` and `![text](target)`.
fn inline_targets(prose: &str) -> Vec<String> {
    let starts = prose.match_indices("](").map(|(at, _)| at);
    let links = starts.filter(|at| prose[..*at].contains('['));
    links.map(|at| first_word(&prose[at + 2..][..parenthesis_length(&prose[at + 2..])])).collect()
}

/// Length of `text` up to the parenthesis that closes it.
fn parenthesis_length(text: &str) -> usize {
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' if depth == 0 => return at,
            ')' => depth -= 1,
            _ => {}
        }
    }
    text.len()
}

/// Target of `[label]: target`; footnotes are none.
fn definition_target(prose: &str) -> Option<String> {
    let (label, target) = prose.trim().strip_prefix('[')?.split_once("]:")?;
    let is_definition =
        !label.starts_with('^') && !label.contains(']') && !target.trim().is_empty();
    is_definition.then(|| first_word(target))
}

/// Values of `src`, `srcset` and `href`, in either quotes.
fn html_targets(prose: &str) -> Vec<String> {
    let mut targets = Vec::new();
    for attribute in ["src=", "srcset=", "href="] {
        for (at, _) in prose.match_indices(attribute) {
            let value = &prose[at + attribute.len()..];
            let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''));
            let Some((value, _)) = quote.and_then(|q| value[1..].split_once(q)) else { continue };
            // Only a srcset holds several targets, each with an optional size.
            let several = if attribute == "srcset=" { ',' } else { '\0' };
            targets.extend(value.split(several).map(first_word));
        }
    }
    targets
}

/// The target itself, without angle brackets and title.
fn first_word(text: &str) -> String {
    let text = text.trim();
    let bracketed = text.strip_prefix('<').and_then(|t| t.split_once('>'));
    let word = bracketed.map(|(target, _)| target).or_else(|| text.split_whitespace().next());
    word.unwrap_or_default().to_owned()
}

/// Where a reference of the file `from` points, as a path from the top folder.
///
/// `Ok(None)` for what lies outside the repository or is only an anchor.
///
/// # Errors
/// If the path climbs above the top folder.
pub(crate) fn resolve(from: &str, target: &str) -> Result<Option<String>, &'static str> {
    let path = target.split(['#', '?']).next().unwrap_or_default();
    if path.is_empty() || path.starts_with("//") || has_scheme(target) {
        return Ok(None);
    }
    let folder = from.rsplit_once('/').map_or("", |(folder, _)| folder);
    let start = if path.starts_with('/') { "" } else { folder };
    let decoded = path.replace("%20", " ");
    let mut parts: Vec<&str> = Vec::new();
    for part in start.split('/').chain(decoded.split('/')) {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop().ok_or("leaves the repository")?;
            }
            part => parts.push(part),
        }
    }
    Ok(Some(parts.join("/")))
}

fn has_scheme(target: &str) -> bool {
    let scheme = target.split_once(':').map(|(scheme, _)| scheme);
    scheme.is_some_and(|s| {
        s.starts_with(|c: char| c.is_ascii_alphabetic())
            && s.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, expect: &[(usize, &str)]) {
        let found = references(text);
        let found: Vec<_> = found.iter().map(|r| (r.line, r.target.as_str())).collect();
        assert_eq!(found, expect, "{text}");
    }

    #[test]
    fn links_and_images() {
        check("See [a](b.md#c) and ![d](e/f.svg \"g\").", &[(1, "b.md#c"), (1, "e/f.svg")]);
        check("\n[`code`](x.rs)", &[(2, "x.rs")]);
        check("[a](<b c.md>) [d](e(f).md)", &[(1, "b c.md"), (1, "e(f).md")]);
        check("[![badge](i.svg)](t.md)", &[(1, "i.svg"), (1, "t.md")]);
    }

    #[test]
    fn definitions_are_references_and_footnotes_are_not() {
        check("[a]: b.md\n[^1]: c.md\n- **[Key]** title", &[(1, "b.md")]);
    }

    #[test]
    fn html() {
        check("<img src=\"a.svg\" alt='x'> <a href='b.md'>", &[(1, "a.svg"), (1, "b.md")]);
        check("<source srcset=\"a.svg 1x, b.svg 2x\">", &[(1, "a.svg"), (1, "b.svg")]);
    }

    #[test]
    fn code_holds_no_references() {
        check("`[a](b)` and ``[c](`d`)``", &[]);
        check("```text\n[a](b)\n```\n[c](d)", &[(4, "d")]);
        check("````\n```\n[a](b)\n````\n~~~\n[a](b)\n~~~\n[c](d)", &[(8, "d")]);
    }

    #[test]
    fn code_spans_of_a_line() {
        assert_eq!(
            code_spans("a `b` c ``d ` e`` f `g"),
            (vec!["b", "d ` e"], "a   c   f `g".into())
        );
    }

    #[test]
    fn resolution() {
        let check = |from, target, expect: Result<Option<&str>, ()>| {
            let expect = expect.map(|path| path.map(str::to_owned));
            assert_eq!(resolve(from, target).map_err(|_| ()), expect, "{target}");
        };
        check("README.md", "docs/a.md#b", Ok(Some("docs/a.md")));
        check("docs/theory/a.md", "../figures/b.svg", Ok(Some("docs/figures/b.svg")));
        check("docs/a.md", "/LICENSE-MIT", Ok(Some("LICENSE-MIT")));
        check("docs/a.md", "./b%20c/", Ok(Some("docs/b c")));
        check("docs/a.md", "https://example.org/a", Ok(None));
        check("docs/a.md", "mailto:a@example.org", Ok(None));
        check("docs/a.md", "#anchor", Ok(None));
        check("docs/a.md", "../../b.md", Err(()));
    }
}
