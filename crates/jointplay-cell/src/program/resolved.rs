//! A program with its names resolved in a cell.

use jointplay_core::spatial::Tilt;

use super::syntax::SourceLocation;
use crate::robot::EffectorId;

/// A program with its names resolved.
pub(super) struct ResolvedProgram {
    pub(super) body: Vec<ResolvedInstruction>,
    pub(super) routines: Vec<Vec<ResolvedInstruction>>,
}

/// An instruction with its names resolved.
pub(super) struct ResolvedInstruction {
    pub(super) place: SourceLocation,
    pub(super) command: ResolvedCommand,
}

/// A command with its names resolved.
pub(super) enum ResolvedCommand {
    Home,
    Move(Vec<(usize, f64)>),
    MoveLine {
        effector: EffectorId,
        by: [f64; 3],
    },
    Get {
        from: ResolvedSlot,
        effector: EffectorId,
    },
    Put {
        to: ResolvedSlot,
        effector: EffectorId,
    },
    Transfer {
        from: ResolvedSlot,
        to: ResolvedSlot,
        effector: EffectorId,
    },
    Swap {
        at: ResolvedSlot,
        get: EffectorId,
        put: EffectorId,
    },
    Goto {
        to: ResolvedSlot,
        effector: EffectorId,
    },
    Wait(f64),
    Speed(f64),
    Blend(f64),
    Tilt(Tilt),
    Call(usize),
    Repeat {
        times: u64,
        body: Vec<ResolvedInstruction>,
    },
    /// A command with an unknown name: the positions of wafers are unknown after it.
    Unresolved,
}

/// A slot whose number may depend on the pass of a REPEAT.
#[derive(Clone, Copy)]
pub(super) struct ResolvedSlot {
    pub(super) station: usize,
    pub(super) number: ResolvedSlotNumber,
    pub(super) place: SourceLocation,
}

/// Number of a slot, possibly by a counter.
#[derive(Clone, Copy)]
pub(super) enum ResolvedSlotNumber {
    Fixed(i128),
    /// `offset ± pass` of a REPEAT, by its index from the outermost REPEAT of the body or routine.
    Counted {
        repeat: usize,
        offset: i64,
        down: bool,
    },
}

impl ResolvedProgram {
    /// Marks the REPEAT or CALL at a location as unresolved; returns whether there is one.
    pub(super) fn mark_unresolved(&mut self, place: SourceLocation) -> bool {
        std::iter::once(&mut self.body)
            .chain(&mut self.routines)
            .any(|body| mark_unresolved(body, place))
    }
}

fn mark_unresolved(body: &mut [ResolvedInstruction], place: SourceLocation) -> bool {
    body.iter_mut().any(|instruction| match &mut instruction.command {
        command @ (ResolvedCommand::Repeat { .. } | ResolvedCommand::Call(_))
            if instruction.place == place =>
        {
            *command = ResolvedCommand::Unresolved;
            true
        }
        ResolvedCommand::Repeat { body, .. } => mark_unresolved(body, place),
        _ => false,
    })
}
