//! Shapes as the collision library takes them, with bounding spheres.

use jointplay_core::spatial::Pose;
use nalgebra::{Matrix3, Vector3};
use parry3d_f64::math::{Mat3, Pose3, Rot3, Vector};
use parry3d_f64::shape::SharedShape;

use super::interval::Span;
use super::shape::Shape;

/// A shape in its carrier's frame.
#[derive(Clone)]
pub(crate) struct Solid {
    pub(super) shape: SharedShape,
    /// All points no farther from the shape than this belong to it [m].
    pub(super) margin: f64,
    carrier_from_shape: Pose,
    /// Centre of a ball around it, in the carrier's frame [m].
    pub(super) center: Vector3<f64>,
    /// Radius of that ball [m].
    pub(super) radius: f64,
    extent: Extent,
}

/// What is needed for the extent of a shape in a direction, in its own frame.
#[derive(Clone, Copy)]
enum Extent {
    /// Box of half sides about a centre.
    Box { center: [f64; 3], half: [f64; 3] },
    /// Upright cylinder about the origin.
    Cylinder { radius: f64, half_height: f64 },
    /// Segment with its margin.
    Segment { ends: [[f64; 3]; 2] },
}

pub(super) fn vector(v: &[f64; 3]) -> Vector {
    Vector::new(v[0], v[1], v[2])
}

/// A pose in the collision library's words.
pub(super) fn posed(pose: &Pose) -> Pose3 {
    let r: &Matrix3<f64> = pose.rotation.matrix();
    let column = |k: usize| Vector::new(r[(0, k)], r[(1, k)], r[(2, k)]);
    let rotation = Rot3::from_mat3(&Mat3::from_cols(column(0), column(1), column(2)));
    let t = &pose.translation.vector;
    Pose3::from_parts(Vector::new(t.x, t.y, t.z), rotation)
}

impl Solid {
    /// Puts a shape into its carrier's frame; `None` where it has no points.
    ///
    /// What makes no body of its own kind (points in one plane, a mesh without triangles) is taken as the box around it, which is never smaller.
    pub(crate) fn new(shape: &Shape, carrier_from_shape: &Pose) -> Option<Self> {
        // The library's cylinders stand along y.
        let upright = Pose::from_parts(
            Vector3::zeros().into(),
            nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2),
        );
        let (mut placed, mut margin) = (*carrier_from_shape, 0.0);
        let (parry, extent) = match shape {
            Shape::Box { half } => (
                SharedShape::cuboid(half[0], half[1], half[2]),
                Extent::Box { center: [0.0; 3], half: *half },
            ),
            Shape::Cylinder { radius, half_height } => {
                placed *= upright;
                (
                    SharedShape::cylinder(*half_height, *radius),
                    Extent::Cylinder { radius: *radius, half_height: *half_height },
                )
            }
            // A segment with a margin: the library's capsules are off by micrometres.
            Shape::Capsule { ends, radius } => {
                margin = *radius;
                let segment = SharedShape::segment(vector(&ends[0]), vector(&ends[1]));
                (segment, Extent::Segment { ends: *ends })
            }
            Shape::Convex { points } => {
                let (center, half) = bounds(points)?;
                let all: Vec<Vector> = points.iter().map(vector).collect();
                let Some(hull) = SharedShape::convex_hull(&all) else {
                    return Self::boxed(carrier_from_shape, center, half);
                };
                (hull, Extent::Box { center, half })
            }
            Shape::Mesh { vertices, triangles } => {
                let (center, half) = bounds(vertices)?;
                let all = vertices.iter().map(vector).collect();
                let Ok(mesh) = SharedShape::trimesh(all, triangles.clone()) else {
                    return Self::boxed(carrier_from_shape, center, half);
                };
                (mesh, Extent::Box { center, half })
            }
        };
        let ball = parry.compute_local_bounding_sphere();
        let center = placed * nalgebra::Point3::new(ball.center.x, ball.center.y, ball.center.z);
        let solid = Self {
            shape: parry,
            margin,
            carrier_from_shape: placed,
            center: center.coords,
            radius: ball.radius + margin,
            extent,
        };
        Some(solid)
    }

    fn boxed(carrier_from_shape: &Pose, center: [f64; 3], half: [f64; 3]) -> Option<Self> {
        let shifted = carrier_from_shape * nalgebra::Translation3::from(center);
        Self::new(&Shape::Box { half }, &shifted)
    }

    /// Largest distance of its points from the carrier's origin [m].
    pub(crate) fn reach(&self) -> f64 {
        self.center.norm() + self.radius
    }

    /// Largest distance of its points from a point of the carrier's frame [m].
    pub(crate) fn reach_from(&self, point: &Vector3<f64>) -> f64 {
        (self.center - point).norm() + self.radius
    }

    /// Along a direction of its own frame, from a point there.
    fn span(&self, d: &Vector3<f64>, origin: f64) -> Span {
        let (middle, half) = match self.extent {
            Extent::Box { center, half } => (
                d.x * center[0] + d.y * center[1] + d.z * center[2],
                d.x.abs() * half[0] + d.y.abs() * half[1] + d.z.abs() * half[2],
            ),
            Extent::Cylinder { radius, half_height } => {
                (0.0, d.y.abs() * half_height + (d.x * d.x + d.z * d.z).sqrt() * radius)
            }
            Extent::Segment { ends: [a, b] } => {
                let (a, b) = (d.dot(&Vector3::from(a)), d.dot(&Vector3::from(b)));
                (0.5 * (a + b), 0.5 * (a - b).abs())
            }
        };
        let half = half + self.margin;
        Span { least: origin + middle - half, most: origin + middle + half }
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

/// A solid where its carrier is.
#[derive(Clone, Copy)]
pub(crate) struct Placed<'a> {
    pub(crate) solid: &'a Solid,
    pub(crate) base_from_carrier: &'a Pose,
}

impl Placed<'_> {
    /// Least and largest coordinate along a direction through the base origin.
    pub(crate) fn span(&self, direction: &Vector3<f64>) -> Span {
        let Pose { rotation, translation } = self.base_from_carrier;
        let on_carrier = rotation.inverse_transform_vector(direction);
        let from_shape = &self.solid.carrier_from_shape;
        let origin =
            direction.dot(&translation.vector) + on_carrier.dot(&from_shape.translation.vector);
        self.solid.span(&from_shape.rotation.inverse_transform_vector(&on_carrier), origin)
    }

    /// A box around it, axes those of the base.
    pub(crate) fn around(&self) -> [Span; 3] {
        let Pose { rotation, translation } = self.base_from_carrier * self.solid.carrier_from_shape;
        let axis = |k: usize| rotation.matrix().row(k).transpose();
        std::array::from_fn(|k| self.solid.span(&axis(k), translation.vector[k]))
    }

    pub(super) fn pose(&self) -> Pose3 {
        posed(&(self.base_from_carrier * self.solid.carrier_from_shape))
    }
}
