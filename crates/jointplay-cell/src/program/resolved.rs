//! A program with its names resolved in a cell.

use jointplay_core::expression::Expression;

use super::location::SourceLocation;
use super::quantity::AllowedValues;
use super::syntax::Relation;
use crate::robot::EffectorId;

/// A program with its names resolved.
pub(super) struct ResolvedProgram {
    pub(super) body: Vec<ResolvedInstruction>,
    pub(super) routines: Vec<ResolvedRoutine>,
}

/// A routine with its names resolved.
pub(super) struct ResolvedRoutine {
    /// Names of its parameters, for messages.
    pub(super) parameters: Vec<String>,
    pub(super) body: Vec<ResolvedInstruction>,
}

/// An instruction with its names resolved.
pub(super) struct ResolvedInstruction {
    pub(super) place: SourceLocation,
    pub(super) command: ResolvedCommand,
}

/// A command with its names resolved.
pub(super) enum ResolvedCommand {
    Home,
    Move(Vec<(usize, ResolvedQuantity)>),
    MoveLine {
        effector: EffectorChoice,
        by: [Option<ResolvedQuantity>; 3],
    },
    Get {
        from: ResolvedSlot,
        effector: EffectorChoice,
    },
    Put {
        to: ResolvedSlot,
        effector: EffectorChoice,
    },
    Transfer {
        from: ResolvedSlot,
        to: ResolvedSlot,
        effector: EffectorChoice,
    },
    Swap {
        at: ResolvedSlot,
        get: EffectorChoice,
        put: EffectorChoice,
    },
    Goto {
        to: ResolvedSlot,
        effector: EffectorChoice,
    },
    Wait(ResolvedQuantity),
    Speed(ResolvedQuantity),
    Blend(Option<ResolvedQuantity>),
    Tilt(Option<ResolvedTilt>),
    Call {
        routine: usize,
        arguments: Vec<ResolvedArgument>,
    },
    Repeat {
        times: ResolvedQuantity,
        /// Name of the counter, for messages.
        counter: Option<String>,
        body: Vec<ResolvedInstruction>,
    },
    If {
        branches: Vec<ResolvedBranch>,
        otherwise: Vec<ResolvedInstruction>,
    },
    /// A command with an unknown name: the positions of wafers are unknown after it.
    Invalid,
}

/// A variable of an expression.
#[derive(Clone, Copy)]
pub(super) enum Variable {
    /// The value of a parameter of the program, or π.
    Constant(f64),
    /// The number of the pass of a REPEAT, by its index from the outermost REPEAT of the body or routine.
    Counter(usize),
    /// An argument of the routine, by its index.
    Argument(usize),
}

/// A number with its names resolved.
pub(super) struct ResolvedNumber {
    pub(super) place: SourceLocation,
    pub(super) expression: Expression<Variable>,
}

impl ResolvedNumber {
    /// The value where it depends on no counter and no argument.
    pub(super) fn constant(&self) -> Option<f64> {
        let value_of = |variable: &Variable| match variable {
            Variable::Constant(value) => Ok(*value),
            Variable::Counter(_) | Variable::Argument(_) => Err(()),
        };
        self.expression.evaluate(value_of).ok()
    }
}

/// A number with its allowed values.
pub(super) struct ResolvedQuantity {
    /// Name of the quantity in messages.
    pub(super) what: &'static str,
    pub(super) number: ResolvedNumber,
    pub(super) allowed: AllowedValues,
}

/// A tilt with its names resolved.
pub(super) struct ResolvedTilt {
    pub(super) angle: ResolvedQuantity,
    pub(super) azimuth: ResolvedQuantity,
}

/// A station, or the argument of a routine that is one.
#[derive(Clone, Copy)]
pub(super) enum StationReference {
    Fixed(usize),
    Argument(usize),
}

/// An effector as named.
#[derive(Clone, Copy)]
pub(super) enum EffectorReference {
    Fixed(EffectorId),
    Argument(usize),
    /// The only one that the stations, or the robot, allow.
    Only,
}

/// An effector as named, and the place of messages about it.
#[derive(Clone, Copy)]
pub(super) struct EffectorChoice {
    pub(super) named: EffectorReference,
    pub(super) place: SourceLocation,
}

/// A slot whose station and number may depend on arguments and counters.
pub(super) struct ResolvedSlot {
    pub(super) station: StationReference,
    /// Place of the station's name.
    pub(super) place: SourceLocation,
    /// `None` for the only slot.
    pub(super) number: Option<ResolvedNumber>,
}

/// An argument of a routine.
pub(super) enum ResolvedArgument {
    Number(ResolvedNumber),
    Station(StationReference),
    Effector(EffectorReference),
    /// The argument of the calling routine that is a station or an effector.
    Location(usize),
    /// An argument that the routine does not use.
    Unused,
}

/// A slot or an effector.
pub(super) enum ResolvedLocation {
    Slot(ResolvedSlot),
    Effector(EffectorId),
    /// An argument that is an effector or a station.
    Argument {
        index: usize,
        place: SourceLocation,
    },
}

/// A condition with its names resolved.
pub(super) enum ResolvedCondition {
    Comparison { left: ResolvedNumber, relation: Relation, right: ResolvedNumber },
    Presence { location: ResolvedLocation, occupied: bool },
    Not(Box<ResolvedCondition>),
    All(Vec<ResolvedCondition>),
    Any(Vec<ResolvedCondition>),
}

/// Instructions of a condition.
pub(super) struct ResolvedBranch {
    pub(super) condition: ResolvedCondition,
    pub(super) body: Vec<ResolvedInstruction>,
}

impl ResolvedProgram {
    /// Marks the REPEAT or CALL at a location as unresolved; returns whether there is one.
    pub(super) fn mark_unresolved(&mut self, place: SourceLocation) -> bool {
        std::iter::once(&mut self.body)
            .chain(self.routines.iter_mut().map(|routine| &mut routine.body))
            .any(|body| mark_unresolved(body, place))
    }
}

fn mark_unresolved(body: &mut [ResolvedInstruction], place: SourceLocation) -> bool {
    body.iter_mut().any(|instruction| match &mut instruction.command {
        command @ (ResolvedCommand::Repeat { .. } | ResolvedCommand::Call { .. })
            if instruction.place == place =>
        {
            *command = ResolvedCommand::Invalid;
            true
        }
        ResolvedCommand::Repeat { body, .. } => mark_unresolved(body, place),
        ResolvedCommand::If { branches, otherwise } => {
            branches.iter_mut().any(|branch| mark_unresolved(&mut branch.body, place))
                || mark_unresolved(otherwise, place)
        }
        _ => false,
    })
}
