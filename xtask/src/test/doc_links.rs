//! The documentation without broken links, brackets that are no links passed over.
//!
//! House style ends the first line on a number with its unit in brackets, and cites sources the same way.
//! rustdoc takes both for links: its warnings are sifted here, and all but those fail.

use crate::tidy::sources;
use std::path::Path;
use std::process::{Command, Stdio};

/// Flags of the sifted run: broken links are told. Denied outright, the first would end the run before it could be sifted.
pub(super) const FLAGS: &str = "-W rustdoc::broken_intra_doc_links";

/// Units that stand in brackets.
const UNITS: &[&str] =
    &["m", "mm", "µm", "m²", "rad", "deg", "N", "Nm", "kg", "s", "m/s", "rad/s", "Hz", "Pa", "px"];

/// Runs cargo doc and repeats what it says, save warnings about units and sources; true if nothing is left.
pub(super) fn run(mut cargo: Command, root: &Path) -> bool {
    let output = match cargo.env("CARGO_TERM_COLOR", "never").stderr(Stdio::piped()).output() {
        Ok(output) => output,
        Err(error) => {
            eprintln!("cannot start cargo: {error}");
            return false;
        }
    };
    let references = std::fs::read_to_string(root.join("REFERENCES.md")).unwrap_or_default();
    let keys: Vec<&str> =
        sources::definitions(&references).into_iter().map(|(_, key)| key).collect();
    let (kept, warnings) = sift(&String::from_utf8_lossy(&output.stderr), &keys);
    eprint!("{kept}");
    output.status.success() && warnings == 0
}

/// The messages without those about units and sources, and how many warnings are left.
fn sift(text: &str, keys: &[&str]) -> (String, usize) {
    let mut kept = String::new();
    let mut warnings = 0;
    for message in messages(text) {
        let passed_over = target(&message)
            .is_some_and(|target| UNITS.contains(&target) || keys.contains(&target));
        // Cargo's count of warnings would count those passed over as well.
        if passed_over || message.starts_with("warning: `") {
            continue;
        }
        warnings += usize::from(message.starts_with("warning"));
        kept.push_str(&message);
    }
    (kept, warnings)
}

/// What a broken link points to, if the message is about one.
fn target(message: &str) -> Option<&str> {
    message.strip_prefix("warning: unresolved link to `")?.split('`').next()
}

/// Splits compiler output into messages: each starts at the left margin.
fn messages(text: &str) -> Vec<String> {
    let mut messages: Vec<String> = Vec::new();
    for line in text.split_inclusive('\n') {
        let starts = ["warning", "error", "   Doc", " Documenting", "    Checking", "   Compiling"]
            .iter()
            .any(|start| line.starts_with(start));
        match messages.last_mut() {
            Some(last) if !starts => last.push_str(line),
            _ => messages.push(line.to_owned()),
        }
    }
    messages
}

#[cfg(test)]
mod tests {
    use super::sift;

    const UNIT: &str =
        "warning: unresolved link to `rad`\n --> a.rs:1:2\n  |\n  = help: escape\n\n";
    const SOURCE: &str = "warning: unresolved link to `GolubVanLoan`\n --> a.rs:1:2\n\n";
    const BROKEN: &str = "warning: unresolved link to `Gpr::froward`\n --> b.rs:1:2\n\n";

    #[test]
    fn units_and_sources_are_passed_over() {
        let text =
            format!("{UNIT}{SOURCE}warning: `a` (lib doc) generated 2 warnings\n    Finished\n");
        let (kept, warnings) = sift(&text, &["GolubVanLoan"]);
        assert_eq!((kept.contains("unresolved"), warnings), (false, 0));
    }

    #[test]
    fn broken_links_and_other_warnings_are_not() {
        let (kept, warnings) = sift(&format!("{UNIT}{SOURCE}{BROKEN}"), &["GolubVanLoan"]);
        assert_eq!((kept.as_str(), warnings), (BROKEN, 1));
        let other = "warning: this URL is not a hyperlink\n --> a.rs:1:2\n\n";
        assert_eq!(sift(&format!("{UNIT}{other}"), &[]), (other.to_owned(), 1));
    }
}
