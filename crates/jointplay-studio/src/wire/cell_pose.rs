//! One pose of the cell, checked.

use jointplay::cell::EntityId;
use jointplay::cell::check::{Kind, MinimumDistance, Report, Violation};
use jointplay::cell::workcell::Cell;
use jointplay::report::explain_violation;
use serde::Serialize;
use utoipa::ToSchema;

/// Minimum distances and violations of one pose, the robot standing still.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PoseCheckDocument {
    /// Pairs that are nearer than 50 mm, nearest first; wafers and bodies by the names of the check's report.
    pub(crate) distances: Vec<PoseDistanceDocument>,
    /// All that is violated: limits of axes and of the tilt, play, droop, slip, collisions, clearances, keep-out zones.
    pub(crate) violations: Vec<PoseViolationDocument>,
    /// Names of the bodies, wafers and zones in contact, each once.
    pub(crate) in_contact: Vec<String>,
}

/// How far two are apart.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PoseDistanceDocument {
    /// Names of both.
    #[schema(min_items = 2, max_items = 2)]
    pub(crate) bodies: Vec<String>,
    /// Distance, 0 where they touch [m].
    pub(crate) distance_m: f64,
}

/// Something that is violated.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PoseViolationDocument {
    /// Such as `tilt limit` or `collision`, as in the report of a program.
    pub(crate) kind: String,
    /// Axis, effector or bodies that it is about.
    pub(crate) names: Vec<String>,
    /// Whether two touch, or one is in a zone that it must not enter.
    pub(crate) is_contact: bool,
    /// What is wrong, in mm and degrees.
    pub(crate) message: String,
}

/// Whether a violation is a contact.
fn is_contact(violation: &Violation) -> bool {
    matches!(violation.kind, Kind::Collision | Kind::KeepOut)
}

/// The pairs in contact, each once.
pub(crate) fn touching(report: &Report) -> Vec<[EntityId; 2]> {
    let mut pairs: Vec<[EntityId; 2]> = Vec::new();
    for violation in report.violations.iter().filter(|one| is_contact(one)) {
        if let [one, other] = violation.entities[..] {
            let pair = [one, other];
            if !pairs.contains(&pair) {
                pairs.push(pair);
            }
        }
    }
    pairs
}

impl PoseCheckDocument {
    pub(crate) fn new(cell: &Cell, report: &Report) -> Self {
        let distance =
            |MinimumDistance { entities, distance, .. }: &MinimumDistance| PoseDistanceDocument {
                bodies: entities.map(|one| cell.entity_name(one)).to_vec(),
                distance_m: *distance,
            };
        let violation = |one: &Violation| PoseViolationDocument {
            kind: one.kind.to_string(),
            names: one.entities.iter().map(|&one| cell.entity_name(one)).collect(),
            is_contact: is_contact(one),
            message: explain_violation(cell, one),
        };
        let in_contact = touching(report).into_iter().flatten();
        let mut in_contact: Vec<String> = in_contact.map(|one| cell.entity_name(one)).collect();
        in_contact.sort();
        in_contact.dedup();
        Self {
            distances: report.distances.iter().map(distance).collect(),
            violations: report.violations.iter().map(violation).collect(),
            in_contact,
        }
    }
}
