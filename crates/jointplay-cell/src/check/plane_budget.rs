//! Check of the planes of wafers at hand-offs, with the uncertainty of the stations.

use crate::EntityId;
use crate::program::handoff_deflections;
use crate::trajectory::Trajectory;
use crate::violation::{Violation, ViolationKind, ViolationQuantity};
use crate::workcell::Cell;

/// Hand-offs at which the angle between the wafer and its station may exceed the plane budget.
///
/// ```text
///    angle  =  angle that compensation leaves + coverage factor · standard deviation of the station's tilt
/// ```
/// Stations whose tilt has no known uncertainty are not checked here: compensation alone compares the angle that it leaves with the budget.
pub(super) fn plane_violations(cell: &Cell, trajectory: &Trajectory) -> Vec<Violation> {
    let expanded: Vec<Option<f64>> = cell
        .stations
        .iter()
        .map(|station| {
            let known = &station.uncertainty;
            known.tilt_deviation().map(|tilt| tilt * known.coverage(cell.coverage_factor))
        })
        .collect();
    if expanded.iter().all(Option::is_none) {
        return Vec::new();
    }
    let violation = |handoff: crate::program::HandoffDeflection| {
        let angle = handoff.tilt_residual + expanded[handoff.slot.station]?;
        if angle <= cell.plane_threshold {
            return None;
        }
        let step = &trajectory.steps[handoff.step];
        let time = trajectory.times[handoff.step + 1];
        Some(Violation {
            kind: ViolationKind::PlaneBudget,
            entities: vec![
                EntityId::Effector(handoff.effector),
                EntityId::Station(handoff.slot.station),
            ],
            instruction: step.instruction,
            place: step.place,
            step: handoff.step,
            phase: step.phase,
            start: time,
            end: time,
            worst_time: time,
            worst: angle,
            limit: cell.plane_threshold,
            quantity: ViolationQuantity::Angle,
            detail: String::new(),
        })
    };
    handoff_deflections(cell, &trajectory.steps).into_iter().filter_map(violation).collect()
}
