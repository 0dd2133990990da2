//! Constraints of FreeCAD between two parts that are several joints in series here, with links between them.
//!
//! Each series has as many coordinates as the constraint leaves freedoms, so that rank and mobility do not change.

use std::f64::consts::{FRAC_PI_2, PI};

use jointplay_core::mechanism::{Joint, JointKind};
use jointplay_core::spatial::Pose;
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use super::placed_joint::{PlacedFrame, placed_joint};

/// Least sine of an angle between two axes, below which they are parallel and leave another number of freedoms.
const LEAST_SINE: f64 = 1e-9;

/// A constraint between two frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SeriesKind {
    /// The origin of the second frame is in a plane parallel to xy of the first, at this distance along z (m).
    PointInPlane(f64),
    /// The axis z of the second frame is in a plane parallel to xy of the first, at this distance along z (m).
    LineInPlane(f64),
    /// The origins are at this distance, which is above zero (m).
    PointAtDistance(f64),
    /// The origin of the second frame is at this distance from the axis z of the first (m).
    PointNearLine(f64),
    /// The axes z are parallel, at this distance (m).
    ParallelLines(f64),
    /// The axes z are parallel.
    ParallelAxes,
    /// The axes z are perpendicular.
    Perpendicular,
    /// The axes z are at this angle (rad).
    Angle(f64),
}

/// Joints in series, and the links between them with their poses in the assembly as drawn (m).
#[derive(Default)]
pub(super) struct JointSeries {
    pub(super) joints: Vec<Joint>,
    pub(super) links: Vec<(String, Pose)>,
}

/// A series under construction, from its first frame on.
struct Builder<'n, F> {
    name: &'n str,
    /// Number of the first link between the joints.
    next_link: usize,
    series: JointSeries,
    /// The frame from which the next joint starts.
    at: PlacedFrame,
    ignore: F,
}

impl<F: FnMut(String)> Builder<'_, F> {
    fn joint(&mut self, kind: JointKind, from: &PlacedFrame, to: &PlacedFrame) {
        let name = format!("{} {}", self.name, self.series.joints.len() + 1);
        self.series.joints.push(placed_joint(name, kind, [from, to], &mut self.ignore));
    }

    /// A joint about or along an axis of the last frame, to a new link whose frame is moved from it.
    ///
    /// # Arguments
    /// * `along` – rotation of z to the axis of the joint
    fn step(&mut self, kind: JointKind, along: Rotation3<f64>, by: Pose) {
        let number = self.series.links.len();
        let drawn = self.at.drawn * by;
        let link = self.next_link + number;
        self.series.links.push((format!("{}, part {}", self.name, number + 1), drawn));
        let next = PlacedFrame { link, in_link: Pose::identity(), drawn };
        let from = self.at.turned(along);
        self.joint(kind, &from, &next.turned(along));
        self.at = next;
    }

    fn slide(&mut self, along: Rotation3<f64>, by: f64) {
        let shift = along * Vector3::new(0.0, 0.0, by);
        self.step(JointKind::Prismatic, along, Pose::translation(shift.x, shift.y, shift.z));
    }

    /// The last joint, to the second frame.
    fn end(mut self, kind: JointKind, along: Rotation3<f64>, second: &PlacedFrame) -> JointSeries {
        let from = self.at.turned(along);
        self.joint(kind, &from, second);
        self.series
    }
}

/// The joints of a constraint, which start as drawn.
///
/// # Arguments
/// * `next_link` – number of the first link between the joints
pub(super) fn joint_series(
    name: &str,
    kind: SeriesKind,
    [first, second]: [&PlacedFrame; 2],
    next_link: usize,
    ignore: impl FnMut(String),
) -> JointSeries {
    let first_from_second = first.drawn.inverse() * second.drawn;
    let (turn, shift) = (first_from_second.rotation, first_from_second.translation.vector);
    let axis = turn * Vector3::z();
    let at = first.shifted(Vector3::zeros());
    let mut series = Builder { name, next_link, series: JointSeries::default(), at, ignore };
    let about_z = |angle: f64| Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
    let [along_x, along_y, along_z] = [
        Rotation3::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2),
        Rotation3::from_axis_angle(&Vector3::x_axis(), -FRAC_PI_2),
        Rotation3::identity(),
    ];
    let turned = |by: Rotation3<f64>, [x, y, z]: [f64; 3]| {
        Pose::from_parts(Vector3::new(x, y, z).into(), by)
    };
    match kind {
        SeriesKind::PointInPlane(offset) => {
            series.at = first.shifted(Vector3::new(0.0, 0.0, offset));
            series.slide(along_x, shift.x);
            series.slide(along_y, shift.y);
            series.end(JointKind::Spherical, along_z, second)
        }
        SeriesKind::LineInPlane(offset) => {
            series.at = first.shifted(Vector3::new(0.0, 0.0, offset));
            let heading = about_z(axis.y.atan2(axis.x));
            series.step(JointKind::Planar, along_z, turned(heading, [shift.x, shift.y, 0.0]));
            series.end(JointKind::Revolute, along_x, second)
        }
        SeriesKind::PointAtDistance(distance) => {
            let rod = Unit::try_new(shift, f64::MIN_POSITIVE).unwrap_or(Vector3::x_axis());
            // The rod turns about two axes that are perpendicular to it as drawn.
            let least = (0..3).min_by(|&a, &b| rod[a].abs().total_cmp(&rod[b].abs()));
            let one = Unit::new_normalize(rod.cross(&Vector3::ith(least.unwrap_or(0), 1.0)));
            let other = rod.cross(&one.into_inner());
            let basis = Matrix3::from_columns(&[other, rod.into_inner(), one.into_inner()]);
            series.at = first.turned(Rotation3::from_matrix_unchecked(basis));
            let link = series.next_link;
            let rod = PlacedFrame { link, in_link: Pose::identity(), drawn: series.at.drawn };
            series.series.links.push((format!("{name}, part 1"), rod.drawn));
            let start = series.at.shifted(Vector3::zeros());
            series.joint(JointKind::Universal, &start, &rod.turned(along_x));
            series.at = rod.shifted(Vector3::new(0.0, distance, 0.0));
            series.end(JointKind::Spherical, along_z, second)
        }
        SeriesKind::PointNearLine(distance) | SeriesKind::ParallelLines(distance) => {
            let heading = about_z(shift.y.atan2(shift.x));
            series.step(JointKind::Cylindrical, along_z, turned(heading, [0.0, 0.0, shift.z]));
            series.at = series.at.shifted(Vector3::new(distance, 0.0, 0.0));
            let last = match kind {
                SeriesKind::PointNearLine(_) => JointKind::Spherical,
                _ => JointKind::Revolute,
            };
            series.end(last, along_z, second)
        }
        SeriesKind::ParallelAxes => {
            // The solver also accepts axes of opposite directions.
            let half = Rotation3::from_axis_angle(&Vector3::x_axis(), PI);
            let upright = if axis.z < 0.0 { turn * half } else { turn };
            let heading = about_z(upright[(1, 0)].atan2(upright[(0, 0)]));
            series.step(JointKind::Planar, along_z, turned(heading, [shift.x, shift.y, 0.0]));
            series.end(JointKind::Prismatic, along_z, second)
        }
        SeriesKind::Perpendicular | SeriesKind::Angle(_) => {
            if let SeriesKind::Angle(angle) = kind
                && angle.sin().abs() < LEAST_SINE
            {
                let kind = SeriesKind::ParallelAxes;
                return joint_series(name, kind, [first, second], next_link, series.ignore);
            }
            series.slide(along_x, shift.x);
            series.slide(along_y, shift.y);
            series.slide(along_z, shift.z);
            match kind {
                SeriesKind::Angle(angle) => {
                    let heading = about_z(axis.y.atan2(axis.x));
                    series.step(JointKind::Revolute, along_z, turned(heading, [0.0; 3]));
                    let tilt = Rotation3::from_axis_angle(&Vector3::y_axis(), angle.abs());
                    series.end(JointKind::Revolute, tilt, second)
                }
                _ => series.end(JointKind::Universal, along_z, second),
            }
        }
    }
}
