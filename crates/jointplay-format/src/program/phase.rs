//! Names of the phases of instructions.

use jointplay_cell::program::Phase;

/// Name of a phase, as in exports and reports.
#[must_use]
pub fn phase_name(phase: Phase) -> &'static str {
    phase.name()
}
