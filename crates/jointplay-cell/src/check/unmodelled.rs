//! What the check of collisions does not include, since the cell does not describe it.

use crate::workcell::{Cell, ParentFrame};

/// A part of a cell without bodies, which is not checked for collisions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unmodelled {
    /// The links of an arm, by its index.
    Arm(usize),
    /// Everything around the robot.
    Surroundings,
}

/// Arms and surroundings without bodies.
#[must_use]
pub fn unmodelled(cell: &Cell) -> Vec<Unmodelled> {
    let has =
        |is_part: &dyn Fn(ParentFrame) -> bool| cell.bodies.iter().any(|body| is_part(body.parent));
    let is_of = |arm: usize| {
        has(&|parent| matches!(parent, ParentFrame::Link { arm: of, .. } if of == arm))
    };
    let arms = (0..cell.robot.arms.len()).filter(|&arm| !is_of(arm)).map(Unmodelled::Arm);
    let around = !has(&|parent| parent == ParentFrame::World);
    arms.chain(around.then_some(Unmodelled::Surroundings)).collect()
}
