//! One broken rule, and where.

use std::fmt;

/// A broken rule at a line of a file, shown as `path:line: message`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Finding {
    /// Path from the repository's top folder, with `/` between the parts.
    pub(crate) path: String,
    /// Line, counted from 1; 1 when the whole file is meant.
    pub(crate) line: usize,
    /// Values found and expected.
    pub(crate) message: String,
}

impl Finding {
    /// A finding at `line`, counted from 1.
    pub(crate) fn new(path: &str, line: usize, message: impl Into<String>) -> Self {
        Self { path: path.to_owned(), line, message: message.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.path, self.line, self.message)
    }
}

/// Prints all findings in order of place, then their number; true if there were none.
pub(crate) fn report(chore: &str, mut findings: Vec<Finding>) -> bool {
    findings.sort();
    findings.dedup();
    for finding in &findings {
        println!("{finding}");
    }
    match findings.len() {
        0 => println!("{chore}: nothing to report"),
        1 => println!("{chore}: 1 finding"),
        n => println!("{chore}: {n} findings"),
    }
    findings.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_shown_as_editors_expect() {
        assert_eq!(Finding::new("a/b.rs", 7, "too long").to_string(), "a/b.rs:7: too long");
    }

    #[test]
    fn any_finding_fails_the_chore() {
        assert!(report("tidy", vec![]));
        assert!(!report("tidy", vec![Finding::new("a", 1, "x")]));
    }
}
