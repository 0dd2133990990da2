//! Links drawn as plates, and the shapes and colours of links.

use nalgebra::{Matrix3, Vector3};

use super::camera::Camera;
use super::scene::Body;
use crate::svg::{element, path_data, px};

/// Fill and edge of links, of the base, and of links in another configuration.
const LINK: [&str; 2] = ["#bfd4e6", "#4a6580"];
const BASE: [&str; 2] = ["url(#base)", "#5c5c5c"];
pub(super) const GHOST: [&str; 2] = ["#f3f6f9", "#8fa3b5"];
/// Width of an edge (px).
pub(super) const EDGE: f64 = 1.1;
/// Distance below which a point is on a line, in sizes.
pub(super) const STRAIGHT: f64 = 1e-6;

/// A link drawn as a plate.
pub(super) struct Plate {
    /// Its outline on the page (px).
    pub(super) outline: Vec<(f64, f64)>,
    /// Mean of its corners, in sizes.
    pub(super) middle: Vector3<f64>,
    /// Normal of its least-squares plane, toward the eye.
    pub(super) normal: Vector3<f64>,
    /// Whether it is the base.
    pub(super) base: bool,
    /// Its SVG elements.
    pub(super) drawn: String,
}

impl Plate {
    /// The plate of a link with more than two joints that are not on one line.
    pub(super) fn of(body: &Body, camera: &Camera, width: f64) -> Option<Self> {
        let corners = corners(body)?;
        #[expect(clippy::cast_precision_loss, reason = "a count of corners")]
        let middle = corners.iter().sum::<Vector3<f64>>() / corners.len() as f64;
        let spread: Matrix3<f64> =
            corners.iter().map(|corner| (corner - middle) * (corner - middle).transpose()).sum();
        let least = spread.symmetric_eigen();
        let normal = least.eigenvectors.column(least.eigenvalues.imin()).into_owned();
        let normal = if camera.toward(&normal) < 0.0 { -normal } else { normal };
        let outline = hull(corners.iter().map(|corner| camera.spot(corner)).collect());
        let data = path_data(&outline) + "z";
        let [fill, edge] = colours(body);
        let solid = |paint: &str, width: f64| {
            let width = px(width.max(0.5));
            let paints = format!(
                " fill=\"{paint}\" stroke=\"{paint}\" stroke-width=\"{width}\" stroke-linejoin=\"round\""
            );
            element(&data, &paints)
        };
        let opacity = if body.base { 0.6 } else { 0.8 };
        let mut drawn = format!("<g opacity=\"{opacity}\">\n{}", solid(edge, width));
        for paint in under(fill) {
            drawn += &solid(paint, width - 2.0 * EDGE);
        }
        Some(Self { outline, middle, normal, base: body.base, drawn: drawn + "</g>\n" })
    }
}

/// Corners in space of a link that is no bar.
pub(super) fn corners(body: &Body) -> Option<&[Vector3<f64>]> {
    (body.joints.len() > 2 && straight(body).is_none()).then_some(&body.ends)
}

/// Corners of the convex hull, by Andrew's monotone chain.
pub(super) fn hull(mut spots: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    spots.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut around: Vec<(f64, f64)> = Vec::new();
    for _ in 0..2 {
        let start = around.len();
        for &spot in &spots {
            while around.len() >= start + 2 {
                let (a, b) = (around[around.len() - 2], around[around.len() - 1]);
                let left = (b.0 - a.0) * (spot.1 - a.1) - (b.1 - a.1) * (spot.0 - a.0);
                if left > 0.0 {
                    break;
                }
                around.pop();
            }
            around.push(spot);
        }
        around.pop();
        spots.reverse();
    }
    around
}

/// Fill and edge of a link.
pub(super) fn colours(body: &Body) -> [&'static str; 2] {
    if body.base { BASE } else { LINK }
}

/// The two ends farthest from each other, if all others are on the line between them.
pub(super) fn straight(body: &Body) -> Option<[Vector3<f64>; 2]> {
    let (mut far, mut pair) = (-1.0, None);
    for (i, &a) in body.ends.iter().enumerate() {
        for &b in &body.ends[i + 1..] {
            let apart = (a - b).norm();
            if apart > far {
                (far, pair) = (apart, Some([a, b]));
            }
        }
    }
    let [a, b] = pair?;
    let along = (b - a).try_normalize(STRAIGHT)?;
    body.ends.iter().all(|end| (end - a).cross(&along).norm() < STRAIGHT).then_some([a, b])
}

/// Paints from below to above: a pattern needs a ground.
pub(super) fn under(fill: &'static str) -> Vec<&'static str> {
    if fill.starts_with("url") { vec!["#ececec", fill] } else { vec![fill] }
}
