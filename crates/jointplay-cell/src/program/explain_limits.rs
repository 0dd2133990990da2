//! What keeps the robot from a place, in mm and degrees.

use crate::robot::{AxisKind, HybridRobot, LimitViolation};
use crate::wafer::{RejectedBranch, Unreachable};

/// A limit that is broken, and by how much.
pub(super) fn limit_told(robot: &HybridRobot, limit: &LimitViolation) -> String {
    match *limit {
        LimitViolation::Axis { axis, position, min, max } => {
            let axis = &robot.axes[axis];
            let (unit, factor) = match axis.kind {
                AxisKind::Rotary => ("deg", 1_f64.to_degrees()),
                AxisKind::Linear => ("mm", 1e3),
            };
            format!(
                "axis {} to {:.3} {unit}, but its limits are {:.3} to {:.3} {unit}",
                axis.name,
                position * factor,
                min * factor,
                max * factor
            )
        }
        LimitViolation::Tilt { pitch, max } => format!(
            "the platform to a tilt of {:.4} deg, but it leans by at most {:.4} deg",
            pitch.to_degrees(),
            max.to_degrees()
        ),
    }
}

/// Why a place cannot be reached: of limits first those that stop every way to it.
pub(super) fn why(robot: &HybridRobot, stopped: &Unreachable) -> String {
    let Unreachable::Limits(ways) = stopped else { return stopped.to_string() };
    let told = |limits: &mut dyn Iterator<Item = &LimitViolation>| {
        limits.map(|limit| limit_told(robot, limit)).collect::<Vec<_>>().join("; and ")
    };
    let first = ways.iter().take(1).flat_map(|way| &way.broken);
    let mut common = first.map(|(_, limit)| limit).filter(|limit| {
        ways.iter().all(|way| way.broken.iter().any(|(_, other)| same(limit, other)))
    });
    let always = told(&mut common);
    if !always.is_empty() {
        return format!("it would take {always}");
    }
    let each = |way: &RejectedBranch| {
        let limits = told(&mut way.broken.iter().map(|(_, limit)| limit));
        match way.configuration.to_string() {
            bend if bend.is_empty() => format!("it would take {limits}"),
            bend => format!("{bend}, it would take {limits}"),
        }
    };
    ways.iter().map(each).collect::<Vec<_>>().join("; or, ")
}

/// Whether two ways break one limit, and by the same.
fn same(one: &LimitViolation, other: &LimitViolation) -> bool {
    match (one, other) {
        (
            LimitViolation::Axis { axis: a, position: one, .. },
            LimitViolation::Axis { axis: b, position: other, .. },
        ) => a == b && (one - other).abs() < 1e-9,
        (LimitViolation::Tilt { .. }, LimitViolation::Tilt { .. }) => true,
        _ => false,
    }
}
