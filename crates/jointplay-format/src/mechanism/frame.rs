//! Joint frames and attached frames from points and directions.

use jointplay_core::mechanism::JointKind;
use jointplay_core::spatial::Pose;
use nalgebra::{Matrix3, Rotation3, Translation3, Unit, Vector3};

use super::problem::Problem;
use super::tree::{Entry, Table};
use super::values::Values;
use crate::file_problem::FileProblem;

/// Cosine of the angle between a direction and the x-axis below which another x-axis is taken; no direction that is common in machines has it.
const NEAR_X: f64 = 0.9;

/// How far from perpendicular the axes of a universal joint may be (rad).
const PERPENDICULAR: f64 = 1e-6;

/// The keys that place a joint on a link.
const KEYS: [&str; 4] = ["point", "axis", "zero", "second_axis"];

/// The joint frame on both links of a joint; errors of its numbers are reported also for a joint of unknown kind.
pub(super) fn both(values: &Values, table: &Table, kind: Option<JointKind>) -> Option<[Pose; 2]> {
    let Some(frames) = table.entry("frames") else {
        let frame = one(values, table, kind)?;
        return Some([frame, frame]);
    };
    for key in KEYS {
        if let Some(entry) = table.entry(key) {
            let why = "`frames` places this joint on each of its links already".to_owned();
            entry.report(values.reader, Problem::Misplaced { key, why });
        }
    }
    let list = frames.list(values.reader)?;
    let frame = |entry: &Entry| {
        let table_of_link = entry.table(values.reader, table.whose.as_str())?;
        let frame = one(values, &table_of_link, kind);
        table_of_link.finish();
        frame
    };
    let read: Vec<_> = list.iter().map(frame).collect();
    let [first, second] = read.as_slice() else {
        let (key, needed) = ("frames".to_owned(), "2, one for each link".to_owned());
        frames.report(values.reader, FileProblem::Count { key, found: list.len(), needed });
        return None;
    };
    Some([(*first)?, (*second)?])
}

fn one(values: &Values, table: &Table, kind: Option<JointKind>) -> Option<Pose> {
    use JointKind as K;
    let [point, axis, zero, second_axis] = KEYS.map(|key| table.entry(key));
    let misplaced = |entry: Option<Entry>, key: &'static str, why: String| {
        if let Some(entry) = entry {
            entry.report(values.reader, Problem::Misplaced { key, why });
        }
    };
    let point_read = point.map(|entry| values.point(&entry));
    let axis_read = axis.map(|entry| values.direction(&entry));
    // A misplaced direction is not read; for a joint of unknown kind, none is misplaced.
    let is_universal = kind.map(|kind| kind == K::Universal);
    let zero_read = zero.filter(|_| is_universal != Some(true));
    let zero_read = zero_read.map(|entry| values.direction(&entry));
    let second_read = second_axis.filter(|_| is_universal != Some(false));
    let second_read = second_read.map(|entry| values.direction(&entry));
    let kind = kind?;
    let (x_entry, x_read) =
        if kind == K::Universal { (second_axis, second_read) } else { (zero, zero_read) };
    // A slide is the same wherever its line lies, and so are all motions and none.
    let is_anywhere = matches!(kind, K::Prismatic | K::Fixed | K::Floating);
    let has_axis = !matches!(kind, K::Spherical | K::Fixed | K::Floating);
    if point.is_none() && !is_anywhere {
        table.missing("point");
    }
    if axis.is_none() && has_axis {
        table.missing("axis");
    }
    if kind == K::Universal {
        misplaced(zero, "zero", "a universal joint has `second_axis` instead".to_owned());
        if second_axis.is_none() {
            table.missing("second_axis");
        }
    } else {
        let why = format!("only universal joints have it, this one is {}", kind.name());
        misplaced(second_axis, "second_axis", why);
    }
    let z = match axis_read {
        Some(axis) => axis?,
        None if has_axis => return None,
        None => Vector3::z_axis(),
    };
    let x = match (x_read, x_entry) {
        (Some(x), Some(entry)) => {
            let x = x?;
            if let Some(problem) = invalid_x(kind, x, z) {
                entry.report(values.reader, problem);
                return None;
            }
            x
        }
        _ if kind == K::Universal => return None,
        _ => some_perpendicular(z),
    };
    let point = match point_read {
        Some(point) => point?,
        None if is_anywhere => Vector3::zeros(),
        None => return None,
    };
    Some(pose(point, x, z))
}

/// The pose of an attached frame: at the origin of the link and along its axes where the table has no other.
pub(super) fn attached(values: &Values, table: &Table) -> Option<Pose> {
    let [point, axis, zero] = ["point", "axis", "zero"].map(|key| table.entry(key));
    let point = point.map(|entry| values.point(&entry));
    let z = axis.map(|entry| values.direction(&entry));
    let x = zero.map(|entry| (entry, values.direction(&entry)));
    let point = point.unwrap_or(Some(Vector3::zeros()));
    let z = z.unwrap_or(Some(Vector3::z_axis()))?;
    let x = match x {
        Some((entry, x)) => {
            let x = x?;
            if let Some(problem) = invalid_x(JointKind::Fixed, x, z) {
                entry.report(values.reader, problem);
                return None;
            }
            x
        }
        None => some_perpendicular(z),
    };
    Some(pose(point?, x, z))
}

/// Why a direction cannot be the x-axis of the joint frame, if it cannot.
fn invalid_x(kind: JointKind, x: Unit<Vector3<f64>>, z: Unit<Vector3<f64>>) -> Option<Problem> {
    if kind != JointKind::Universal {
        return (x.cross(&z).norm() < PERPENDICULAR).then_some(Problem::ZeroAlongAxis);
    }
    (x.dot(&z).abs() > PERPENDICULAR).then(|| Problem::NotPerpendicular {
        degrees: x.dot(&z).clamp(-1.0, 1.0).acos().to_degrees(),
    })
}

/// The x-axis of the reference frame, or its y-axis where the direction is within 26° of x.
///
/// Small changes of a direction near a coordinate axis, or a diagonal of two or three, do not change the answer: a tolerance of an axis must not turn the joint frame.
pub fn some_perpendicular(z: Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    if z.x.abs() < NEAR_X { Vector3::x_axis() } else { Vector3::y_axis() }
}

/// The frame at a point with this z, and x as near as can be.
pub fn pose(point: Vector3<f64>, x: Unit<Vector3<f64>>, z: Unit<Vector3<f64>>) -> Pose {
    let x = Unit::new_normalize(x.into_inner() - z.scale(x.dot(&z)));
    let rotation = Matrix3::from_columns(&[x.into_inner(), z.cross(&x), z.into_inner()]);
    Pose::from_parts(Translation3::from(point), Rotation3::from_matrix_unchecked(rotation))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_changes_of_an_axis_do_not_turn_the_joint_frame() {
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let turned = |axis: Vector3<f64>| {
            let axis = Unit::new_normalize(axis);
            pose(Vector3::zeros(), some_perpendicular(axis), axis).rotation
        };
        for axis in [x, y, z, x + y, x + z, y + z, x + y + z, x - y, x - z, y - z] {
            for axis in [axis, -axis] {
                let before = turned(axis);
                assert!((before * x).dot(&axis).abs() < 1e-15, "{axis}");
                for change in [x, y, z, x + y, y - z, z - x] {
                    let angle = before.angle_to(&turned(axis + change * 1e-4));
                    assert!(angle < 3e-4, "{axis} with {change}: {angle} rad");
                }
            }
        }
    }
}
