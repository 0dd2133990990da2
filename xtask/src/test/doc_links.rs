//! The documentation without broken links, brackets that are no links passed over.
//!
//! House style ends the first line on a number with its unit in brackets, and cites sources the same way.
//! rustdoc takes both for links: its warning about broken links is sifted here, all its other warnings are errors.

use crate::tidy::sources;
use std::path::Path;
use std::process::{Command, Stdio};

/// Flags of the sifted run: everything denied, broken links only told.
pub(super) const FLAGS: &str = "-D warnings -W rustdoc::broken_intra_doc_links";

/// Units that stand in brackets.
const UNITS: &[&str] = &["m", "mm", "µm", "m²", "rad", "deg", "N", "Nm", "kg", "s", "m/s", "rad/s"];

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
    let (kept, broken) = sift(&String::from_utf8_lossy(&output.stderr), &keys);
    eprint!("{kept}");
    output.status.success() && broken == 0
}

/// The messages without those about units and sources, and how many broken links are left.
fn sift(text: &str, keys: &[&str]) -> (String, usize) {
    let mut kept = String::new();
    let mut broken = 0;
    for message in messages(text) {
        match target(&message) {
            Some(target) if UNITS.contains(&target) || keys.contains(&target) => {}
            Some(_) => {
                broken += 1;
                kept.push_str(&message);
            }
            // Cargo's count of warnings would count those passed over as well.
            None if message.starts_with("warning: `") => {}
            None => kept.push_str(&message),
        }
    }
    (kept, broken)
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
        let (kept, broken) = sift(&text, &["GolubVanLoan"]);
        assert_eq!((kept.contains("unresolved"), broken), (false, 0));
    }

    #[test]
    fn broken_links_are_not() {
        let (kept, broken) = sift(&format!("{UNIT}{SOURCE}{BROKEN}"), &["GolubVanLoan"]);
        assert_eq!((kept.as_str(), broken), (BROKEN, 1));
    }
}
