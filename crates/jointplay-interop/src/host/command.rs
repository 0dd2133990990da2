//! Commands of a host language.

use super::pattern::Pattern;
use crate::controller_text::Template;

/// A command: a pattern, and its effect.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CommandRule {
    /// The pattern as written.
    pub(super) text: String,
    pub(super) pattern: Pattern,
    pub(super) effect: Effect,
}

/// Effect of a command.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Effect {
    /// The robot executes a program.
    Program(Vec<Template>),
    /// An action of the controller.
    Action(Action),
}

/// Action of the controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Action {
    /// Answers the state of the robot, also while it moves.
    Status,
    /// Answers which slots of a station hold wafers, also while the robot moves.
    Map,
    /// Stops at the end of the present segment of the motion.
    Stop,
    /// Moves the robot home and all wafers back, without a motion.
    Reset,
}

/// Actions with their names in files.
pub(super) const ACTIONS: [(&str, Action); 4] = [
    ("status", Action::Status),
    ("map", Action::Map),
    ("stop", Action::Stop),
    ("reset", Action::Reset),
];
