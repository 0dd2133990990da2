//! Why a command of a host is refused.

use jointplay_cell::PlanError;
use jointplay_cell::controller::Refusal;
use jointplay_cell::workcell::Cell;
use jointplay_format::cell::explain_trajectory::explain_step;
use jointplay_format::display_units::DisplayUnits;
use jointplay_format::program;

use crate::export::violation_notes;

/// Kind of a refusal; its number is the code in answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RefusalReason {
    /// The line is too long, is not text, or has another checksum.
    Unreadable = 1,
    /// No pattern fits the line.
    Unknown = 2,
    /// The robot executes another command.
    Busy = 3,
    /// The command is not possible in the present state, such as a pick from an empty slot.
    Invalid = 4,
    /// A target is out of reach or beyond a limit.
    Unreachable = 5,
    /// The check found a violation, such as a collision.
    Violation = 6,
}

/// All reasons, with their words in answers.
pub const REFUSAL_REASONS: [(RefusalReason, &str); 6] = [
    (RefusalReason::Unreadable, "unreadable"),
    (RefusalReason::Unknown, "unknown"),
    (RefusalReason::Busy, "busy"),
    (RefusalReason::Invalid, "invalid"),
    (RefusalReason::Unreachable, "unreachable"),
    (RefusalReason::Violation, "violation"),
];

impl RefusalReason {
    /// Code in answers.
    #[must_use]
    pub fn code(self) -> i64 {
        self as i64
    }

    /// Word in answers.
    #[must_use]
    pub fn word(self) -> &'static str {
        let found = REFUSAL_REASONS.iter().find(|(reason, _)| *reason == self);
        found.map_or("unknown", |(_, word)| word)
    }
}

/// Where a line deviates from a pattern.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Mismatch {
    /// In the text after some fields.
    Text {
        /// Number of fields that fit.
        fields: usize,
        /// Word of the line.
        found: String,
        /// Description of what the pattern has there.
        expected: String,
    },
    /// In a field.
    Field {
        /// Number of fields that fit.
        fields: usize,
        /// Word of the line.
        found: String,
        /// Description of the allowed values.
        expected: String,
    },
}

impl Mismatch {
    /// How much of the pattern fits, for the choice of the most helpful message.
    pub(super) fn rank(&self) -> usize {
        match self {
            Self::Text { fields: 0, .. } => 0,
            Self::Text { fields, .. } => 2 * fields,
            Self::Field { fields, .. } => 2 * fields + 1,
        }
    }
}

/// A refused command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Refused {
    pub(super) reason: RefusalReason,
    pub(super) text: String,
}

impl Refused {
    pub(super) fn new(reason: RefusalReason, text: impl Into<String>) -> Self {
        Self { reason, text: text.into() }
    }
    /// The refusal of a program, whose text is given, by the controller.
    pub(super) fn of(refusal: Refusal, cell: &Cell, text: &str) -> Self {
        let robot = &cell.robot;
        match refusal {
            Refusal::Plan(PlanError::Program(errors)) => {
                let is_infeasible = errors.iter().all(|one| one.problem.is_infeasible());
                let explained = errors
                    .first()
                    .map(|one| program::explain(robot, text, one, DisplayUnits::Metric));
                let why = explained.map_or_else(String::new, |error| error.to_string());
                let reason = match is_infeasible {
                    true => RefusalReason::Unreachable,
                    false => RefusalReason::Invalid,
                };
                Self::new(reason, why)
            }
            Refusal::Plan(PlanError::Trajectory(error)) => {
                let step =
                    error.steps.first().map(|one| explain_step(robot, one, DisplayUnits::Metric));
                Self::new(RefusalReason::Unreachable, step.unwrap_or_default())
            }
            Refusal::Plan(error) => Self::new(RefusalReason::Invalid, error.to_string()),
            Refusal::Violations(report) => {
                let notes = violation_notes(cell, &report);
                let first = notes.into_iter().next().map(|note| note.message);
                // The line is that of the command's own program.
                let first = first.unwrap_or_default();
                let why = first.split_once(": ").map_or(first.as_str(), |(_, why)| why);
                Self::new(RefusalReason::Violation, why)
            }
        }
    }
}
