//! The slots that each wafer visits.

use std::collections::BTreeSet;

use crate::program::{Command, Handoff, Instruction, Program, SourceLocation, WaferLocations};
use crate::station::SlotId;
use crate::trajectory::Trajectory;
use crate::workcell::Cell;

/// Slots that each wafer visits in order, and the order in which a program picks them; an optimised program keeps the former.
#[derive(Debug, Clone, PartialEq)]
pub struct WaferFlow {
    /// Routes of the wafers that the program moves, in the order of their first picks.
    pub(super) routes: Vec<Route>,
    /// Slots of wafers that it does not move.
    pub(super) blocked: BTreeSet<SlotId>,
    /// Hand-offs of the program: route, and hand-off.
    pub(super) order: Vec<RoutedHandoff>,
}

/// Slots that a wafer visits.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Route {
    pub(super) slots: Vec<SlotId>,
    /// Number of hand-offs of the program before the pick from each slot but the last.
    pub(super) rank: Vec<usize>,
}

/// Hand-off of the wafer of a route.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct RoutedHandoff {
    /// Index of the route.
    pub(super) route: usize,
    /// The hand-off.
    pub(super) handoff: Handoff,
}

/// Why a program cannot be optimised.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FlowError {
    /// A command other than HOME, GET, PUT, TRANSFER, SWAP, SPEED, BLEND, CALL and REPEAT.
    #[error("line {}: only programs of HOME, GET, PUT, TRANSFER, SWAP, SPEED, BLEND, CALL and REPEAT can be reordered", .place.line)]
    OtherCommand {
        /// Location of the command.
        place: SourceLocation,
    },
    /// A wafer that is on an effector at the start or at the end.
    #[error(
        "wafer {wafer} is on an effector at the start or at the end of the program; it has to be in a slot"
    )]
    WaferOnEffector {
        /// Index of the wafer.
        wafer: usize,
    },
    /// No wafer is moved.
    #[error("the program moves no wafer")]
    NoWafer,
}

impl WaferFlow {
    /// The flow of a program and its trajectory.
    ///
    /// # Errors
    /// [`FlowError`]
    pub fn new(cell: &Cell, program: &Program, trajectory: &Trajectory) -> Result<Self, FlowError> {
        let bodies =
            std::iter::once(&program.body).chain(program.routines.iter().map(|one| &one.body));
        for body in bodies {
            check_commands(body)?;
        }
        let locations = WaferLocations::of_steps(cell, &trajectory.steps);
        let (mut routes, mut blocked) = (Vec::new(), BTreeSet::new());
        for wafer in locations.wafers() {
            let stays = locations.stays(wafer);
            let slots: Vec<SlotId> = stays.iter().filter_map(|stay| stay.location.slot()).collect();
            let ends = [stays.first(), stays.last()];
            let is_in_slots = ends.iter().flatten().all(|stay| stay.location.slot().is_some());
            if !is_in_slots {
                return Err(FlowError::WaferOnEffector { wafer });
            }
            if stays.len() == 1 {
                blocked.extend(slots);
                continue;
            }
            let picks = stays.iter().filter(|stay| stay.location.slot().is_some());
            let rank: Vec<usize> = picks.filter_map(|stay| stay.departure_step).collect();
            routes.push((wafer, Route { slots, rank }));
        }
        routes.sort_by_key(|(_, route)| route.rank[0]);
        let index_of = |wafer: usize| routes.iter().position(|(known, _)| *known == wafer);
        let changes = locations.location_changes().iter().filter_map(|change| {
            let handoff = trajectory.steps[change.step].handoff?;
            Some(RoutedHandoff { route: index_of(change.wafer)?, handoff })
        });
        let order: Vec<RoutedHandoff> = changes.collect();
        if order.is_empty() {
            return Err(FlowError::NoWafer);
        }
        let routes = routes.into_iter().map(|(_, route)| route).collect();
        Ok(Self { routes, blocked, order })
    }

    /// Number of wafers that the program moves.
    #[must_use]
    pub fn wafers(&self) -> usize {
        self.routes.len()
    }
}

fn check_commands(body: &[Instruction]) -> Result<(), FlowError> {
    for Instruction { place, command } in body {
        match command {
            Command::Repeat { body, .. } => check_commands(body)?,
            Command::If { branches, otherwise } => {
                for branch in branches {
                    check_commands(&branch.body)?;
                }
                check_commands(otherwise)?;
            }
            Command::Home
            | Command::Get { .. }
            | Command::Put { .. }
            | Command::Transfer { .. }
            | Command::Swap { .. }
            | Command::Speed { .. }
            | Command::Blend { .. }
            | Command::Call { .. } => {}
            _ => return Err(FlowError::OtherCommand { place: *place }),
        }
    }
    Ok(())
}
