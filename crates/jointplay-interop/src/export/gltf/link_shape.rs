//! Simple bodies of links that have no parts: bars between their joints.

use gltf_json::{Index, Node};
use jointplay_cell::geometry::Shape;
use jointplay_core::spatial::Pose;
use nalgebra::Vector3;

use super::document::Document;
use super::material::Material;
use crate::export::joint_points::{BAR, JOINT, bars};

/// Length of the capsule that draws a joint as a ball, as a share of its radius.
const BALL: f64 = 1e-3;

/// Nodes that draw a link: a ball at each joint, and bars from the middle of the joints to each of them.
pub(super) fn show_link(
    document: &mut Document,
    points: &[Vector3<f64>],
    size: f64,
    material: Material,
) -> Vec<Index<Node>> {
    let joint = |at: &Vector3<f64>| {
        let end = at + Vector3::z() * (BALL * JOINT * size);
        Shape::Capsule { ends: [(*at).into(), end.into()], radius: JOINT * size }
    };
    let bar = |from: Vector3<f64>, to: Vector3<f64>| Shape::Capsule {
        ends: [from.into(), to.into()],
        radius: BAR * size,
    };
    let mut shapes: Vec<Shape> = points.iter().map(joint).collect();
    shapes.extend(bars(points, JOINT * size).into_iter().map(|[from, to]| bar(from, to)));
    let shown =
        shapes.iter().flat_map(|shape| document.show("body", shape, &Pose::identity(), material));
    shown.collect()
}
