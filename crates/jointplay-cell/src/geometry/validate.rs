//! Conditions that the description of a shape has to fulfil.

use nalgebra::Vector3;

use super::shape::Shape;
use crate::CellError;
use crate::conditions::{MAX_LENGTH, count, in_range, index, lengths, positive};

/// Thickness of a point set, relative to its length, below which its points count as coplanar.
const MIN_RELATIVE_DEPTH: f64 = 1e-6;

impl Shape {
    /// Checks that dimensions are positive and finite, that the points of a convex hull span a volume, and that the triangles of a mesh have vertices.
    ///
    /// # Errors
    /// [`CellError::NotFinite`], [`CellError::NotPositive`], [`CellError::OutOfRange`], [`CellError::FlatHull`], [`CellError::NoSuch`]
    pub fn validate(&self) -> Result<(), CellError> {
        let size = |what: &str, value: f64| {
            positive(what.to_owned(), value, "m")?;
            in_range(what.to_owned(), value, 0.0, MAX_LENGTH, "m")
        };
        match self {
            Self::Box { half } => {
                half.iter().try_for_each(|&half| size("half of a box's edge length", half))
            }
            Self::Boxes { boxes } => {
                count("the boxes of a union", boxes.len(), 1, usize::MAX)?;
                boxes.iter().try_for_each(|one| {
                    lengths("a corner of a box", &one.min)?;
                    lengths("a corner of a box", &one.max)?;
                    one.half()
                        .iter()
                        .try_for_each(|&half| size("half of a box's edge length", half))
                })
            }
            Self::Cylinder { radius, half_height } => {
                size("the radius of a cylinder", *radius)?;
                size("half of a cylinder's height", *half_height)
            }
            Self::Capsule { ends, radius } => {
                size("the radius of a capsule", *radius)?;
                lengths("an end of a capsule", ends.as_flattened())
            }
            Self::Convex { points } => {
                lengths("a point of a convex hull", points.as_flattened())?;
                match spans_volume(points) {
                    true => Ok(()),
                    false => Err(CellError::FlatHull { points: points.len() }),
                }
            }
            Self::Mesh { vertices, triangles } => {
                lengths("a vertex of a mesh", vertices.as_flattened())?;
                triangles.as_flattened().iter().try_for_each(|&vertex| {
                    let vertex = usize::try_from(vertex).unwrap_or(usize::MAX);
                    index("a triangle", "vertex", vertex, vertices.len())
                })
            }
        }
    }
}

/// Whether points span a volume.
fn spans_volume(points: &[[f64; 3]]) -> bool {
    let Some(first) = points.first().copied().map(Vector3::from) else { return false };
    let far = points.iter().map(|&point| Vector3::from(point) - first);
    let Some(one) = far.clone().max_by(|a, b| a.norm().total_cmp(&b.norm())) else { return false };
    let Some(two) = far.clone().map(|p| one.cross(&p)).max_by(|a, b| a.norm().total_cmp(&b.norm()))
    else {
        return false;
    };
    let deepest = far.map(|p| two.dot(&p).abs()).fold(0.0, f64::max);
    deepest > MIN_RELATIVE_DEPTH * one.norm() * two.norm() && two.norm() > 0.0
}
