//! Shapes as triangles, for display and export.

use parry3d_f64::math::Vector;
use parry3d_f64::shape::{Capsule, Cuboid, Cylinder};
use parry3d_f64::transformation::try_convex_hull;

use super::shape::Shape;

/// Vertices of the polygon that approximates a circle: the deviation is below half a percent of the radius.
const CIRCLE_VERTICES: u32 = 32;

/// Triangles on the surface of a shape.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surface {
    /// Vertices in the frame of the shape (m).
    pub vertices: Vec<[f64; 3]>,
    /// Vertices of each triangle, by index, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// Triangulated surface; each box of a union has a surface of its own, circles are polygons with 32 vertices, and points in one plane have no surface.
    #[must_use]
    pub fn surface(&self) -> Surface {
        let surface_of = |(vertices, triangles): (Vec<Vector>, Vec<[u32; 3]>)| Surface {
            vertices: vertices.iter().map(|at| [at.x, at.y, at.z]).collect(),
            triangles,
        };
        match self {
            Self::Box { half } => surface_of(Cuboid::new(Vector::from(*half)).to_trimesh()),
            Self::Boxes { boxes } => {
                let mut surface = Surface::default();
                for one in boxes {
                    let center = one.center();
                    let part = Self::Box { half: one.half() }.surface();
                    let first = surface.vertices.len() as u32;
                    let shifted =
                        part.vertices.iter().map(|at| [0, 1, 2].map(|k| at[k] + center[k]));
                    surface.vertices.extend(shifted);
                    let corners = part.triangles.iter().map(|corners| corners.map(|k| first + k));
                    surface.triangles.extend(corners);
                }
                surface
            }
            Self::Cylinder { radius, half_height } => {
                let mut surface =
                    surface_of(Cylinder::new(*half_height, *radius).to_trimesh(CIRCLE_VERTICES));
                // The axis of the library's cylinder is y.
                surface.vertices.iter_mut().for_each(|[x, y, z]| (*x, *y, *z) = (*x, -*z, *y));
                surface
            }
            Self::Capsule { ends: [from, to], radius } => {
                let capsule = Capsule::new(Vector::from(*from), Vector::from(*to), *radius);
                surface_of(capsule.to_trimesh(CIRCLE_VERTICES, CIRCLE_VERTICES / 2))
            }
            Self::Convex { points } => {
                let points: Vec<Vector> = points.iter().map(|&at| Vector::from(at)).collect();
                try_convex_hull(&points).map_or_else(|_| Surface::default(), surface_of)
            }
            Self::Mesh { vertices, triangles } => {
                Surface { vertices: vertices.clone(), triangles: triangles.clone() }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::shape::AxisAlignedBox;
    use super::*;

    /// Volume within a closed surface whose triangles run counter-clockwise seen from outside (m³).
    fn volume(surface: &Surface) -> f64 {
        let at = |k: u32| nalgebra::Vector3::from(surface.vertices[k as usize]);
        surface.triangles.iter().map(|t| at(t[0]).dot(&at(t[1]).cross(&at(t[2]))) / 6.0).sum()
    }

    #[track_caller]
    fn check(shape: &Shape, expected: f64) {
        let found = volume(&shape.surface());
        assert!((found / expected - 1.0).abs() < 0.02, "{shape:?}: {found} for {expected}");
    }

    #[test]
    fn surfaces_are_closed_and_face_outward() {
        let pi = std::f64::consts::PI;
        check(&Shape::Box { half: [0.1, 0.2, 0.3] }, 0.048);
        let slabs =
            [0.0, 1.0].map(|x| AxisAlignedBox { min: [x, 0.0, 0.0], max: [x + 1.0, 2.0, 3.0] });
        check(&Shape::Boxes { boxes: slabs.to_vec() }, 12.0);
        check(&Shape::Cylinder { radius: 0.2, half_height: 0.05 }, pi * 0.04 * 0.1);
        let capsule = Shape::Capsule { ends: [[1.0, 0.0, 0.0], [1.0, 0.0, 0.5]], radius: 0.1 };
        check(&capsule, pi * 0.01 * (0.5 + 4.0 / 3.0 * 0.1));
        let corners = [0.0, 1.0].map(|x| [0.0, 1.0].map(|y| [0.0, 1.0].map(|z| [x, y, z])));
        let points = corners.as_flattened().as_flattened().to_vec();
        check(&Shape::Convex { points }, 1.0);
    }

    #[test]
    fn the_axis_of_a_cylinder_is_vertical() {
        let surface = Shape::Cylinder { radius: 0.2, half_height: 0.05 }.surface();
        let highest = surface.vertices.iter().map(|at| at[2]).reduce(f64::max).unwrap();
        assert!((highest - 0.05).abs() < 1e-15);
    }

    #[test]
    fn points_in_a_plane_bound_nothing() {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert!(volume(&Shape::Convex { points }.surface()).abs() < 1e-12);
        assert_eq!(Shape::Convex { points: vec![] }.surface(), Surface::default());
    }
}
