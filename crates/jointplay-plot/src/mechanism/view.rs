//! Viewing directions.

use std::f64::consts::PI;

use jointplay_core::mechanism::JointKind;
use nalgebra::{Vector2, Vector3};

use super::scene::Scene;
use crate::path::{Spot, crossing};

/// The direction from the mechanism to the viewer, with z up in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Azimuth of the eye, from x toward y (rad).
    pub azimuth: f64,
    /// Elevation of the eye above the xy plane (rad).
    pub elevation: f64,
}

/// Directions nearer to parallel than this count as parallel.
const PARALLEL: f64 = 1e-6;
/// Angle between the view of a planar mechanism and its normal, so that hinges show their direction (rad).
const OBLIQUITY: f64 = 25.0 * PI / 180.0;
/// The default view.
const USUAL: View = View { azimuth: -60.0 * PI / 180.0, elevation: 25.0 * PI / 180.0 };
/// Largest number of joints considered in the choice of a view.
const LOOKED_AT: usize = 120;
/// Distance in the picture above which two joints are well separated, in sizes of the mechanism.
const APART: f64 = 0.12;

impl View {
    /// Unit vectors in the base frame: right and up in the picture, and toward the eye.
    pub(super) fn frame(self) -> [Vector3<f64>; 3] {
        let (sin_a, cos_a) = self.azimuth.sin_cos();
        let (sin_e, cos_e) = self.elevation.sin_cos();
        let eye = Vector3::new(cos_e * cos_a, cos_e * sin_a, sin_e);
        let right = Vector3::new(-sin_a, cos_a, 0.0);
        [right, eye.cross(&right), eye]
    }

    /// The view that separates the joints best: almost along the normal for a planar mechanism, else the best of a raster of views.
    pub(super) fn of(scene: &Scene) -> Self {
        match common_axis(scene) {
            Some(normal) => square_on(normal),
            None => best(scene),
        }
    }
}

/// The direction that all axes of turns have in common and all slides are square to.
fn common_axis(scene: &Scene) -> Option<Vector3<f64>> {
    let mut common: Option<Vector3<f64>> = None;
    for joint in &scene.joints {
        match joint.kind {
            JointKind::Revolute | JointKind::Helical { .. } | JointKind::Planar => {
                let axis = joint.axis();
                if common.is_some_and(|n| n.cross(&axis).norm() > PARALLEL) {
                    return None;
                }
                common = Some(axis);
            }
            JointKind::Prismatic | JointKind::Fixed => {}
            _ => return None,
        }
    }
    let normal = common?;
    let mut slides = scene.joints.iter().filter(|joint| joint.kind == JointKind::Prismatic);
    slides.all(|slide| slide.axis().dot(&normal).abs() < PARALLEL).then_some(normal)
}

/// A view almost along the normal of a plane, from its front side.
fn square_on(normal: Vector3<f64>) -> View {
    let [_, _, usual] = USUAL.frame();
    let toward = if normal.dot(&usual) < 0.0 { -normal } else { normal };
    let flat = toward.z.clamp(-1.0, 1.0).asin();
    if flat > PI / 2.0 - OBLIQUITY {
        // Lying flat: x to the right, y up.
        return View { azimuth: -PI / 2.0, elevation: PI / 2.0 - OBLIQUITY };
    }
    View { azimuth: toward.y.atan2(toward.x) + OBLIQUITY, elevation: flat + 0.6 * OBLIQUITY }
}

fn best(scene: &Scene) -> View {
    let degrees = |n: i32| f64::from(n) * PI / 180.0;
    let mut found = (f64::NEG_INFINITY, USUAL);
    for elevation in [20, 25, 30, 40] {
        for step in 0..36 {
            let view = View { azimuth: degrees(10 * step - 180), elevation: degrees(elevation) };
            let merit = merit(scene, view);
            if merit > found.0 {
                found = (merit, view);
            }
        }
    }
    found.1
}

/// Merit of a view: separation of joints and visible length of bars, less its distance from the default view.
fn merit(scene: &Scene, view: View) -> f64 {
    let [right, up, eye] = view.frame();
    let flat = |p: &Vector3<f64>| Vector2::new(p.dot(&right), p.dot(&up));
    let spots: Vec<_> = scene.joints.iter().take(LOOKED_AT).map(|j| (j.at, flat(&j.at))).collect();
    let (mut worth, mut pairs) = (0.0, 0.0);
    for (i, (a, flat_a)) in spots.iter().enumerate() {
        for (b, flat_b) in &spots[i + 1..] {
            let apart = (a - b).norm().min(APART);
            // Coincident joints coincide in every view.
            if apart > 0.0 {
                worth += ((flat_a - flat_b).norm() / apart).min(1.0);
                pairs += 1.0;
            }
        }
    }
    let seen = if pairs > 0.0 { worth / pairs } else { 1.0 };
    let bars: Vec<f64> = scene
        .links
        .iter()
        .take(LOOKED_AT)
        .filter(|link| link.joints.len() == 2)
        .map(|link| scene.joints[link.joints[0]].at - scene.joints[link.joints[1]].at)
        .filter(|bar| bar.norm() > 0.0)
        .map(|bar| 1.0 - (bar.dot(&eye) / bar.norm()).powi(2))
        .collect();
    let axes = scene.joints.iter().take(LOOKED_AT).filter(|joint| joint.has_axis());
    let shown: Vec<f64> = axes.map(|joint| direction_shown(joint.axis().dot(&eye).abs())).collect();
    let crossed = f64::from(crossings(scene, &spots).min(20));
    let [_, _, usual] = USUAL.frame();
    seen + 0.3 * mean(&bars) + 0.2 * mean(&shown) + 0.2 * fill(&spots) + 0.2 * eye.dot(&usual)
        - 0.05 * crossed
}

/// The mean; 1 for no values.
fn mean(values: &[f64]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let count = values.len() as f64;
    if values.is_empty() { 1.0 } else { values.iter().sum::<f64>() / count }
}

/// Visibility of the direction of an axis: a hinge seen as a circle or as a rectangle hides it.
fn direction_shown(toward: f64) -> f64 {
    (5.0 * toward).min(8.0 * (1.0 - toward)).clamp(0.0, 1.0)
}

/// How often bars without a common joint cross in the picture.
fn crossings(scene: &Scene, spots: &[(Vector3<f64>, Vector2<f64>)]) -> u32 {
    let spot = |j: usize| spots.get(j).map(|(_, spot)| (spot.x, spot.y));
    let bars: Vec<(&[usize], [Spot; 2])> = scene
        .links
        .iter()
        .flat_map(|link| link.joints.windows(2).map(|pair| (&link.joints[..], pair)))
        .filter_map(|(joints, pair)| Some((joints, [spot(pair[0])?, spot(pair[1])?])))
        .collect();
    let mut count = 0;
    for (i, (joints, [p, q])) in bars.iter().enumerate() {
        for (others, [r, s]) in &bars[i + 1..] {
            let apart = !joints.iter().any(|joint| others.contains(joint));
            if apart && crossing(*p, *q, *r, *s).is_some() {
                count += 1;
            }
        }
    }
    count
}

/// How high the picture is against its width, up to a page's own shape.
fn fill(spots: &[(Vector3<f64>, Vector2<f64>)]) -> f64 {
    let flat = |worst: f64, pick: fn(f64, f64) -> f64| {
        spots.iter().fold(Vector2::repeat(worst), |found, (_, spot)| found.zip_map(spot, pick))
    };
    let size = flat(f64::MIN, f64::max) - flat(f64::MAX, f64::min);
    if size.x > 0.0 { (size.y / size.x / 0.7).min(1.0) } else { 0.0 }
}
