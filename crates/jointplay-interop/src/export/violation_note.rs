//! Violations of a motion for exported files.

use jointplay_cell::check::{Report, Violation};
use jointplay_cell::workcell::Cell;
use jointplay_format::display_units::DisplayUnits;
use jointplay_format::program::phase_name;
use jointplay_report::explain_violation;

/// A violation of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct ViolationNote {
    /// Start of the violation (s).
    pub from: f64,
    /// End of the violation (s).
    pub to: f64,
    /// Message with line, phase, kind and values.
    pub message: String,
}

/// The violations of a motion for exported files, in mm and degrees.
#[must_use]
pub fn violation_notes(cell: &Cell, report: &Report) -> Vec<ViolationNote> {
    let violation_note = |one: &Violation| ViolationNote {
        from: one.start,
        to: one.end,
        message: format!(
            "line {}, {}: {}: {}",
            one.place.line,
            phase_name(one.phase),
            one.kind,
            explain_violation(cell, one, DisplayUnits::Metric)
        ),
    };
    report.violations.iter().map(violation_note).collect()
}
