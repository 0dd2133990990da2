//! Shapes as the collision library takes them, with bounding spheres.

use jointplay_core::spatial::Pose;
use nalgebra::{Matrix3, Vector3};
use parry3d_f64::math::{Mat3, Pose3, Rot3, Vector};
use parry3d_f64::shape::SharedShape;

use super::interval::Interval;
use super::shape::{AxisAlignedBox, Shape};

/// Shape in the frame of the body that it is attached to, with its bounding sphere.
#[derive(Clone)]
pub(crate) struct Collider {
    pub(super) shape: SharedShape,
    /// Radius by which the shape is inflated (m).
    pub(super) margin: f64,
    parent_from_shape: Pose,
    /// Centre of the bounding sphere in the frame of the parent (m).
    pub(super) center: Vector3<f64>,
    /// Radius of the bounding sphere (m).
    pub(super) radius: f64,
    extent: SupportExtent,
}

/// Box, cylinder or segment whose extent along a direction bounds that of the shape, in the frame of the shape.
#[derive(Clone, Copy)]
enum SupportExtent {
    /// Box about a centre.
    Box { center: [f64; 3], half: [f64; 3] },
    /// Cylinder about the origin with its axis along y.
    Cylinder { radius: f64, half_height: f64 },
    /// Segment.
    Segment { ends: [[f64; 3]; 2] },
}

pub(super) fn vector(v: &[f64; 3]) -> Vector {
    Vector::new(v[0], v[1], v[2])
}

/// A pose as the collision library takes it.
pub(super) fn posed(pose: &Pose) -> Pose3 {
    let r: &Matrix3<f64> = pose.rotation.matrix();
    let column = |k: usize| Vector::new(r[(0, k)], r[(1, k)], r[(2, k)]);
    let rotation = Rot3::from_mat3(&Mat3::from_cols(column(0), column(1), column(2)));
    let t = &pose.translation.vector;
    Pose3::from_parts(Vector::new(t.x, t.y, t.z), rotation)
}

impl Collider {
    /// Collider of a shape; `None` where the shape has no points.
    ///
    /// Unions of boxes are compounds of the library, whose distances are less exact than those between single boxes: see [`ColliderCache::get_convex`](super::ColliderCache::get_convex).
    /// Points in one plane and meshes without triangles are replaced by their bounding box, which contains them.
    pub(crate) fn new(shape: &Shape, parent_from_shape: &Pose) -> Option<Self> {
        // The axis of the library's cylinders is y.
        let upright = Pose::from_parts(
            Vector3::zeros().into(),
            nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2),
        );
        let (mut placed, mut margin) = (*parent_from_shape, 0.0);
        let (parry, extent) = match shape {
            Shape::Box { half } => (
                SharedShape::cuboid(half[0], half[1], half[2]),
                SupportExtent::Box { center: [0.0; 3], half: *half },
            ),
            Shape::Boxes { boxes } => {
                let corners: Vec<[f64; 3]> =
                    boxes.iter().flat_map(|one| [one.min, one.max]).collect();
                let (center, half) = bounds(&corners)?;
                let part = |one: &AxisAlignedBox| {
                    let [x, y, z] = one.half();
                    let at = Pose3::from_parts(vector(&one.center()), Rot3::IDENTITY);
                    (at, SharedShape::cuboid(x, y, z))
                };
                let parts = SharedShape::compound(boxes.iter().map(part).collect());
                (parts, SupportExtent::Box { center, half })
            }
            Shape::Cylinder { radius, half_height } => {
                placed *= upright;
                (
                    SharedShape::cylinder(*half_height, *radius),
                    SupportExtent::Cylinder { radius: *radius, half_height: *half_height },
                )
            }
            // A segment with a margin: the library's capsules are off by micrometres.
            Shape::Capsule { ends, radius } => {
                margin = *radius;
                let segment = SharedShape::segment(vector(&ends[0]), vector(&ends[1]));
                (segment, SupportExtent::Segment { ends: *ends })
            }
            Shape::Convex { points } => {
                let (center, half) = bounds(points)?;
                let all: Vec<Vector> = points.iter().map(vector).collect();
                let Some(hull) = SharedShape::convex_hull(&all) else {
                    return Self::boxed(parent_from_shape, center, half);
                };
                (hull, SupportExtent::Box { center, half })
            }
            Shape::Mesh { vertices, triangles } => {
                let (center, half) = bounds(vertices)?;
                let all = vertices.iter().map(vector).collect();
                let Ok(mesh) = SharedShape::trimesh(all, triangles.clone()) else {
                    return Self::boxed(parent_from_shape, center, half);
                };
                (mesh, SupportExtent::Box { center, half })
            }
        };
        let ball = parry.compute_local_bounding_sphere();
        let center = placed * nalgebra::Point3::new(ball.center.x, ball.center.y, ball.center.z);
        let collider = Self {
            shape: parry,
            margin,
            parent_from_shape: placed,
            center: center.coords,
            radius: ball.radius + margin,
            extent,
        };
        Some(collider)
    }

    fn boxed(parent_from_shape: &Pose, center: [f64; 3], half: [f64; 3]) -> Option<Self> {
        let shifted = parent_from_shape * nalgebra::Translation3::from(center);
        Self::new(&Shape::Box { half }, &shifted)
    }

    /// Largest distance of a point from the origin of the parent (m).
    pub(crate) fn bounding_radius(&self) -> f64 {
        self.center.norm() + self.radius
    }

    /// Largest distance of a point from a point in the frame of the parent (m).
    pub(crate) fn reach_from(&self, point: &Vector3<f64>) -> f64 {
        (self.center - point).norm() + self.radius
    }

    /// Extent along a direction of the frame of the shape, from an origin (m).
    fn extent_along(&self, d: &Vector3<f64>, origin: f64) -> Interval {
        let (middle, half) = match self.extent {
            SupportExtent::Box { center, half } => (
                d.x * center[0] + d.y * center[1] + d.z * center[2],
                d.x.abs() * half[0] + d.y.abs() * half[1] + d.z.abs() * half[2],
            ),
            SupportExtent::Cylinder { radius, half_height } => {
                (0.0, d.y.abs() * half_height + (d.x * d.x + d.z * d.z).sqrt() * radius)
            }
            SupportExtent::Segment { ends: [a, b] } => {
                let (a, b) = (d.dot(&Vector3::from(a)), d.dot(&Vector3::from(b)));
                (0.5 * (a + b), 0.5 * (a - b).abs())
            }
        };
        let half = half + self.margin;
        Interval { min: origin + middle - half, max: origin + middle + half }
    }
}

fn bounds(points: &[[f64; 3]]) -> Option<([f64; 3], [f64; 3])> {
    let first = *points.first()?;
    let (mut least, mut most) = (first, first);
    for point in points {
        for k in 0..3 {
            least[k] = least[k].min(point[k]);
            most[k] = most[k].max(point[k]);
        }
    }
    let middle = |k: usize| 0.5 * (least[k] + most[k]);
    let half = |k: usize| 0.5 * (most[k] - least[k]);
    Some((std::array::from_fn(middle), std::array::from_fn(half)))
}

/// Collider at the pose of its parent.
#[derive(Clone, Copy)]
pub(crate) struct PlacedCollider<'a> {
    pub(crate) collider: &'a Collider,
    pub(crate) base_from_parent: &'a Pose,
}

impl PlacedCollider<'_> {
    /// Minimum and maximum coordinate along a direction through the base origin.
    pub(crate) fn extent_along(&self, direction: &Vector3<f64>) -> Interval {
        let Pose { rotation, translation } = self.base_from_parent;
        let in_parent = rotation.inverse_transform_vector(direction);
        let from_shape = &self.collider.parent_from_shape;
        let origin =
            direction.dot(&translation.vector) + in_parent.dot(&from_shape.translation.vector);
        self.collider
            .extent_along(&from_shape.rotation.inverse_transform_vector(&in_parent), origin)
    }

    /// Axis-aligned box around the collider in the base frame.
    pub(crate) fn aabb(&self) -> [Interval; 3] {
        let Pose { rotation, translation } =
            self.base_from_parent * self.collider.parent_from_shape;
        let axis = |k: usize| rotation.matrix().row(k).transpose();
        std::array::from_fn(|k| self.collider.extent_along(&axis(k), translation.vector[k]))
    }

    pub(super) fn pose(&self) -> Pose3 {
        posed(&(self.base_from_parent * self.collider.parent_from_shape))
    }
}
