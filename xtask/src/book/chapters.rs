//! The preprocessor of the book: formulas become MathML, links out of the book become links within it.

use std::io::{self, Read, Write};
use std::path::{Component, Path, PathBuf};

use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::{Parser, Storage, push_mathml};
use serde_json::Value;

use super::http;
use super::links::{FILES, RUST};

/// Documents of the repository that are chapters, and those chapters.
const INCLUDED: [(&str, &str); 5] = [
    ("NOTATION.md", "reference/notation.md"),
    ("REFERENCES.md", "reference/references.md"),
    ("ARCHITECTURE.md", "development/architecture.md"),
    ("CONTRIBUTING.md", "development/contributing.md"),
    ("CHANGELOG.md", "development/changelog.md"),
];

/// Folder of the book's sources in the repository.
const SOURCES: &str = "docs";

/// Reads the book from standard input and writes it to standard output, as mdbook asks of a preprocessor; true if it could.
pub(crate) fn run() -> bool {
    let mut text = String::new();
    let read = io::stdin().read_to_string(&mut text);
    let Ok([_, mut book]) = read.and_then(|_| Ok(serde_json::from_str::<[Value; 2]>(&text)?))
    else {
        eprintln!("chapters: standard input is not a book of mdbook");
        return false;
    };
    let mut errors = Vec::new();
    let description = std::fs::read_to_string(crate::root::find().join(http::DESCRIPTION));
    let requests = description.map_err(|error| error.to_string());
    match requests.and_then(|text| http::chapter(&text)) {
        Ok(requests) => visit(&mut book, &requests, &mut errors),
        Err(error) => errors.push(format!("{}: {error}", http::DESCRIPTION)),
    }
    errors.iter().for_each(|error| eprintln!("chapters: {error}"));
    errors.is_empty() && writeln!(io::stdout(), "{book}").is_ok()
}

/// Rewrites every chapter in a part of the book; `requests` is the reference of the HTTP interface.
fn visit(part: &mut Value, requests: &str, errors: &mut Vec<String>) {
    match part {
        Value::Array(parts) => parts.iter_mut().for_each(|part| visit(part, requests, errors)),
        Value::Object(members) => {
            let path = members.get("path").and_then(Value::as_str).map(str::to_owned);
            if let (Some(path), Some(Value::String(content))) = (path, members.get_mut("content")) {
                *content = chapter(&path, content, errors).replace(http::MARKER, requests);
            }
            members.values_mut().for_each(|member| visit(member, requests, errors));
        }
        _ => {}
    }
}

/// The text of the chapter at `path`, with formulas and links replaced.
fn chapter(path: &str, text: &str, errors: &mut Vec<String>) -> String {
    let mut out = String::with_capacity(text.len() * 2);
    let mut in_code = false;
    let mut display: Option<String> = None;
    for (number, line) in text.lines().enumerate() {
        let mut set = |latex: &str, mode| match mathml(latex, mode) {
            Ok(math) => math,
            Err(error) => {
                errors.push(format!("{path}:{}: {error}", number + 1));
                String::new()
            }
        };
        let fence = line.trim_start().starts_with("```");
        match &mut display {
            Some(latex) if line.trim() == "$$" => {
                let math = set(latex, DisplayMode::Block);
                out.push_str(&format!("<div class=\"formula\">{math}</div>\n"));
                display = None;
                continue;
            }
            Some(latex) => {
                latex.push_str(line);
                latex.push('\n');
                continue;
            }
            None if !in_code && line.trim() == "$$" => {
                display = Some(String::new());
                continue;
            }
            None => {}
        }
        in_code ^= fence;
        if in_code || fence {
            out.push_str(line);
        } else {
            out.push_str(&prose(path, line, &mut set));
        }
        out.push('\n');
    }
    if display.is_some() {
        errors.push(format!("{path}: a formula has no end"));
    }
    out
}

/// A line outside of code blocks; code spans stay as they are.
fn prose(path: &str, line: &str, set: &mut impl FnMut(&str, DisplayMode) -> String) -> String {
    let pieces = line.split('`').enumerate().map(|(i, piece)| {
        if i % 2 == 1 {
            return piece.to_owned();
        }
        let mut out = String::new();
        let mut parts = piece.split('$').peekable();
        let mut is_formula = false;
        while let Some(part) = parts.next() {
            if is_formula && parts.peek().is_some() {
                out.push_str(&set(part, DisplayMode::Inline));
            } else {
                if is_formula {
                    out.push('$');
                }
                out.push_str(&relinked(path, part));
            }
            is_formula = !is_formula;
        }
        out
    });
    pieces.collect::<Vec<_>>().join("`")
}

/// MathML of a formula in LaTeX, with nothing in it that Markdown would take for markup.
fn mathml(latex: &str, display_mode: DisplayMode) -> Result<String, String> {
    let storage = Storage::new();
    let config = RenderConfig { display_mode, ..RenderConfig::default() };
    let mut math = String::new();
    let events: Result<Vec<_>, _> = Parser::new(latex, &storage).collect();
    let events = events.map_err(|error| format!("{}: {error}", latex.trim()))?;
    let events = events.into_iter().map(Ok::<_, std::convert::Infallible>);
    push_mathml(&mut math, events, config).map_err(|error| error.to_string())?;
    // A blank that the library omits, and bars and slashes that browsers would set apart like other operators.
    let mut math = math.replace("\"minsize", "\" minsize");
    for sign in ["|", "‖", "/"] {
        math = math
            .replace(&format!(">{sign}</mo>"), &format!(" lspace=\"0\" rspace=\"0\">{sign}</mo>"));
    }
    let mut out = String::with_capacity(math.len());
    let mut in_tag = false;
    for c in math.chars() {
        match c {
            '<' => in_tag = true,
            '>' => in_tag = false,
            '*' | '_' | '[' | ']' | '|' | '\\' | '~' if !in_tag => {
                out.push_str(&format!("&#{};", u32::from(c)));
                continue;
            }
            '\n' => continue,
            _ => {}
        }
        out.push(c);
    }
    Ok(out)
}

/// A piece of a chapter with its links out of the book replaced.
fn relinked(path: &str, text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find("](") {
        let (before, after) = rest.split_at(at + 2);
        out.push_str(before);
        let end = after.find(')').unwrap_or(after.len());
        out.push_str(&target(path, &after[..end]));
        rest = &after[end..];
    }
    out + rest
}

/// Where a link in the chapter at `path` leads to in the book.
fn target(path: &str, link: &str) -> String {
    if link.starts_with('#') || link.contains(':') {
        return link.to_owned();
    }
    let (file, anchor) = link.find('#').map_or((link, ""), |at| link.split_at(at));
    // An included document is written for its own place.
    let document = INCLUDED.iter().find(|(_, chapter)| *chapter == path);
    let origin =
        document.map_or_else(|| Path::new(SOURCES).join(path), |(document, _)| document.into());
    let file = resolved(&origin.with_file_name(file));
    let within = match INCLUDED.iter().find(|(document, _)| Path::new(document) == file) {
        Some((_, chapter)) => (*chapter).into(),
        None => match file.strip_prefix(SOURCES) {
            Ok(within) if !within.starts_with("..") => within.to_owned(),
            _ => documentation(&file).unwrap_or_else(|| Path::new(FILES).join(shown(&file))),
        },
    };
    let up = Path::new(path).components().count() - 1;
    let within = within.components().map(|part| part.as_os_str().to_string_lossy());
    let within: Vec<_> = within.collect();
    format!("{}{}{anchor}", "../".repeat(up), within.join("/"))
}

/// The documentation of a crate in the book, for the file that begins it.
fn documentation(file: &Path) -> Option<PathBuf> {
    let name = file.strip_prefix("crates").ok()?.parent()?.parent()?.to_str()?;
    let begins = file == Path::new("crates").join(name).join("src/lib.rs");
    begins.then(|| Path::new(RUST).join(name.replace('-', "_")).join("index.html"))
}

/// The name under which a file of the repository is in the book: links to Markdown would be taken for links to chapters.
fn shown(file: &Path) -> PathBuf {
    let is_markdown = file.extension().is_some_and(|end| end == "md");
    if is_markdown { file.with_extension("txt") } else { file.to_owned() }
}

/// The path without `.` and `..`, as far as it stays in the repository.
fn resolved(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => _ = out.pop(),
            Component::Normal(part) => out.push(part),
            _ => {}
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(path: &str, text: &str, expect: &str) {
        let mut errors = Vec::new();
        assert_eq!(chapter(path, text, &mut errors).trim_end(), expect);
        assert!(errors.is_empty(), "{errors:?}");
    }

    #[test]
    fn formulas_become_mathml_outside_of_code() {
        let x = "<math display=\"inline\"><mi>x</mi></math>";
        check("a.md", "Let $x$ be `$y$`, 5 $.", &format!("Let {x} be `$y$`, 5 $."));
        check("a.md", "```sh\necho $A $B\n```", "```sh\necho $A $B\n```");
        let mut errors = Vec::new();
        let text = chapter("a.md", "$$\nx\n= *\n$$\n", &mut errors);
        assert!(text.starts_with("<div class=\"formula\"><math display=\"block\">"), "{text}");
        assert!(!text.contains('*') && text.trim_end().lines().count() == 1, "{text}");
    }

    #[test]
    fn mistakes_in_formulas_are_errors_with_their_line() {
        let mut errors = Vec::new();
        chapter("a.md", "A\n$\\frac{1}$ and $\\nosuch$", &mut errors);
        chapter("b.md", "$$\nx", &mut errors);
        assert_eq!(errors.len(), 3, "{errors:?}");
        assert!(errors[0].starts_with("a.md:2: "), "{errors:?}");
    }

    #[test]
    fn links_out_of_the_book_stay_within_it() {
        check("a/b.md", "[c](d.md#e) [f](../g.md)", "[c](../a/d.md#e) [f](../g.md)");
        check("a/b.md", "[n](../../NOTATION.md#units)", "[n](../reference/notation.md#units)");
        check("a/b.md", "[r](../../crates/gpr.toml)", "[r](../files/crates/gpr.toml)");
        check("a.md", "[r](../bench/README.md)", "[r](files/bench/README.txt)");
        let begins = "[r](../../crates/a-b/src/lib.rs)";
        check("a/b.md", begins, "[r](../rust/a_b/index.html)");
        check("a.md", "[r](../crates/a-b/src/c.rs)", "[r](files/crates/a-b/src/c.rs)");
        check("reference/notation.md", "[x](docs/a/b.md)", "[x](../a/b.md)");
        check("a.md", "[x](https://x.org) [y](#z)", "[x](https://x.org) [y](#z)");
    }
}
