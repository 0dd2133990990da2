//! Documents of the check of one pose.

use jointplay::cell::EntityId;
use jointplay::cell::check::{MinimumDistance, Report, Violation, ViolationKind};
use jointplay::cell::workcell::Cell;
use jointplay::nalgebra::Vector3;
use jointplay::report::{EntityReport, explain_violation};
use serde::Serialize;
use utoipa::ToSchema;

use super::Triple;
use crate::display::display_units;

/// Minimum distances and violations of one pose of the robot at rest.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PoseCheckDocument {
    /// Pairs below 50 mm by increasing distance, with the kinds and names of the report of a check.
    pub(crate) distances: Vec<PoseDistanceDocument>,
    /// Violations of limits of axes and tilt, play, droop, slip, collision, clearance and keep-out zones.
    pub(crate) violations: Vec<PoseViolationDocument>,
    /// The bodies, wafers and zones in contact, each once.
    pub(crate) in_contact: Vec<EntityReport>,
}

/// The distance of a pair.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PoseDistanceDocument {
    /// Both bodies, wafers or links.
    #[schema(min_items = 2, max_items = 2)]
    pub(crate) entities: Vec<EntityReport>,
    /// Distance, 0 in contact (m).
    pub(crate) distance_m: f64,
    /// Nearest point of each in the base frame (m); `null` in contact, or where the pose of the arm is unknown.
    #[schema(required = true, min_items = 2, max_items = 2)]
    pub(crate) nearest_points_m: Option<Vec<Triple>>,
}

/// A violation.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct PoseViolationDocument {
    /// Kind, such as `tilt limit` or `collision`, as in the report of a program.
    pub(crate) kind: String,
    /// The axis, effector, bodies, wafers or zone.
    pub(crate) entities: Vec<EntityReport>,
    /// Whether it is a contact of two bodies or the entry into a keep-out zone.
    pub(crate) is_contact: bool,
    /// Description, with lengths in the unit of the request.
    pub(crate) message: String,
}

/// Whether a violation is a contact.
fn is_contact(violation: &Violation) -> bool {
    matches!(violation.kind, ViolationKind::Collision | ViolationKind::KeepOut)
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
    pub(crate) fn new(
        cell: &Cell,
        report: &Report,
        nearest_points: &[Option<[Vector3<f64>; 2]>],
    ) -> Self {
        let distance = |(minimum, points): (&MinimumDistance, &Option<[Vector3<f64>; 2]>)| {
            let MinimumDistance { entities, distance, .. } = minimum;
            PoseDistanceDocument {
                entities: entities.map(|one| EntityReport::new(cell, one)).to_vec(),
                distance_m: *distance,
                nearest_points_m: points
                    .map(|points| points.map(|point| Triple(point.into())).to_vec()),
            }
        };
        let violation = |one: &Violation| PoseViolationDocument {
            kind: one.kind.to_string(),
            entities: one.entities.iter().map(|&one| EntityReport::new(cell, one)).collect(),
            is_contact: is_contact(one),
            message: explain_violation(cell, one, display_units()),
        };
        let in_contact = touching(report).into_iter().flatten();
        let mut in_contact: Vec<EntityReport> =
            in_contact.map(|one| EntityReport::new(cell, one)).collect();
        in_contact.sort();
        in_contact.dedup();
        Self {
            distances: report.distances.iter().zip(nearest_points).map(distance).collect(),
            violations: report.violations.iter().map(violation).collect(),
            in_contact,
        }
    }
}
