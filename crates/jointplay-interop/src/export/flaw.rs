//! Violations of a motion, as exported files state them.

use jointplay_cell::check::{Report, Violation};
use jointplay_cell::workcell::Cell;
use jointplay_report::explain_violation;

/// Something that is wrong with a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Flaw {
    /// From when on [s].
    pub from: f64,
    /// Until when [s].
    pub to: f64,
    /// What it is.
    pub message: String,
}

/// What is wrong with a motion, as exported files say it.
#[must_use]
pub fn flaws(cell: &Cell, report: &Report) -> Vec<Flaw> {
    let flaw = |one: &Violation| Flaw {
        from: one.start,
        to: one.end,
        message: format!("line {}: {}: {}", one.place.line, one.kind, explain_violation(cell, one)),
    };
    report.violations.iter().map(flaw).collect()
}
