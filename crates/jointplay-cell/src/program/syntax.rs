//! A program as it is written.

use jointplay_core::spatial::Tilt;

use crate::robot::AxisKind;

/// Where something is said in the text of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash, PartialOrd, Ord)]
pub struct Place {
    /// Counted from 1.
    pub line: usize,
    /// Counted from 1, in characters.
    pub column: usize,
}

/// A name as it is written, with its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    /// The text.
    pub text: String,
    /// Where it stands.
    pub place: Place,
}

/// A slot as it is written: a station, and a slot number where the station has more than one.
#[derive(Debug, Clone, PartialEq)]
pub struct SlotName {
    /// Which station.
    pub station: Name,
    /// Which slot; `None` says the only one.
    pub slot: Option<SlotNumber>,
}

/// The number of a slot, from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SlotNumber {
    /// As written.
    Fixed {
        /// The number.
        number: usize,
        /// Where it stands.
        place: Place,
    },
    /// From the counter of a REPEAT around it: `n + offset`, or `offset − n` where it counts down.
    Counted {
        /// Which counter.
        counter: Name,
        /// What is added to it, or what it is taken from.
        offset: i64,
        /// Whether it counts down.
        down: bool,
    },
}

/// A program as it is written.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Program {
    /// What is run.
    pub body: Vec<Instruction>,
    /// What CALL may name.
    pub routines: Vec<Routine>,
}

/// Instructions with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Routine {
    /// What it is called.
    pub name: Name,
    /// What it does.
    pub body: Vec<Instruction>,
}

/// One line of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct Instruction {
    /// Where it starts.
    pub place: Place,
    /// What it says.
    pub command: Command,
}

/// Where an axis goes.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisTarget {
    /// Which axis.
    pub axis: Name,
    /// Whether the position is written as an angle or as a length.
    pub kind: AxisKind,
    /// Where to [m or rad].
    pub position: f64,
}

/// What one line says.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// All arms in, then every axis to its home position, the platform level.
    Home,
    /// Axes to positions, each on its own way and all in the same time; the others stay.
    Move {
        /// One or more.
        targets: Vec<AxisTarget>,
    },
    /// The wafer centre of an effector along a straight line by a displacement in the base frame.
    MoveLine {
        /// Which effector; `None` takes the robot's only one.
        effector: Option<Name>,
        /// How far [m].
        by: [f64; 3],
    },
    /// Fetch the wafer of a slot.
    Get {
        /// From where.
        from: SlotName,
        /// With what; `None` takes the only one that may.
        effector: Option<Name>,
    },
    /// Lay the wafer into a slot.
    Put {
        /// To where.
        to: SlotName,
        /// From what; `None` takes the only one that may.
        effector: Option<Name>,
    },
    /// GET, then PUT.
    Transfer {
        /// From where.
        from: SlotName,
        /// To where.
        to: SlotName,
        /// With what; `None` takes the only one that may use both stations.
        effector: Option<Name>,
    },
    /// Fetch the wafer of a slot with one effector and lay that of another there.
    Swap {
        /// Which slot.
        at: SlotName,
        /// What fetches.
        get: Name,
        /// What lays down.
        put: Name,
    },
    /// Before a slot, retracted, at its height and tilt.
    Goto {
        /// Which slot.
        to: SlotName,
        /// With which effector; `None` takes the only one that may.
        effector: Option<Name>,
    },
    /// Stand still.
    Wait {
        /// How long [s].
        seconds: f64,
    },
    /// All that follows at a share of the limits.
    Speed {
        /// Above 0, to 1.
        share: f64,
    },
    /// All that follows runs into each other at its corners.
    Blend {
        /// How far a wafer's centre may stray there from the way without it; 0 brings all axes to rest [m].
        radius: f64,
    },
    /// Lean the platform where it stands.
    Tilt {
        /// How it leans.
        tilt: Tilt,
    },
    /// Run a routine.
    Call {
        /// Which.
        routine: Name,
    },
    /// Run instructions several times.
    Repeat {
        /// How often.
        times: u64,
        /// What SLOT calls the pass, from 1.
        counter: Option<Name>,
        /// What.
        body: Vec<Instruction>,
    },
}
