//! Violations of the rules for stays and visits of wafers.

use super::stays::{TimedStay, timed_stays};
use crate::EntityId;
use crate::program::WaferLocations;
use crate::station::{DwellLimits, VisitRule, WaferRules};
use crate::trajectory::Trajectory;
use crate::violation::{Violation, ViolationKind, ViolationQuantity};
use crate::workcell::Cell;

/// Tolerance of times: sums of durations differ by round-off (s).
const TIME_TOLERANCE: f64 = 1e-9;

/// Violations of the cell's rules by a trajectory; none for a trajectory without steps.
pub(crate) fn rule_violations(
    cell: &Cell,
    trajectory: &Trajectory,
    locations: &WaferLocations,
) -> Vec<Violation> {
    if trajectory.steps.is_empty() || cell.rules == WaferRules::default() {
        return Vec::new();
    }
    let checker = RuleChecker { cell, trajectory, locations };
    let stays = timed_stays(trajectory, locations);
    let mut violations = Vec::new();
    for of_wafer in stays.chunk_by(|one, next| one.wafer == next.wafer) {
        for stay in of_wafer {
            let limits = stay.station().and_then(|station| cell.rules.dwell_at(station));
            violations.extend(limits.and_then(|limits| checker.dwell(stay, limits)));
        }
        for rule in &cell.rules.visits {
            violations.extend(checker.visits(of_wafer, rule));
        }
    }
    violations
}

struct RuleChecker<'a> {
    cell: &'a Cell,
    trajectory: &'a Trajectory,
    locations: &'a WaferLocations,
}

impl RuleChecker<'_> {
    /// A violation at the end of a step, without a value.
    fn violation(
        &self,
        kind: ViolationKind,
        wafer: usize,
        station: usize,
        step: usize,
    ) -> Violation {
        let time = self.trajectory.times[step + 1];
        let described = &self.trajectory.steps[step];
        Violation {
            kind,
            entities: vec![self.locations.wafer_id(wafer), EntityId::Station(station)],
            instruction: described.instruction,
            place: described.place,
            step,
            phase: described.phase,
            start: time,
            end: time,
            worst_time: time,
            worst: 0.0,
            limit: 0.0,
            quantity: ViolationQuantity::None,
            detail: String::new(),
        }
    }

    /// Violation of the limits of a stay.
    fn dwell(&self, stay: &TimedStay, limits: &DwellLimits) -> Option<Violation> {
        let (station, dwell) = (limits.station, stay.duration());
        let (arrival, departure) = (stay.stay.arrival_step, stay.stay.departure_step);
        let timed =
            |kind: ViolationKind, step: usize, limit: f64, start: f64, end: f64| Violation {
                start,
                end,
                worst_time: end,
                worst: dwell,
                limit,
                quantity: ViolationQuantity::Time,
                ..self.violation(kind, stay.wafer, station, step)
            };
        match (limits.max, departure) {
            (Some(max), None) => {
                // The instruction that placed the wafer, which no other picks.
                let step = arrival.unwrap_or(0);
                let start = (stay.start + max).min(stay.end);
                Some(timed(ViolationKind::LeftInStation, step, max, start, stay.end))
            }
            (Some(max), Some(step)) if dwell > max + TIME_TOLERANCE => {
                Some(timed(ViolationKind::LongDwell, step, max, stay.start + max, stay.end))
            }
            (_, Some(step)) if arrival.is_some() && dwell < limits.min - TIME_TOLERANCE => {
                Some(timed(ViolationKind::ShortDwell, step, limits.min, stay.end, stay.end))
            }
            _ => None,
        }
    }

    /// Violation of a rule by the visits of a wafer, the first one.
    fn visits(&self, stays: &[TimedStay], rule: &VisitRule) -> Option<Violation> {
        let first = stays.first()?;
        let is_origin = |station| rule.origins.contains(&station);
        let is_concerned = first.stay.departure_step.is_some()
            && (rule.origins.is_empty() || first.station().is_some_and(is_origin));
        if !is_concerned {
            return None;
        }
        let is_required = |stay: &&TimedStay| {
            stay.station().is_some_and(|station| rule.stations.contains(&station))
        };
        let step = |stay: &TimedStay| stay.stay.arrival_step.unwrap_or(0);
        let name = |entity: EntityId| self.cell.entity_name(entity);
        let wafer = name(self.locations.wafer_id(first.wafer));
        let listed = |stations: &[usize]| {
            let names: Vec<String> =
                stations.iter().map(|&station| name(EntityId::Station(station))).collect();
            names.join(" or ")
        };
        let (required, rule_name) = (listed(&rule.stations), &rule.name);
        let station = rule.stations[0];
        let missing = |at: &TimedStay, detail: String| Violation {
            detail,
            ..self.violation(ViolationKind::VisitRule, first.wafer, station, step(at))
        };
        if !rule.before.is_empty() {
            let (mut is_done, mut is_entered) = (false, false);
            for stay in stays {
                let enters = stay.stay.arrival_step.is_some()
                    && stay.station().is_some_and(|station| rule.before.contains(&station));
                if enters && !is_done {
                    let entered = stay.station().map_or(String::new(), |one| listed(&[one]));
                    let detail = format!(
                        "{wafer} enters {entered} without a visit to {required} before (rule {rule_name:?}); place it in {required} first"
                    );
                    return Some(missing(stay, detail));
                }
                is_done |= is_required(&stay);
                is_entered |= enters;
            }
            if !is_entered {
                return None;
            }
        }
        let visits: Vec<&TimedStay> = stays.iter().filter(is_required).collect();
        let last = stays.last()?;
        match rule.count {
            Some(count) if visits.len() > count => {
                let detail = format!(
                    "{wafer} visits {required} {} times, but rule {rule_name:?} requires {count}",
                    visits.len()
                );
                Some(missing(visits[count], detail))
            }
            Some(count) if visits.len() < count => {
                let detail = format!(
                    "{wafer} visits {required} {} times, but rule {rule_name:?} requires {count}",
                    visits.len()
                );
                Some(missing(last, detail))
            }
            None if visits.is_empty() && rule.before.is_empty() => {
                let detail = format!("{wafer} does not visit {required} (rule {rule_name:?})");
                Some(missing(last, detail))
            }
            _ => None,
        }
    }
}
