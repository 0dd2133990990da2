//! Errors of a program in its cell.

use super::location::SourceLocation;
use super::parameter_kind::ParameterKind;
use super::quantity::{AllowedValues, Unit};
use crate::robot::{AxisKind, LimitViolation};
use crate::station::InfeasibleLine;
use crate::wafer::{SagError, Unreachable};

/// An error of a program in its cell.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{problem}{}", self.note())]
pub struct ProgramError {
    /// Location in the text.
    pub place: SourceLocation,
    /// The problem at its first occurrence.
    pub problem: ProgramProblem,
    /// Counters, arguments and calls of the first occurrence.
    pub context: ErrorContext,
    /// Number of further occurrences at this location.
    pub repetitions: usize,
}

/// State of a program at the occurrence of an error.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ErrorContext {
    /// Counters and numeric arguments with their values, outermost first.
    pub variables: Vec<(String, f64)>,
    /// Locations of the calls of the routines around the instruction, innermost first.
    pub calls: Vec<SourceLocation>,
}

impl ProgramError {
    /// An error outside of the expansion of the program.
    #[must_use]
    pub fn new(place: SourceLocation, problem: ProgramProblem) -> Self {
        Self { place, problem, context: ErrorContext::default(), repetitions: 0 }
    }

    /// Text about counters, calls and repetitions of the problem; empty where there are none.
    #[must_use]
    pub fn note(&self) -> String {
        let ErrorContext { variables, calls } = &self.context;
        let variables =
            variables.iter().map(|(name, number)| format!("{name} = {}", value(*number, None)));
        let calls = calls.iter().map(|call| format!("called in line {}", call.line));
        let context: Vec<String> = variables.chain(calls).collect();
        let context = match &context[..] {
            [] => String::new(),
            some => format!(" ({})", some.join(", ")),
        };
        context
            + &match self.repetitions {
                0 => String::new(),
                1 => "; and once more where this line is repeated".to_owned(),
                repetitions => {
                    format!("; and {repetitions} times more where this line is repeated")
                }
            }
    }
}

/// Problem of a program in its cell. Lengths are in m, angles in rad.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProgramProblem {
    /// An unknown name.
    #[error("{what} `{found}` is not known; known: {}", listed(.known))]
    Unknown {
        /// The kind of thing named.
        what: &'static str,
        /// The name found.
        found: String,
        /// All known names.
        known: Vec<String>,
    },
    /// A parameter that is declared after its use.
    #[error(
        "the parameter `{name}` is declared later, in line {line}; move its declaration before this line"
    )]
    DeclaredLater {
        /// The name.
        name: String,
        /// Line of the declaration.
        line: usize,
    },
    /// A name that is defined twice.
    #[error("{what} `{name}` is already defined in line {line}")]
    Duplicate {
        /// The kind of thing named.
        what: &'static str,
        /// The name.
        name: String,
        /// Line of the first use.
        line: usize,
    },
    /// An angle for a linear axis, or a length for a rotary one.
    #[error("axis {axis} {}", match .kind {
        AxisKind::Rotary => "turns: its position is in deg",
        AxisKind::Linear => "slides: its position is in mm",
    })]
    AxisUnit {
        /// Name of the axis.
        axis: String,
        /// Kind of the axis.
        kind: AxisKind,
    },
    /// No effector is named where several are possible.
    #[error("{context}: name the effector with WITH: {}", listed(.known))]
    WhichEffector {
        /// Reason for which several effectors are possible.
        context: String,
        /// Possible effectors.
        known: Vec<String>,
    },
    /// An effector that the station is not open to.
    #[error("effector {effector} may not use station {station}; it is open to: {}", listed(.known))]
    NotAllowed {
        /// Name of the effector.
        effector: String,
        /// Name of the station.
        station: String,
        /// Effectors that the station is open to.
        known: Vec<String>,
    },
    /// Stations that have no effector in common.
    #[error("no effector may use both {from} and {to}: {from} is open to {}, {to} to {}", listed(.may_from), listed(.may_to))]
    NoCommonEffector {
        /// Name of the first station.
        from: String,
        /// Name of the second station.
        to: String,
        /// Effectors that the first station is open to.
        may_from: Vec<String>,
        /// Effectors that the second station is open to.
        may_to: Vec<String>,
    },
    /// The same effector twice in a SWAP.
    #[error(
        "SWAP needs two effectors, one that picks and one that places; effector {effector} cannot do both"
    )]
    SameEffector {
        /// Name of the effector.
        effector: String,
    },
    /// No slot is named where the station has several.
    #[error("station {station} has {slots} slots: name one, as in `{station} SLOT 1`")]
    WhichSlot {
        /// Name of the station.
        station: String,
        /// Number of slots.
        slots: usize,
    },
    /// A slot that the station does not have.
    #[error("station {station} has no slot {}; it has {}{}", value(*.found, None), slots_of(*.slots), if .found.fract() == 0.0 { "" } else { ", numbered in whole numbers" })]
    NoSlot {
        /// Name of the station.
        station: String,
        /// The slot number found.
        found: f64,
        /// Number of slots; they are counted from 1.
        slots: usize,
    },
    /// A slot number whose expression has no finite value.
    #[error("the slot number for station {station} is {}: its expression divides by zero, overflows or is not defined; it has to be a whole number, and the station has {}", value(*.found, None), slots_of(*.slots))]
    SlotNotFinite {
        /// Name of the station.
        station: String,
        /// The value found.
        found: f64,
        /// Number of slots; they are counted from 1.
        slots: usize,
    },
    /// A routine that calls itself, directly or through others.
    #[error("this CALL never ends: {}", .routines.join(" calls "))]
    Recursive {
        /// Names of the routines of the cycle; the first is also the last.
        routines: Vec<String>,
    },
    /// CALL, REPEAT and IF are nested too deeply.
    #[error("CALL, REPEAT and IF are nested more than {allowed} deep")]
    TooDeep {
        /// Largest depth.
        allowed: usize,
    },
    /// The program expands to too many instructions.
    #[error(
        "{what} expands to {found} instructions, but at most {allowed} are allowed; lower the number of passes"
    )]
    TooLong {
        /// The construct: REPEAT, CALL or the program.
        what: &'static str,
        /// Number of instructions.
        found: Count,
        /// Largest number of instructions.
        allowed: u64,
    },
    /// GET from an empty slot.
    #[error("{slot} is empty{}; PUT a wafer there first", since_line(.changed_at_line))]
    EmptySlot {
        /// The slot.
        slot: String,
        /// Line that picked its wafer; `None` where there never was one.
        changed_at_line: Option<usize>,
    },
    /// GET with an effector that carries a wafer.
    #[error("effector {effector} already carries a wafer{}; PUT that first", since_line(.changed_at_line))]
    EffectorLoaded {
        /// Name of the effector.
        effector: String,
        /// Line that picked the wafer; `None` for the start.
        changed_at_line: Option<usize>,
    },
    /// PUT into a slot that holds a wafer.
    #[error("{slot} already holds a wafer{}; GET that first", since_line(.changed_at_line))]
    SlotOccupied {
        /// The slot.
        slot: String,
        /// Line that placed the wafer; `None` for the start.
        changed_at_line: Option<usize>,
    },
    /// PUT with an effector that carries no wafer.
    #[error("effector {effector} carries no wafer{}; GET one first", since_line(.changed_at_line))]
    EffectorEmpty {
        /// Name of the effector.
        effector: String,
        /// Line that placed the wafer; `None` where there never was one.
        changed_at_line: Option<usize>,
    },
    /// An expression whose value is not allowed.
    #[error("{what} is {}, but has to be {allowed}", value(*.found, .allowed.unit))]
    Value {
        /// The quantity.
        what: &'static str,
        /// The value found, in the unit of the allowed values.
        found: f64,
        /// Allowed values.
        allowed: AllowedValues,
    },
    /// A parameter of the program out of its range.
    #[error("the parameter {name} is {}, but has to be {}", value(*.found, *.unit), match .range {
        Some([min, max]) => format!("from {min} to {}", value(*max, *.unit)),
        None => "a finite number".to_owned(),
    })]
    Parameter {
        /// Name of the parameter.
        name: String,
        /// The value found, in the unit.
        found: f64,
        /// Unit of the parameter.
        unit: Option<Unit>,
        /// Least and largest value, in the unit.
        range: Option<[f64; 2]>,
    },
    /// An expression of a comparison or an argument whose value is infinite or not a number.
    #[error("{what} is {}, but has to be a finite number", value(*.found, None))]
    NotFinite {
        /// The number.
        what: &'static str,
        /// The value found.
        found: f64,
    },
    /// Too few or too many arguments of a routine.
    #[error("the routine {routine} has {}, but is called with {found}", match &.parameters[..] {
        [] => "no parameters".to_owned(),
        [one] => format!("1 parameter ({one})"),
        some => format!("{} parameters ({})", some.len(), some.join(", ")),
    })]
    ArgumentCount {
        /// Name of the routine.
        routine: String,
        /// Names of its parameters.
        parameters: Vec<String>,
        /// Number of arguments found.
        found: usize,
    },
    /// An argument that is not the name that the routine needs.
    #[error("the parameter {name} of {routine} is {kind}: name one")]
    ArgumentKind {
        /// Name of the routine.
        routine: String,
        /// Name of the parameter.
        name: String,
        /// Kind of the parameter.
        kind: ParameterKind,
    },
    /// A parameter of a routine that is used as two kinds.
    #[error("the parameter {name} is used as {kind} here, but as {before} in line {line}")]
    ParameterUse {
        /// Name of the parameter.
        name: String,
        /// Kind of its first use.
        before: ParameterKind,
        /// Line of its first use.
        line: usize,
        /// Kind of this use.
        kind: ParameterKind,
    },
    /// A name of a station and of an effector.
    #[error("`{name}` is a station and an effector; write `{name} SLOT 1` for the station")]
    AmbiguousLocation {
        /// The name.
        name: String,
    },
    /// The program expands to too many instructions, for numbers of passes that are known during the expansion only.
    #[error(
        "the program expands to more than {allowed} instructions, and reaches this number here; lower the number of passes"
    )]
    LimitReached {
        /// Largest number of instructions.
        allowed: u64,
    },
    /// Positions that violate limits of axes or of the platform.
    #[error("{what} violates limits: {}", violated(.violations))]
    Limits {
        /// The command.
        what: &'static str,
        /// Limits that it violates.
        violations: Vec<LimitViolation>,
    },
    /// A wafer that its supports do not carry.
    #[error("effector {effector} does not carry the wafer: {source}")]
    Sag {
        /// Name of the effector.
        effector: String,
        /// The reason.
        source: Box<SagError>,
    },
    /// A line into a station that the arm cannot follow.
    #[error(
        "effector {effector} cannot follow the line into {station}: it stops at {} of it, {} m from the axis that the arm turns about", .blocked.fraction, .blocked.reach
    )]
    InfeasibleLine {
        /// Name of the station.
        station: String,
        /// Name of the effector.
        effector: String,
        /// The point at which the motion ends, and remedies.
        blocked: Box<InfeasibleLine>,
    },
    /// A target that the effector does not reach.
    #[error("effector {effector}, {}, does not reach {target}: {source}", if *.loaded { "loaded" } else { "empty" })]
    Unreachable {
        /// The target and its slot.
        target: String,
        /// Name of the effector.
        effector: String,
        /// Whether the effector carries a wafer.
        loaded: bool,
        /// Correction of the station that would make the target reachable, where its tilt is the cause.
        leveling: Option<Leveling>,
        /// The cause.
        source: Box<Unreachable>,
    },
}

impl ProgramProblem {
    /// Whether the program is valid, but the robot cannot execute it: out of reach, beyond limits, or along lines that its arm cannot follow.
    #[must_use]
    pub fn is_infeasible(&self) -> bool {
        matches!(self, Self::Limits { .. } | Self::Unreachable { .. } | Self::InfeasibleLine { .. })
    }
}

/// A station to level so that the platform can follow its tilt.
#[derive(Debug, Clone, PartialEq)]
pub struct Leveling {
    /// Name of the station.
    pub station: String,
    /// Least angle by which to level it (rad).
    pub angle: f64,
    /// Part of the angle that the compensation of the deflection of the loaded arms needs (rad).
    pub for_deflection: f64,
}

/// Number of instructions; `u64::MAX` also represents all larger numbers, and is displayed in words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Count(pub u64);

impl std::fmt::Display for Count {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            u64::MAX => formatter.write_str("more than can be counted"),
            count => count.fmt(formatter),
        }
    }
}

/// A number with its unit.
fn value(number: f64, unit: Option<Unit>) -> String {
    if number.is_nan() {
        return "not a number".to_owned();
    }
    if number.is_infinite() {
        return "infinite".to_owned();
    }
    // Twelve digits: enough for every number that is typed, and without round-off.
    let rounded = format!("{number:.11e}").parse().unwrap_or(number);
    let is_plain = rounded == 0.0 || (1e-5..1e15).contains(&rounded.abs());
    let text = if is_plain { rounded.to_string() } else { format!("{rounded:e}") };
    unit.map_or_else(|| text.clone(), |unit| format!("{text} {}", unit.symbol()))
}

/// Largest number of names listed in a message.
const MAX_LISTED: usize = 16;

fn listed(names: &[String]) -> String {
    match names.len() {
        0 => "none".to_owned(),
        count if count <= MAX_LISTED => names.join(", "),
        count => format!("{} and {} more", names[..MAX_LISTED].join(", "), count - MAX_LISTED),
    }
}

fn violated(violations: &[LimitViolation]) -> String {
    violations.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

fn since_line(line: &Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!(" since line {line}"))
}

fn slots_of(slots: usize) -> String {
    if slots == 1 { "one slot, 1".to_owned() } else { format!("slots 1 to {slots}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_messages_have_twelve_digits_and_large_ones_an_exponent() {
        for (number, shown) in [
            (25.0, "25"),
            (0.5, "0.5"),
            (0.1 + 0.2, "0.3"),
            (-3.0, "-3"),
            (0.0, "0"),
            (1e300, "1e300"),
            (-1e300 / 3.0, "-3.33333333333e299"),
            (1e-300 / 3.0, "3.33333333333e-301"),
            (f64::NAN, "not a number"),
        ] {
            assert_eq!(value(number, None), shown);
        }
    }
}
