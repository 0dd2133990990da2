//! Planning errors of a program, shown in its text.

use jointplay_cell::program::{Leveling, Place, ProgramError, ProgramProblem};
use jointplay_cell::robot::HybridRobot;

use super::lexer::{Token, line_at};
use crate::cell::explain::{explain_limit, explain_sag, explain_unreachable_pose};
use crate::place::{self, Error, nearest, suggestion};

/// A planning error of a program as a message.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Explained {
    /// The message.
    pub message: String,
}

/// The place and the message of a planning error in the text of a program.
#[must_use]
pub fn explain(robot: &HybridRobot, text: &str, error: &ProgramError) -> Error<Explained> {
    let mut message = message(robot, error);
    if let ProgramProblem::Unknown { found, known, .. } = &error.problem {
        let lower = found.to_lowercase();
        // Names are case sensitive, and incorrect case is a common typing error.
        let alike = known.iter().find(|name| name.to_lowercase() == lower);
        let nearest = alike.cloned().or_else(|| nearest(found, known.iter().map(String::as_str)));
        message += &suggestion(&nearest);
    }
    Error { place: shown(text, error.place), problem: Box::new(Explained { message }) }
}

/// A problem in mm and degrees.
fn message(robot: &HybridRobot, error: &ProgramError) -> String {
    let problem = match &error.problem {
        ProgramProblem::Limits { what, violations } => {
            let limits: Vec<String> =
                violations.iter().map(|limit| explain_limit(robot, limit)).collect();
            format!("{what} violates limits: {}", limits.join("; "))
        }
        ProgramProblem::Unreachable { target, effector, loaded, leveling, source } => {
            let load = if *loaded { "loaded" } else { "empty" };
            let why = explain_unreachable_pose(robot, source);
            let remedy = leveling.as_ref().map_or_else(String::new, remedy);
            format!("effector {effector}, {load}, does not reach {target}: {why}{remedy}")
        }
        ProgramProblem::Sag { effector, source } => {
            format!("effector {effector} does not carry the wafer: {}", explain_sag(source))
        }
        // Other problems have no lengths or angles.
        _ => return error.to_string(),
    };
    problem + &error.repetitions()
}

fn remedy(leveling: &Leveling) -> String {
    // Rounded up: a correction by less would not suffice.
    let angle = (leveling.angle.to_degrees() * 1e3).ceil() * 1e-3;
    format!("; level {} by at least {angle:.3}°", leveling.station)
}

/// The place in the text, with the width of the marked part.
fn shown(text: &str, at: Place) -> place::Place {
    let line = line_at(text, at.line);
    let token = line.as_ref().and_then(|line| line.tokens.iter().find(|it| it.column == at.column));
    place::Place {
        line: at.line,
        column: at.column.max(1),
        width: token.map_or(0, Token::width),
        text: line.as_ref().map_or_else(String::new, |line| line.text.to_owned()),
    }
}
