//! Targets and lines into stations that an effector does not reach.

use super::ProgramProblem;
use super::effector_choice::effector_name;
use super::occupancy::slot_name;
use super::problem::Leveling;
use super::sequence::MotionSequencer;
use crate::robot::EffectorId;
use crate::station::{InfeasibleLine, SlotId};
use crate::wafer::Unreachable;

impl MotionSequencer<'_> {
    /// The problem of a target that an effector does not reach.
    ///
    /// # Arguments
    /// * `what` – the pose, before the name of the slot
    pub(super) fn unreachable(
        &self,
        what: &str,
        effector: EffectorId,
        slot: SlotId,
        loaded: bool,
        source: Unreachable,
    ) -> ProgramProblem {
        ProgramProblem::Unreachable {
            target: format!("{what} {}", slot_name(self.cell, slot)),
            effector: effector_name(&self.cell.robot, effector).to_owned(),
            loaded,
            leveling: self.leveling(&source, slot),
            source: Box::new(source),
        }
    }

    /// Correction of a station that tilts too far.
    fn leveling(&self, error: &Unreachable, slot: SlotId) -> Option<Leveling> {
        let Unreachable::Tilt { .. } = error else { return None };
        let station = &self.cell.stations[slot.station];
        let angle = self.cell.leveling(station)?;
        let excess = station.excess_tilt(&self.cell.robot);
        let for_deflection = (angle - excess).max(0.0);
        Some(Leveling { station: station.name.clone(), angle, for_deflection })
    }

    /// The problem of a line into a station that no motion of the arm follows.
    pub(super) fn infeasible_line(
        &self,
        effector: EffectorId,
        station: usize,
        blocked: &InfeasibleLine,
    ) -> ProgramProblem {
        ProgramProblem::InfeasibleLine {
            station: self.cell.stations[station].name.clone(),
            effector: effector_name(&self.cell.robot, effector).to_owned(),
            blocked: Box::new(blocked.clone()),
        }
    }
}
