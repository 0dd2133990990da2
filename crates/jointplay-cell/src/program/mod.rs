//! What the robot is told, and the steps that it comes to.

use crate::robot::EffectorId;
use crate::station::SlotId;

/// Where something is said in the text of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
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
    /// Which slot, from 1; `None` says the only one.
    pub slot: Option<SlotNumber>,
}

/// The number of a slot, or the counter of the innermost REPEAT.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SlotNumber {
    /// As written, from 1.
    Fixed(usize),
    /// The pass of the innermost REPEAT, from 1: written `#`.
    Pass,
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

/// What one line says.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// All arms in, then every axis to its home position, the platform level.
    Home,
    /// Axes to positions, each on its own way and all in the same time.
    Move {
        /// Axis and position [m or rad].
        targets: Vec<(Name, f64)>,
    },
    /// The wafer centre of an effector along a straight line by a displacement in the base frame.
    MoveLine {
        /// Which effector.
        effector: Name,
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
        /// From what.
        effector: Option<Name>,
    },
    /// GET, then PUT.
    Transfer {
        /// From where.
        from: SlotName,
        /// To where.
        to: SlotName,
        /// With what.
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
        /// With which effector.
        effector: Option<Name>,
    },
    /// Stand still [s].
    Wait {
        /// How long [s].
        seconds: f64,
    },
    /// All that follows at a share of the limits.
    Speed {
        /// 0 to 1.
        share: f64,
    },
    /// Lean the platform where it stands.
    Tilt {
        /// How it leans.
        tilt: jointplay_core::spatial::Tilt,
    },
    /// Run a routine.
    Call {
        /// Which.
        routine: Name,
    },
    /// Run instructions several times.
    Repeat {
        /// How often.
        times: usize,
        /// What.
        body: Vec<Instruction>,
    },
}

/// How axes go from one position to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Path {
    /// Each axis on its own way, all in the same time.
    Axes,
    /// The wafer centre of this effector on a straight line, its plane turning evenly.
    Line(EffectorId),
    /// Standing still [s].
    Still(f64),
}

/// What part of an instruction a step is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Axes to where they were told.
    Move,
    /// Arms in, where they were not.
    TuckIn,
    /// Turn toward the station, retracted and level.
    Turn,
    /// To the height and the tilt of entering.
    Enter,
    /// Out into the station.
    Extend,
    /// Up with the wafer, by the stroke.
    Lift,
    /// Down, the wafer staying.
    Lower,
    /// Out of the station.
    Retract,
    /// The platform level again.
    Level,
    /// Standing still.
    Wait,
}

/// What happens to wafers at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Handover {
    /// The effector takes the wafer of the slot, somewhere within the step.
    Taken(EffectorId, SlotId),
    /// The effector leaves its wafer in the slot.
    Left(EffectorId, SlotId),
}

/// One motion of all axes from rest to rest, with everything resolved.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Index of the instruction in the order of running.
    pub instruction: usize,
    /// Where that instruction is written.
    pub place: Place,
    /// What part of it this is.
    pub phase: Phase,
    /// Positions of all axes at its start [m and rad].
    pub from: Vec<f64>,
    /// Positions of all axes at its end [m and rad].
    pub to: Vec<f64>,
    /// The way between.
    pub path: Path,
    /// Share of the limits, 0 to 1.
    pub speed: f64,
    /// Largest speed of the wafer centre along a line [m/s], where the step has one.
    pub line_speed: Option<f64>,
    /// Effectors that carry a wafer during the step; a handover counts as loaded.
    pub loaded: Vec<EffectorId>,
    /// What happens to wafers.
    pub handover: Option<Handover>,
    /// Slot that is reached into, whose own bodies and wafers are near by intent.
    pub slot: Option<SlotId>,
}
