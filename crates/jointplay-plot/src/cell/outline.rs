//! Outline of a shape, seen from above.

use jointplay_cell::geometry::Shape;
use jointplay_core::spatial::Pose;
use nalgebra::Point3;

/// Corners of the least convex polygon about a shape at its place, seen from above, counter-clockwise; none for nothing (m).
pub(super) fn outline(shape: &Shape, at: &Pose) -> Vec<[f64; 2]> {
    let surface = shape.surface();
    let mut points: Vec<[f64; 2]> = surface
        .vertices
        .iter()
        .map(|corner| {
            let corner = at * Point3::from(*corner);
            [corner.x, corner.y]
        })
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut hull = half(points.iter());
    let upper = half(points.iter().rev());
    hull.pop();
    hull.extend(&upper[..upper.len() - 1]);
    hull
}

/// The lower half of a hull, for points from left to right; the upper one from right to left.
fn half<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> Vec<[f64; 2]> {
    let mut hull: Vec<[f64; 2]> = Vec::new();
    for &point in points {
        while let [.., a, b] = hull[..] {
            let turn = (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]);
            if turn > 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(point);
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_covers_its_base() {
        let corners =
            outline(&Shape::Box { half: [1.0, 2.0, 3.0] }, &Pose::translation(1.0, 0.0, 9.0));
        assert_eq!(corners, [[0.0, -2.0], [2.0, -2.0], [2.0, 2.0], [0.0, 2.0]]);
    }

    #[test]
    fn nothing_covers_nothing() {
        assert!(outline(&Shape::Convex { points: vec![] }, &Pose::identity()).is_empty());
    }
}
