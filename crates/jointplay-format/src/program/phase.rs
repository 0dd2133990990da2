//! Names of the phases of instructions.

use jointplay_cell::program::Phase;

/// Name of a phase, as in exports and reports.
#[must_use]
pub fn phase_name(phase: Phase) -> &'static str {
    match phase {
        Phase::Move => "move",
        Phase::RetractArms => "retract arms",
        Phase::PostureChange => "posture change",
        Phase::Turn => "turn",
        Phase::Align => "align",
        Phase::Extend => "extend",
        Phase::Lift => "lift",
        Phase::Lower => "lower",
        Phase::Retract => "retract",
        Phase::Level => "level",
        Phase::Wait => "wait",
    }
}
