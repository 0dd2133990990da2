//! Names of phases.

use jointplay_cell::program::Phase;

/// Name of a phase.
pub(crate) fn phase(phase: Phase) -> &'static str {
    match phase {
        Phase::Move => "move",
        Phase::RetractArms => "tuck in",
        Phase::Turn => "turn",
        Phase::Align => "enter",
        Phase::Extend => "extend",
        Phase::Lift => "lift",
        Phase::Lower => "lower",
        Phase::Retract => "retract",
        Phase::Level => "level",
        Phase::Wait => "wait",
    }
}
