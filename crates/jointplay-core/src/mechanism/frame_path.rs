//! Commanded poses of a frame along a path.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use super::FrameId;
use crate::Error;
use crate::error::finite;
use crate::spatial::{Pose, nearest_angle};

/// Largest tilt of the z axis from its direction at home, at which its coordinates are still regular: 80° (rad).
const MOST_TILT: f64 = 80.0 * TAU / 360.0;

/// Commanded orientation of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OrientationTarget {
    /// Not commanded.
    Free,
    /// Direction of the z axis in the base frame; the rotation about it is free.
    Normal(Unit<Vector3<f64>>),
    /// The rotation `base_from_frame`.
    Full(Rotation3<f64>),
}

/// Commanded part of the pose of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameTarget {
    /// Coordinates of the origin in the base frame (m); `None` where they are free.
    pub position: [Option<f64>; 3],
    /// Orientation.
    pub orientation: OrientationTarget,
}

/// Commanded poses of one frame at the points of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct FramePath {
    /// The frame.
    pub frame: FrameId,
    /// Targets at the points, the start first; all of them command the same coordinates.
    pub targets: Vec<FrameTarget>,
}

impl FrameTarget {
    /// Which of the displacements along x, y, z and of the turns about x, y, z are commanded.
    fn commanded(&self) -> [bool; 6] {
        let [x, y, z] = self.position.map(|value| value.is_some());
        let (tilt, turn) = match self.orientation {
            OrientationTarget::Free => (false, false),
            OrientationTarget::Normal(_) => (true, false),
            OrientationTarget::Full(_) => (true, true),
        };
        [x, y, z, tilt, tilt, turn]
    }
}

/// A path in the coordinates of a chain that measures the pose of a frame from home.
///
/// ```text
///    base_from_frame = T(home origin + (x, y, z)) · E Rx(a) Ry(b) Rz(c) Eᵀ · home rotation
/// ```
/// The z axis of E is that of the frame at home, so that a and b alone determine its direction.
pub(super) struct MeasuredPath {
    /// E, in the base frame.
    pub(super) axes: Rotation3<f64>,
    /// Which of x, y, z, a, b, c are commanded.
    pub(super) commanded: [bool; 6],
    /// Values of the commanded coordinates at the points (m, rad).
    pub(super) points: Vec<Vec<f64>>,
}

impl MeasuredPath {
    /// # Arguments
    /// * `home` – pose of the frame in the base frame, at home (m)
    pub(super) fn new(path: &FramePath, home: &Pose) -> Result<Self, Error> {
        let axes = axes(path, home);
        let commanded = path.targets.first().map_or([false; 6], FrameTarget::commanded);
        let mut points: Vec<[f64; 6]> = Vec::with_capacity(path.targets.len());
        for target in &path.targets {
            if target.commanded() != commanded {
                let count = |of: [bool; 6]| of.into_iter().filter(|one| *one).count();
                let (what, found) = ("commanded coordinates of a frame", count(target.commanded()));
                return Err(Error::LengthMismatch { what, found, expected: count(commanded) });
            }
            let mut point = [0.0; 6];
            for (k, value) in target.position.iter().enumerate() {
                if let Some(value) = value {
                    point[k] = finite("commanded position", *value)? - home.translation.vector[k];
                }
            }
            let angles = match target.orientation {
                OrientationTarget::Free => [0.0; 3],
                OrientationTarget::Normal(normal) => tilt(&(axes.inverse() * *normal))?,
                OrientationTarget::Full(rotation) => {
                    turns((axes.inverse() * rotation * home.rotation.inverse() * axes).matrix())?
                }
            };
            for (k, &angle) in angles.iter().enumerate() {
                // As many full turns as before.
                let before = points.last().map_or(0.0, |before| before[3 + k]);
                point[3 + k] = nearest_angle(angle, before);
            }
            points.push(point);
        }
        let chosen = |point: [f64; 6]| {
            point.into_iter().zip(commanded).filter_map(|(value, one)| one.then_some(value))
        };
        let points = points.into_iter().map(|point| chosen(point).collect()).collect();
        Ok(Self { axes, commanded, points })
    }
}

/// E: the z axis of the frame at home, and the axis of its largest tilt, about which turns are regular.
fn axes(path: &FramePath, home: &Pose) -> Rotation3<f64> {
    let z = home.rotation * Vector3::z();
    let normal = |target: &FrameTarget| match target.orientation {
        OrientationTarget::Free => z,
        OrientationTarget::Normal(normal) => *normal,
        OrientationTarget::Full(rotation) => rotation * Vector3::z(),
    };
    let axes = path.targets.iter().map(|target| z.cross(&normal(target)));
    let longest = axes.max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    let x = longest.and_then(|axis| axis.try_normalize(1e-9));
    let x = x.unwrap_or_else(|| home.rotation * Vector3::x());
    Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z]))
}

/// a and b of a direction of the z axis.
fn tilt(normal: &Vector3<f64>) -> Result<[f64; 3], Error> {
    let b = normal.x.clamp(-1.0, 1.0).asin();
    regular(b)?;
    Ok([(-normal.y).atan2(normal.z), b, 0.0])
}

/// a, b and c of a rotation.
fn turns(m: &Matrix3<f64>) -> Result<[f64; 3], Error> {
    let b = m[(0, 2)].clamp(-1.0, 1.0).asin();
    regular(b)?;
    Ok([(-m[(1, 2)]).atan2(m[(2, 2)]), b, (-m[(0, 1)]).atan2(m[(0, 0)])])
}

fn regular(b: f64) -> Result<(), Error> {
    if b.abs() <= MOST_TILT {
        return Ok(());
    }
    let what = "tilt across the axis of the largest tilt of the path";
    Err(Error::OutOfRange { what, value: b, min: -MOST_TILT, max: MOST_TILT, unit: "rad" })
}
