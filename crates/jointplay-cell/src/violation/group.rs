//! Violations grouped by cause.

use std::collections::BTreeMap;

use super::kind::ViolationKind;
use super::report_entry::Violation;
use crate::EntityId;
use crate::program::{Phase, SourceLocation, Step};

/// Violations with one cause: of one limit by the same entities, whenever they occur; all wafers count as one entity.
///
/// Contacts and clearances of a pair are one cause: the pair is too close.
#[derive(Debug, Clone, PartialEq)]
pub struct ViolationGroup {
    /// Index of the worst violation; of equal ones the first.
    pub worst: usize,
    /// Indices of all violations in the order of time.
    pub violations: Vec<usize>,
    /// The wafers concerned, each once.
    pub wafers: Vec<EntityId>,
    /// The violations by instruction and station, in the order of the program text.
    pub occurrences: Vec<ViolationOccurrence>,
}

/// Violations of a group in one instruction of the text, in one phase, at one station.
#[derive(Debug, Clone, PartialEq)]
pub struct ViolationOccurrence {
    /// Location of the instruction.
    pub place: SourceLocation,
    /// Index of the station that the robot moves to or from; `None` for other motions.
    pub station: Option<usize>,
    /// Phase of the instruction.
    pub phase: Phase,
    /// Number of violations.
    pub count: usize,
    /// Index of the first violation.
    pub first: usize,
    /// Index of the worst violation; of equal ones the first.
    pub worst: usize,
}

#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct GroupKey {
    cause: ViolationKind,
    entities: Vec<Option<EntityId>>,
}

impl ViolationGroup {
    /// Index of the first violation.
    #[must_use]
    pub fn first(&self) -> usize {
        self.violations[0]
    }
}

impl Violation {
    /// Amount by which the limit is exceeded, in the SI unit of `worst` and `limit`; of two bodies the depth, required clearance included.
    ///
    /// Infinite where a wafer lifts off, and 0 where there is no value.
    #[must_use]
    pub fn excess(&self) -> f64 {
        (self.worst - self.limit).abs()
    }
}

/// Groups violations by cause, the most severe cause first: unknown poses, collisions, keep-out zones, clearances, slip, rules for wafers, then other limits; within each by excess.
///
/// # Arguments
/// * `steps` – of the trajectory
/// * `violations` – in the order of time
#[must_use]
pub fn group_violations(steps: &[Step], violations: &[Violation]) -> Vec<ViolationGroup> {
    let mut groups: BTreeMap<GroupKey, ViolationGroup> = BTreeMap::new();
    for (index, violation) in violations.iter().enumerate() {
        let mut entities: Vec<Option<EntityId>> =
            violation.entities.iter().map(|&one| (!one.is_wafer()).then_some(one)).collect();
        entities.sort_unstable();
        let key = GroupKey { cause: violation.kind.cause(), entities };
        let group = groups.entry(key).or_insert_with(|| ViolationGroup {
            worst: index,
            violations: Vec::new(),
            wafers: Vec::new(),
            occurrences: Vec::new(),
        });
        if is_worse(violation, &violations[group.worst]) {
            group.worst = index;
        }
        group.violations.push(index);
        group.wafers.extend(violation.entities.iter().filter(|one| one.is_wafer()));
        let station = station_of_step(steps, violation.step);
        let (place, phase) = (violation.place, violation.phase);
        let known = group
            .occurrences
            .iter_mut()
            .find(|one| (one.place, one.station, one.phase) == (place, station, phase));
        match known {
            Some(known) => {
                known.count += 1;
                if is_worse(violation, &violations[known.worst]) {
                    known.worst = index;
                }
            }
            None => {
                let (first, worst) = (index, index);
                let occurrence =
                    ViolationOccurrence { place, station, phase, count: 1, first, worst };
                group.occurrences.push(occurrence);
            }
        }
    }
    let mut groups: Vec<ViolationGroup> = groups.into_values().collect();
    for group in &mut groups {
        group.wafers.sort_unstable();
        group.wafers.dedup();
        group.occurrences.sort_by_key(|one| (one.place, one.first));
    }
    groups.sort_by(|one, other| {
        let [a, b] = [one, other].map(|group| &violations[group.worst]);
        let by_kind = a.kind.severity_rank().cmp(&b.kind.severity_rank());
        by_kind.then(b.excess().total_cmp(&a.excess())).then(one.worst.cmp(&other.worst))
    });
    groups
}

/// Whether a violation is worse than another of the same cause.
fn is_worse(one: &Violation, other: &Violation) -> bool {
    let rank = |violation: &Violation| violation.kind.severity_rank();
    rank(one) < rank(other) || (rank(one) == rank(other) && one.excess() > other.excess())
}

/// Station that an instruction moves to at one of its steps, or comes from after its last hand-off.
fn station_of_step(steps: &[Step], index: usize) -> Option<usize> {
    let instruction = steps.get(index)?.instruction;
    let is_same = |step: &&Step| step.instruction == instruction;
    let slot = |step: &Step| step.slot.map(|slot| slot.station);
    let next = steps[index..].iter().take_while(is_same).find_map(slot);
    next.or_else(|| steps[..index].iter().rev().take_while(is_same).find_map(slot))
}
