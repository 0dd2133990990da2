//! Elementary motions, of which every joint is a sequence.

use nalgebra::{Rotation3, Translation3, Unit, Vector3};

use crate::spatial::Pose;

/// Kind of a joint coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// A slide (m).
    Slide,
    /// A turn (rad).
    Turn,
}

/// One elementary motion in the running frame of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Factor {
    /// A turn about an axis through `point`.
    Turn {
        /// Direction of the axis.
        axis: Unit<Vector3<f64>>,
        /// A point of it (m).
        point: Vector3<f64>,
    },
    /// A slide along an axis.
    Slide {
        /// Its direction.
        axis: Unit<Vector3<f64>>,
    },
    /// A turn about z with an advance along z.
    Screw {
        /// Advance for one radian (m/rad).
        lead: f64,
    },
    /// A rotation about the origin.
    Ball,
}

/// Motion of a body: (angular, linear) of the point at the origin.
pub(crate) type Twist = (Vector3<f64>, Vector3<f64>);

impl Factor {
    pub(crate) fn turn(axis: usize) -> Self {
        Self::Turn { axis: unit(axis), point: Vector3::zeros() }
    }

    pub(super) fn slide(axis: usize) -> Self {
        Self::Slide { axis: unit(axis) }
    }

    /// Kind of each of its coordinates.
    #[must_use]
    pub fn coordinates(&self) -> &'static [Coordinate] {
        match self {
            Self::Turn { .. } | Self::Screw { .. } => &[Coordinate::Turn],
            Self::Slide { .. } => &[Coordinate::Slide],
            Self::Ball => &[Coordinate::Turn; 3],
        }
    }

    /// Its transform at some coordinates (m, rad).
    #[must_use]
    pub fn transform(&self, q: &[f64]) -> Pose {
        match self {
            Self::Turn { axis, point } => {
                let rotation = Rotation3::from_axis_angle(axis, q[0]);
                Pose::from_parts(Translation3::from(point - rotation * point), rotation)
            }
            Self::Slide { axis } => {
                Pose::from_parts(Translation3::from(axis.scale(q[0])), Rotation3::identity())
            }
            Self::Screw { lead } => Pose::from_parts(
                Translation3::new(0.0, 0.0, lead * q[0]),
                Rotation3::from_axis_angle(&Vector3::z_axis(), q[0]),
            ),
            Self::Ball => Pose::from_parts(
                Translation3::identity(),
                Rotation3::new(Vector3::new(q[0], q[1], q[2])),
            ),
        }
    }

    /// Twist of one of its motions, in the frame before it; a ball's are about the axes of the frame.
    pub(crate) fn screw(&self, freedom: usize) -> Twist {
        match self {
            Self::Turn { axis, point } => (axis.into_inner(), point.cross(axis)),
            Self::Slide { axis } => (Vector3::zeros(), axis.into_inner()),
            Self::Screw { lead } => (Vector3::z(), Vector3::z() * *lead),
            Self::Ball => (unit(freedom).into_inner(), Vector3::zeros()),
        }
    }
}

fn unit(axis: usize) -> Unit<Vector3<f64>> {
    [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()][axis]
}
