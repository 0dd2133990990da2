//! Syntax tree of a program.

use jointplay_core::spatial::Tilt;

use crate::robot::AxisKind;

/// Location in the text of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash, PartialOrd, Ord)]
pub struct SourceLocation {
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
}

/// A name in a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    /// The text.
    pub text: String,
    /// Location.
    pub place: SourceLocation,
}

/// A slot in a program: a station, and a slot number where the station has more than one.
#[derive(Debug, Clone, PartialEq)]
pub struct SlotName {
    /// The station.
    pub station: Name,
    /// The slot; `None` for the only one.
    pub slot: Option<SlotNumber>,
}

/// Number of a slot, from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SlotNumber {
    /// A literal number.
    Fixed {
        /// The number.
        number: usize,
        /// Location.
        place: SourceLocation,
    },
    /// A number by the counter of an enclosing REPEAT: `n + offset`, or `offset − n` where it counts down.
    Counted {
        /// The counter.
        counter: Name,
        /// Number that the counter is added to or subtracted from.
        offset: i64,
        /// Whether it counts down.
        down: bool,
    },
}

/// A program.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Program {
    /// Main instructions.
    pub body: Vec<Instruction>,
    /// Routines that CALL may name.
    pub routines: Vec<Routine>,
}

/// A routine.
#[derive(Debug, Clone, PartialEq)]
pub struct Routine {
    /// Name.
    pub name: Name,
    /// Instructions.
    pub body: Vec<Instruction>,
}

/// An instruction.
#[derive(Debug, Clone, PartialEq)]
pub struct Instruction {
    /// Location of its first token.
    pub place: SourceLocation,
    /// The command.
    pub command: Command,
}

/// Target of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisTarget {
    /// The axis.
    pub axis: Name,
    /// Whether the position is written as an angle or as a length.
    pub kind: AxisKind,
    /// Target position (m or rad).
    pub position: f64,
}

/// Command of an instruction.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Retract all arms, then move every axis to its home position, the platform level.
    Home,
    /// Move axes to positions, synchronized; the others keep theirs.
    Move {
        /// Targets; one or more.
        targets: Vec<AxisTarget>,
    },
    /// Move the wafer centre of an effector along a straight line by a displacement in the base frame.
    MoveLine {
        /// The effector; `None` for the robot's only one.
        effector: Option<Name>,
        /// Displacement (m).
        by: [f64; 3],
    },
    /// Pick the wafer of a slot.
    Get {
        /// The slot.
        from: SlotName,
        /// The effector; `None` for the only possible one.
        effector: Option<Name>,
    },
    /// Place the wafer into a slot.
    Put {
        /// The slot.
        to: SlotName,
        /// The effector; `None` for the only possible one.
        effector: Option<Name>,
    },
    /// GET, then PUT.
    Transfer {
        /// Slot to pick from.
        from: SlotName,
        /// Slot to place into.
        to: SlotName,
        /// The effector; `None` for the only one that may use both stations.
        effector: Option<Name>,
    },
    /// Pick the wafer of a slot with one effector and place that of another there.
    Swap {
        /// The slot.
        at: SlotName,
        /// Effector that picks.
        get: Name,
        /// Effector that places.
        put: Name,
    },
    /// Move in front of a slot, retracted, at its height and tilt.
    Goto {
        /// The slot.
        to: SlotName,
        /// The effector; `None` for the only possible one.
        effector: Option<Name>,
    },
    /// Dwell.
    Wait {
        /// Duration (s).
        seconds: f64,
    },
    /// Set the fraction of the limits for all following moves.
    Speed {
        /// Share, above 0 and at most 1.
        fraction: f64,
    },
    /// Blend all following moves.
    Blend {
        /// Largest distance of a wafer's centre from the unblended path; 0 brings all axes to rest (m).
        radius: f64,
    },
    /// Tilt the platform in place.
    Tilt {
        /// The tilt.
        tilt: Tilt,
    },
    /// Call a routine.
    Call {
        /// The routine.
        routine: Name,
    },
    /// Repeat instructions.
    Repeat {
        /// Number of passes.
        times: u64,
        /// Name by which SLOT refers to the pass, from 1.
        counter: Option<Name>,
        /// Instructions.
        body: Vec<Instruction>,
    },
}
