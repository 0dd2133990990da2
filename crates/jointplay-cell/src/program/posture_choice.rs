//! Choice of the postures for a visit of a station.

use std::sync::Arc;

use crate::robot::{ArmChain, EffectorId, HybridRobot, PostureCandidate, PostureChange};
use crate::station::StationPostures;

/// A visit of a station.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Visit {
    pub(super) effector: EffectorId,
    /// Index of the station.
    pub(super) station: usize,
}

/// Postures of the present visit: chosen at its start, and kept until another visit starts or the arm moves otherwise.
#[derive(Default)]
pub(super) struct PostureChoice {
    chosen: Option<(Visit, Arc<StationPostures>)>,
}

impl PostureChoice {
    /// Postures of a visit that has started and not ended.
    pub(super) fn of_visit(&self, visit: Visit) -> Option<Arc<StationPostures>> {
        let (chosen, postures) = self.chosen.as_ref()?;
        (*chosen == visit).then(|| Arc::clone(postures))
    }

    pub(super) fn start_visit(&mut self, visit: Visit, postures: &Arc<StationPostures>) {
        self.chosen = Some((visit, Arc::clone(postures)));
    }

    pub(super) fn end_visit(&mut self) {
        self.chosen = None;
    }
}

/// Preference of a candidate; the least is chosen.
#[derive(PartialEq, PartialOrd)]
struct Preference {
    requires_posture_change: bool,
    changes_elbow: bool,
    /// Squared duration of the turn, and cost of the line (s²).
    cost: f64,
}

/// Index of the candidate to take from present positions.
///
/// Candidates that a single turn reaches with the wafer retracted precede those that require a change of posture; of both kinds, those with the present elbow side precede the others.
/// Among equals, the cost decides: the squared durations of the turn at the velocity limits, summed over the axes, and the cost of the line.
/// Later visits are not considered.
///
/// # Arguments
/// * `candidates` – postures for the station, one or more
/// * `positions` – present positions of all axes (m or rad)
pub(super) fn best_candidate(
    robot: &HybridRobot,
    effector: EffectorId,
    candidates: &[PostureCandidate],
    positions: &[f64],
) -> usize {
    let chain = ArmChain::new(robot, effector);
    let present = robot.configuration(effector, positions);
    let preference = |candidate: &PostureCandidate| {
        let mut start = positions.to_vec();
        for (&axis, &position) in chain.axes().iter().zip(candidate.first_positions()) {
            start[axis] = position;
        }
        Preference {
            requires_posture_change: PostureChange::new(robot, effector, positions, &start)
                .is_some_and(|change| change.swings_out()),
            changes_elbow: !robot.configuration(effector, &start).agrees_with(present),
            cost: robot.squared_travel_time(positions, &start) + candidate.cost,
        }
    };
    let (mut best, mut least) = (0, preference(&candidates[0]));
    for (index, candidate) in candidates.iter().enumerate().skip(1) {
        let preference = preference(candidate);
        if preference < least {
            (best, least) = (index, preference);
        }
    }
    best
}
