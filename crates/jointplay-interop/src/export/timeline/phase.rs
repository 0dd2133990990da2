//! Names of the parts of an instruction.

use jointplay_cell::program::Phase;

/// What a part of an instruction is called.
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
