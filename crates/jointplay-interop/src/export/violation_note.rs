//! Violations of a motion, as exported files state them.

use jointplay_cell::check::{Report, Violation};
use jointplay_cell::workcell::Cell;
use jointplay_report::explain_violation;

/// Something that is wrong with a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct ViolationNote {
    /// From when on (s).
    pub from: f64,
    /// Until when (s).
    pub to: f64,
    /// What it is.
    pub message: String,
}

/// What is wrong with a motion, as exported files say it.
#[must_use]
pub fn violation_notes(cell: &Cell, report: &Report) -> Vec<ViolationNote> {
    let violation_note = |one: &Violation| ViolationNote {
        from: one.start,
        to: one.end,
        message: format!("line {}: {}: {}", one.place.line, one.kind, explain_violation(cell, one)),
    };
    report.violations.iter().map(violation_note).collect()
}
