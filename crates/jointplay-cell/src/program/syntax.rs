//! Syntax tree of a program.

use super::location::{Name, SourceLocation};
use super::quantity::{Number, Quantity, Unit};

/// A slot in a program: a station, and a slot number where the station has more than one.
#[derive(Debug, Clone, PartialEq)]
pub struct SlotName {
    /// The station.
    pub station: Name,
    /// The slot number, from 1; `None` for the only one.
    pub slot: Option<Number>,
}

/// A program.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Program {
    /// Parameters, each evaluated from those before it.
    pub parameters: Vec<Parameter>,
    /// Main instructions.
    pub body: Vec<Instruction>,
    /// Routines that CALL may name.
    pub routines: Vec<Routine>,
}

/// A parameter of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name.
    pub name: Name,
    /// Value, in the unit.
    pub value: Number,
    /// Unit; `None` for a plain number.
    pub unit: Option<Unit>,
    /// Least and largest value, in the unit.
    pub range: Option<[f64; 2]>,
}

/// A routine.
#[derive(Debug, Clone, PartialEq)]
pub struct Routine {
    /// Name.
    pub name: Name,
    /// Parameters; their use determines whether they are numbers, stations or effectors.
    pub parameters: Vec<Name>,
    /// Instructions.
    pub body: Vec<Instruction>,
}

/// A condition on numbers and on the presence of wafers.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// A comparison of two numbers.
    Comparison {
        /// Left number.
        left: Number,
        /// The relation.
        relation: Relation,
        /// Right number.
        right: Number,
        /// Unit of both numbers, where it is written.
        unit: Option<Unit>,
    },
    /// Whether a slot or an effector holds a wafer.
    Presence {
        /// The slot; without a slot number, it can also be an effector.
        location: SlotName,
        /// Whether a wafer is required; otherwise, the location has to be empty.
        occupied: bool,
    },
    /// The opposite of a condition.
    Not(Box<Condition>),
    /// All of several conditions; two or more.
    All(Vec<Condition>),
    /// Any of several conditions; two or more.
    Any(Vec<Condition>),
}

/// Relation of two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// Less.
    Less,
    /// Less or equal.
    LessOrEqual,
    /// Greater.
    Greater,
    /// Greater or equal.
    GreaterOrEqual,
    /// Equal.
    Equal,
    /// Not equal.
    NotEqual,
}

impl Relation {
    /// Whether two numbers have the relation.
    #[must_use]
    pub fn holds(self, left: f64, right: f64) -> bool {
        match self {
            Self::Less => left < right,
            Self::LessOrEqual => left <= right,
            Self::Greater => left > right,
            Self::GreaterOrEqual => left >= right,
            Self::Equal => left == right,
            Self::NotEqual => left != right,
        }
    }
}

/// Instructions that are executed where a condition holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// The condition.
    pub condition: Condition,
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
    /// Target position: an angle or a length.
    pub position: Quantity,
}

/// Target tilt of the platform.
#[derive(Debug, Clone, PartialEq)]
pub struct TiltTarget {
    /// Tilt angle.
    pub angle: Quantity,
    /// Azimuth of the lowest side.
    pub azimuth: Quantity,
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
        /// Displacement, a length along each axis; `None` for 0.
        by: [Option<Quantity>; 3],
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
        /// Duration.
        duration: Quantity,
    },
    /// Set the fraction of the limits for all following moves.
    Speed {
        /// Share of the limits, above 0 and at most 1.
        fraction: Quantity,
    },
    /// Blend all following moves.
    Blend {
        /// Largest distance of a wafer's centre from the unblended path; `None` brings all axes to rest.
        radius: Option<Quantity>,
    },
    /// Tilt the platform in place.
    Tilt {
        /// The tilt; `None` levels the platform.
        tilt: Option<TiltTarget>,
    },
    /// Call a routine.
    Call {
        /// The routine.
        routine: Name,
        /// Arguments: numbers, or names of stations and effectors.
        arguments: Vec<Number>,
    },
    /// Repeat instructions.
    Repeat {
        /// Number of passes.
        times: Number,
        /// Name of the number of the pass, from 1.
        counter: Option<Name>,
        /// Instructions.
        body: Vec<Instruction>,
    },
    /// Execute the instructions of the first branch whose condition holds.
    If {
        /// Branches; one or more.
        branches: Vec<Branch>,
        /// Instructions for the case that no condition holds.
        otherwise: Vec<Instruction>,
    },
}
