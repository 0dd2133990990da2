//! Joint frames from points and directions.

use jointplay_core::mechanism::JointKind;
use jointplay_core::spatial::Pose;
use nalgebra::{Matrix3, Rotation3, Translation3, Unit, Vector3};

use super::file::{FrameTable, JointTable, Numbers};
use super::problem::{Error, Problem};
use super::values::Values;

/// How far from perpendicular the axes of a universal joint may be (rad).
const PERPENDICULAR: f64 = 1e-6;

/// The keys that place a joint on a link.
#[derive(Clone, Copy)]
struct Placing<'a> {
    point: Option<&'a Numbers>,
    axis: Option<&'a Numbers>,
    zero: Option<&'a Numbers>,
    second_axis: Option<&'a Numbers>,
}

/// The joint frame on both links of a joint.
pub(super) fn both(
    values: &Values,
    table: &JointTable,
    kind: JointKind,
) -> Result<[Pose; 2], Error> {
    let JointTable { point, axis, zero, second_axis, .. } = table;
    let common = Placing {
        point: point.as_ref(),
        axis: axis.as_ref(),
        zero: zero.as_ref(),
        second_axis: second_axis.as_ref(),
    };
    let Some(frames) = &table.frames else {
        let frame = one(values, table, kind, common, table.name.span())?;
        return Ok([frame, frame]);
    };
    let beside = [("point", point), ("axis", axis), ("zero", zero), ("second_axis", second_axis)];
    for (key, numbers) in beside {
        if let Some(numbers) = numbers {
            let why = "`frames` places this joint on each of its links already".to_owned();
            return Err(values.wrong(numbers.span(), Problem::Misplaced { key, why }));
        }
    }
    let [first, second] = frames.get_ref().as_slice() else {
        let found = frames.get_ref().len();
        let problem =
            Problem::Count { key: "frames", found, needed: "2, one for each link".into() };
        return Err(values.wrong(frames.span(), problem));
    };
    let frame = |table_of_link: &toml::Spanned<FrameTable>| {
        let FrameTable { point, axis, zero, second_axis } = table_of_link.get_ref();
        let placing = Placing {
            point: point.as_ref(),
            axis: axis.as_ref(),
            zero: zero.as_ref(),
            second_axis: second_axis.as_ref(),
        };
        one(values, table, kind, placing, table_of_link.span())
    };
    Ok([frame(first)?, frame(second)?])
}

fn one(
    values: &Values,
    table: &JointTable,
    kind: JointKind,
    placing: Placing,
    span: std::ops::Range<usize>,
) -> Result<Pose, Error> {
    use JointKind as K;
    let missing = |key| {
        let whose = format!("the {} joint {:?}", kind.name(), table.name.get_ref());
        values.wrong(span.clone(), Problem::Missing { whose, key })
    };
    // A slide is the same wherever its line lies, and so are all motions and none.
    let is_anywhere = matches!(kind, K::Prismatic | K::Fixed | K::Floating);
    let has_axis = !matches!(kind, K::Spherical | K::Fixed | K::Floating);
    let point = match placing.point {
        Some(point) => values.point("point", point)?,
        None if is_anywhere => Vector3::zeros(),
        None => return Err(missing("point")),
    };
    let z = match placing.axis {
        Some(axis) => values.direction("axis", axis)?,
        None if has_axis => return Err(missing("axis")),
        None => Vector3::z_axis(),
    };
    let x = if kind == K::Universal {
        if let Some(zero) = placing.zero {
            let why = "a universal joint has `second_axis` instead".to_owned();
            return Err(values.wrong(zero.span(), Problem::Misplaced { key: "zero", why }));
        }
        let Some(second_axis) = placing.second_axis else { return Err(missing("second_axis")) };
        let second = values.direction("second_axis", second_axis)?;
        if second.dot(&z).abs() > PERPENDICULAR {
            let degrees = second.dot(&z).clamp(-1.0, 1.0).acos().to_degrees();
            return Err(values.wrong(second_axis.span(), Problem::NotPerpendicular { degrees }));
        }
        second
    } else {
        if let Some(second_axis) = placing.second_axis {
            let why = format!("only universal joints have it, this one is {}", kind.name());
            let problem = Problem::Misplaced { key: "second_axis", why };
            return Err(values.wrong(second_axis.span(), problem));
        }
        match placing.zero {
            None => some_perpendicular(z),
            Some(zero) => {
                let x = values.direction("zero", zero)?;
                if x.cross(&z).norm() < PERPENDICULAR {
                    return Err(values.wrong(zero.span(), Problem::ZeroAlongAxis));
                }
                x
            }
        }
    };
    Ok(pose(point, x, z))
}

/// The coordinate axis that is most nearly perpendicular to a direction; the first of equals.
pub fn some_perpendicular(z: Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
    let along = |axis: &Unit<Vector3<f64>>| axis.dot(&z).abs();
    let best = axes.into_iter().min_by(|a, b| along(a).total_cmp(&along(b)));
    best.expect("there are three axes")
}

/// The frame at a point with this z, and x as near as can be.
pub fn pose(point: Vector3<f64>, x: Unit<Vector3<f64>>, z: Unit<Vector3<f64>>) -> Pose {
    let x = Unit::new_normalize(x.into_inner() - z.scale(x.dot(&z)));
    let rotation = Matrix3::from_columns(&[x.into_inner(), z.cross(&x), z.into_inner()]);
    Pose::from_parts(Translation3::from(point), Rotation3::from_matrix_unchecked(rotation))
}
