//! One pose of the cell, checked.

use jointplay::cell::check::{Kind, PairDistance, Report, Violation};
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
pub(crate) fn touching(report: &Report) -> Vec<[String; 2]> {
    let mut pairs: Vec<[String; 2]> = Vec::new();
    for violation in report.violations.iter().filter(|one| is_contact(one)) {
        if let [one, other] = &violation.names[..] {
            let pair = [one.clone(), other.clone()];
            if !pairs.contains(&pair) {
                pairs.push(pair);
            }
        }
    }
    pairs
}

impl PoseCheckDocument {
    pub(crate) fn new(report: &Report) -> Self {
        let distance = |PairDistance { names, distance, .. }: &PairDistance| PoseDistanceDocument {
            bodies: names.to_vec(),
            distance_m: *distance,
        };
        let violation = |one: &Violation| PoseViolationDocument {
            kind: one.kind.to_string(),
            names: one.names.clone(),
            is_contact: is_contact(one),
            message: explain_violation(one),
        };
        let mut in_contact: Vec<String> = touching(report).into_iter().flatten().collect();
        in_contact.sort();
        in_contact.dedup();
        Self {
            distances: report.distances.iter().map(distance).collect(),
            violations: report.violations.iter().map(violation).collect(),
            in_contact,
        }
    }
}
