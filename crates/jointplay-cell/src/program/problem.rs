//! What is wrong with a program in its cell.

use super::Place;
use crate::robot::{AxisKind, LimitViolation};
use crate::wafer::{SagError, Unreachable};

/// Something wrong with a program in its cell, at its place.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{problem}{}", self.repetitions())]
pub struct ProgramError {
    /// Where in its text.
    pub place: Place,
    /// What is wrong, the first time that this place is run.
    pub problem: ProgramProblem,
    /// How many times more the same goes wrong at this place.
    pub more: usize,
}

impl ProgramError {
    /// Text about the repetitions of the problem at its location; empty where there are none.
    #[must_use]
    pub fn repetitions(&self) -> String {
        match self.more {
            0 => String::new(),
            1 => "; and once more where this line is repeated".to_owned(),
            more => format!("; and {more} times more where this line is repeated"),
        }
    }
}

/// What can be wrong with a program in its cell. Lengths are in m, angles in rad; messages say mm and degrees.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProgramProblem {
    /// A name that is none of the known ones.
    #[error("{what} `{found}` is not known; known: {}", listed(.known))]
    Unknown {
        /// What it should name.
        what: &'static str,
        /// What was found.
        found: String,
        /// All that could stand there.
        known: Vec<String>,
    },
    /// A second thing of the same name.
    #[error("{what} `{name}` is there already, in line {line}")]
    Twice {
        /// What has the name.
        what: &'static str,
        /// The name.
        name: String,
        /// Where the first one stands.
        line: usize,
    },
    /// An angle for an axis that slides, or a length for one that turns.
    #[error("axis {axis} {}", match .kind {
        AxisKind::Rotary => "turns: its position is in deg",
        AxisKind::Linear => "slides: its position is in mm",
    })]
    AxisUnit {
        /// Its name.
        axis: String,
        /// What its position is.
        kind: AxisKind,
    },
    /// No effector is named where several could be meant.
    #[error("{where_}: say WITH which effector: {}", listed(.known))]
    WhichEffector {
        /// What several effectors may use.
        where_: String,
        /// Those that may.
        known: Vec<String>,
    },
    /// An effector that a station is closed to, or that does not exist for it.
    #[error("effector {effector} may not use station {station}; it is open to: {}", listed(.known))]
    NotAllowed {
        /// Name of the effector.
        effector: String,
        /// Name of the station.
        station: String,
        /// Those that may.
        known: Vec<String>,
    },
    /// Stations that have no effector in common.
    #[error("no effector may use both {from} and {to}: {from} is open to {}, {to} to {}", listed(.may_from), listed(.may_to))]
    NoneForBoth {
        /// Name of one station.
        from: String,
        /// Name of the other.
        to: String,
        /// Who may use the one.
        may_from: Vec<String>,
        /// Who may use the other.
        may_to: Vec<String>,
    },
    /// Two effectors that have to be two.
    #[error(
        "SWAP takes two effectors, one that fetches and one that lays down; effector {effector} cannot be both"
    )]
    SameEffector {
        /// Name of the one.
        effector: String,
    },
    /// No slot is named where there are several.
    #[error("station {station} has {slots} slots: say which, as in `{station} SLOT 1`")]
    WhichSlot {
        /// Name of the station.
        station: String,
        /// How many it has.
        slots: usize,
    },
    /// A slot that the station does not have.
    #[error("station {station} has no slot {found}; it has {}", slots_of(*.slots))]
    NoSlot {
        /// Name of the station.
        station: String,
        /// Which was asked for.
        found: i128,
        /// How many there are, from 1.
        slots: usize,
    },
    /// A routine that calls itself, by itself or by others.
    #[error("this CALL never ends: {}", .routines.join(" calls "))]
    Recursive {
        /// The circle; the first name is also the last.
        routines: Vec<String>,
    },
    /// Routines that call routines that call routines.
    #[error("CALL and REPEAT stand within each other more than {allowed} deep")]
    TooDeep {
        /// How deep they may.
        allowed: usize,
    },
    /// More than anyone waits for.
    #[error(
        "{what} comes to {found} instructions one after the other, but at most {allowed} are allowed; lower the number of passes"
    )]
    TooLong {
        /// Which command: REPEAT, CALL or the program.
        what: &'static str,
        /// How many, where they can be counted.
        found: Count,
        /// How many may be.
        allowed: u64,
    },
    /// GET where there is nothing.
    #[error("{slot} is empty: {}", match .since {
        None => "it has no wafer at the start, and none was put there since".to_owned(),
        Some(line) => format!("its wafer was taken in line {line}"),
    })]
    EmptySlot {
        /// Which slot.
        slot: String,
        /// The line that took its wafer; `None` where it never had one.
        since: Option<usize>,
    },
    /// GET with an effector that has its hands full.
    #[error("effector {effector} already carries a wafer, {}; PUT that first", since_line(.since))]
    EffectorLoaded {
        /// Name of the effector.
        effector: String,
        /// The line that took it; `None` for the start.
        since: Option<usize>,
    },
    /// PUT where there is a wafer already.
    #[error("{slot} already holds a wafer, {}; GET that first", since_line(.since))]
    SlotOccupied {
        /// Which slot.
        slot: String,
        /// The line that put it there; `None` for the start.
        since: Option<usize>,
    },
    /// PUT without a wafer.
    #[error("effector {effector} carries no wafer{}; GET one first", match .since {
        None => String::new(),
        Some(line) => format!(" since line {line}"),
    })]
    EffectorEmpty {
        /// Name of the effector.
        effector: String,
        /// The line that put its wafer down; `None` where it never had one.
        since: Option<usize>,
    },
    /// A speed, a time or a displacement that is none.
    #[error("{what} is {value}, but has to be {allowed}")]
    Range {
        /// What.
        what: &'static str,
        /// What was found.
        value: f64,
        /// What it may be.
        allowed: &'static str,
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
        /// Its name.
        effector: String,
        /// Why.
        source: Box<SagError>,
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
        /// Correction of the station that would make the target reachable, where its tilt is the obstacle.
        leveling: Option<Leveling>,
        /// The obstacle.
        source: Box<Unreachable>,
    },
}

/// A station to level so that the platform can follow its tilt.
#[derive(Debug, Clone, PartialEq)]
pub struct Leveling {
    /// Name of the station.
    pub station: String,
    /// Least angle by which to level it [rad].
    pub angle: f64,
}

/// A number of instructions that may be beyond counting.
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

/// Most names listed in a message.
const MOST_LISTED: usize = 16;

fn listed(names: &[String]) -> String {
    match names.len() {
        0 => "none".to_owned(),
        count if count <= MOST_LISTED => names.join(", "),
        count => format!("{} and {} more", names[..MOST_LISTED].join(", "), count - MOST_LISTED),
    }
}

fn violated(violations: &[LimitViolation]) -> String {
    violations.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

fn since_line(since: &Option<usize>) -> String {
    since.map_or_else(|| "from the start".to_owned(), |line| format!("since line {line}"))
}

fn slots_of(slots: usize) -> String {
    if slots == 1 { "one slot, 1".to_owned() } else { format!("slots 1 to {slots}") }
}
