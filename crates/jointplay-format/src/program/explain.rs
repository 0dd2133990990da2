//! Planning errors of a program, shown in its text.

use jointplay_cell::program::{Leveling, ProgramError, ProgramProblem, SourceLocation};
use jointplay_cell::robot::{Axis, AxisKind, HybridRobot};
use jointplay_cell::station::LineRemedy;

use super::lexer::{Token, line_at};
use crate::cell::explain::{explain_limit, explain_sag, explain_unreachable_pose, leveling_angle};
use crate::display_units::DisplayUnits;
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
pub fn explain(
    robot: &HybridRobot,
    text: &str,
    error: &ProgramError,
    units: DisplayUnits,
) -> Error<Explained> {
    let mut message = message(robot, error, units);
    if let ProgramProblem::Unknown { found, known, .. } = &error.problem {
        let lower = found.to_lowercase();
        // Names are case sensitive, and incorrect case is a common typing error.
        let alike = known.iter().find(|name| name.to_lowercase() == lower);
        let nearest = alike.cloned().or_else(|| nearest(found, known.iter().map(String::as_str)));
        message += &match difference(found, known) {
            Some(difference) => format!("; names can contain `-`: write `{difference}`"),
            None => suggestion(&nearest),
        };
    }
    Error { place: shown(text, error.place), problem: Box::new(Explained { message }) }
}

/// A difference that was written as one name: `n-1` for `n - 1`.
fn difference(found: &str, known: &[String]) -> Option<String> {
    let (left, right) = found.split_once('-')?;
    let is_operand = |text: &str| {
        known.iter().any(|name| name == text) || text.parse::<f64>().is_ok_and(f64::is_finite)
    };
    let names = known.iter().any(|name| name == left || name == right);
    (names && is_operand(left) && is_operand(right)).then(|| format!("{left} - {right}"))
}

/// A problem in units of display and degrees.
fn message(robot: &HybridRobot, error: &ProgramError, units: DisplayUnits) -> String {
    let problem = match &error.problem {
        ProgramProblem::Limits { what, violations } => {
            let limits: Vec<String> =
                violations.iter().map(|limit| explain_limit(robot, limit, units)).collect();
            format!("{what} violates limits: {}", limits.join("; "))
        }
        ProgramProblem::Unreachable { target, effector, loaded, leveling, source } => {
            let load = if *loaded { "loaded" } else { "empty" };
            let why = explain_unreachable_pose(robot, source, units);
            let remedy = leveling.as_ref().map_or_else(String::new, remedy);
            format!("effector {effector}, {load}, does not reach {target}: {why}{remedy}")
        }
        ProgramProblem::InfeasibleLine { station, effector, blocked } => {
            format!(
                "effector {effector} cannot follow the line into {station}: its arm stops {:.1} % along the line, with the wafer {} from the axis that the arm turns about{}",
                blocked.fraction * 1e2,
                units.length(blocked.reach, 1),
                line_remedies(robot, station, &blocked.remedies, units)
            )
        }
        ProgramProblem::Sag { effector, source } => {
            format!("effector {effector} does not carry the wafer: {}", explain_sag(source, units))
        }
        // Other problems have no lengths or angles.
        _ => return error.to_string(),
    };
    problem + &error.note()
}

/// The changes of a station or robot that make a line possible; values of the file are in its units.
fn line_remedies(
    robot: &HybridRobot,
    station: &str,
    remedies: &[LineRemedy],
    units: DisplayUnits,
) -> String {
    if remedies.is_empty() {
        return "; no single change of retract distance, radius, heading or limit makes it possible"
            .to_owned();
    }
    let remedy = |remedy: &LineRemedy| match remedy {
        LineRemedy::Retract(reach) => format!("set retract_mm = {:.0} of {station}", reach * 1e3),
        LineRemedy::Radius(reach) => {
            format!("move {station} to {} from that axis", units.length(*reach, 0))
        }
        LineRemedy::FreeHeading => {
            format!("set approach = \"radial\" of {station}, so that the wafer may turn")
        }
        LineRemedy::Limits { axis, min, max } => {
            let Axis { name, kind, .. } = &robot.axes[*axis];
            let (factor, unit) = match kind {
                AxisKind::Rotary => (1_f64.to_degrees(), "deg"),
                AxisKind::Linear => (1e3, "mm"),
            };
            format!(
                "extend the range of {name} to [{:.0}, {:.0}] {unit}",
                outward(min * factor, f64::floor),
                outward(max * factor, f64::ceil)
            )
        }
    };
    let all: Vec<String> = remedies.iter().map(remedy).collect();
    format!("; any of these helps: {}", all.join(", or "))
}

/// An end of a range, rounded away from its middle; unchanged where it is whole but for round-off.
fn outward(end: f64, round: fn(f64) -> f64) -> f64 {
    let nearest = end.round();
    if (end - nearest).abs() < 1e-6 { nearest } else { round(end) }
}

fn remedy(leveling: &Leveling) -> String {
    let [by, for_arms] = [leveling.angle, leveling.for_deflection].map(f64::to_degrees);
    format!("; level {} by at least {}", leveling.station, leveling_angle(by, for_arms))
}

/// The place in the text, with the width of the marked part.
fn shown(text: &str, at: SourceLocation) -> place::Place {
    let line = line_at(text, at.line);
    let token = line.as_ref().and_then(|line| line.tokens.iter().find(|it| it.column == at.column));
    place::Place {
        line: at.line,
        column: at.column.max(1),
        width: token.map_or(0, Token::width),
        text: line.as_ref().map_or_else(String::new, |line| line.text.to_owned()),
    }
}
