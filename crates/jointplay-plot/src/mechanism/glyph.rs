//! Shapes of joints, oriented in space.

use jointplay_core::mechanism::JointKind;
use nalgebra::{Rotation3, Vector3};

use super::camera::Camera;
use super::item::Item;
use super::scene::{DrawnJoint, Load, Play, RAIL};
use crate::Colour;
use crate::svg::{element, path_data, px};

/// Colours of a body: side, lit face, edges.
#[derive(Clone, Copy)]
pub(super) struct Material {
    side: Colour,
    light: Colour,
    edge: Colour,
}

/// Width of a line of play (px).
pub(super) const GAP: f64 = 3.0;

/// A passive joint.
const PASSIVE: Material = Material {
    side: Colour::rgb(205, 214, 222),
    light: Colour::rgb(250, 251, 252),
    edge: Colour::rgb(40, 52, 64),
};
/// A joint that a motor drives.
pub(super) const ACTUATED: Material = Material {
    side: Colour::rgb(213, 94, 0),
    light: Colour::rgb(246, 178, 122),
    edge: Colour::rgb(92, 36, 0),
};
/// A virtual joint.
pub(super) const PLAY: Colour = Colour::rgb(158, 47, 128);
/// A force or moment.
pub(super) const LOAD: Colour = Colour::rgb(0, 114, 178);
/// A rail or an imagined line.
const LINE: &str = "#7a8794";

impl Material {
    fn attributes(self, face: Colour) -> String {
        format!(
            " fill=\"{}\" stroke=\"{}\" stroke-width=\"1.1\" stroke-linejoin=\"round\"",
            face.hex(),
            self.edge.hex()
        )
    }

    /// A patch of it for a legend (px).
    pub(super) fn swatch(self) -> String {
        element("M0 -5h18v10h-18z", &self.attributes(self.side))
    }
}

/// A joint by its kind.
pub(super) fn joint(joint: &DrawnJoint, camera: &Camera, radius: f64, items: &mut Vec<Item>) {
    let material = if joint.actuated { ACTUATED } else { PASSIVE };
    let (at, axis) = (joint.at, joint.axis());
    // In front of the links that meet here, and a pin in front of its block.
    let before = if joint.kind == JointKind::Prismatic { 1.0 } else { 1.5 };
    let depth = camera.depth(&at) + before * radius;
    let mut drawn = String::new();
    match joint.kind {
        JointKind::Revolute => {
            if joint.on_sphere {
                items.push(line_to_center(joint, camera));
            }
            drawn += &cylinder(camera, at, axis, radius, 1.25 * radius, material);
        }
        JointKind::Helical { .. } => {
            drawn += &cylinder(camera, at, axis, radius, 1.8 * radius, material);
            drawn += &thread(camera, at, axis, radius, material);
        }
        JointKind::Cylindrical => {
            items.push(rail(camera, at, axis, RAIL * radius));
            drawn += &cylinder(camera, at, axis, 0.4 * radius, 3.6 * radius, PASSIVE);
            drawn += &cylinder(camera, at, axis, radius, 1.9 * radius, material);
        }
        JointKind::Prismatic => {
            items.push(rail(camera, at, axis, RAIL * radius));
            let sizes = Vector3::new(1.0, 1.0, 1.6) * radius;
            drawn += &cuboid(camera, at, &joint.frames[0], sizes, material);
        }
        JointKind::Spherical => drawn += &ball(camera, at, 1.15 * radius, material),
        JointKind::Universal => {
            let arms = [axis, joint.frames[1] * Vector3::x()];
            // The arm whose near end is nearer lies over the other.
            let order = if camera.toward(&arms[0]).abs() < camera.toward(&arms[1]).abs() {
                [1, 0]
            } else {
                [0, 1]
            };
            drawn += &ball(camera, at, 0.8 * radius, material);
            for k in order {
                drawn += &cylinder(camera, at, arms[k], 0.42 * radius, 1.7 * radius, material);
            }
        }
        JointKind::Planar => {
            let sizes = Vector3::new(2.6, 2.6, 0.25) * radius;
            drawn += &cuboid(camera, at, &joint.frames[0], sizes, material);
            drawn += &cylinder(camera, at, axis, radius, 0.7 * radius, material);
        }
        JointKind::Fixed => {
            let sizes = Vector3::repeat(0.75) * radius;
            let dark = Material { side: PASSIVE.edge, light: PASSIVE.edge, ..PASSIVE };
            drawn += &cuboid(camera, at, &joint.frames[0], sizes, dark);
        }
        JointKind::Floating => {
            let dashes = format!(
                " stroke=\"{}\" stroke-width=\"1.1\" stroke-dasharray=\"3 2.4\"",
                material.edge.hex()
            );
            drawn += &element(&circle(camera.spot(&at), 1.6 * radius * camera.scale), &dashes);
        }
    }
    items.push(Item { depth, points: vec![at], drawn });
}

/// A virtual joint: a double arrow, straight for a translation and circular for a rotation.
pub(super) fn play(play: &Play, camera: &Camera, radius: f64, items: &mut Vec<Item>) {
    let line = format!(" stroke=\"{}\" stroke-width=\"1.8\"", PLAY.hex());
    let fill = format!(" fill=\"{}\"", PLAY.hex());
    let depth = camera.depth(&play.at) + 3.0 * radius;
    let (x, y) = camera.spot(&play.at);
    let mut drawn = String::new();
    if play.turn {
        let r = 2.3 * radius * camera.scale;
        drawn += &element(&ellipse((x, y), &play.axis, r, camera), &line);
        let side = camera.across(&play.axis);
        // Two heads, opposite each other.
        for sign in [1.0, -1.0] {
            let tip = (x + sign * side.0 * r, y + sign * side.1 * r);
            drawn += &element(&head(tip, (-sign * side.1, sign * side.0), 6.0), &fill);
        }
    } else {
        let reach = 4.2 * radius;
        let ends = [1.0, -1.0].map(|sign| camera.spot(&(play.at + play.axis * (sign * reach))));
        let length = (ends[0].0 - ends[1].0).hypot(ends[0].1 - ends[1].1);
        if length < 4.0 {
            // Toward the viewer: the tip of an arrow.
            drawn += &element(&circle((x, y), 4.0), &line);
            drawn += &element(&circle((x, y), 1.2), &fill);
        } else {
            drawn += &element(&path_data(&ends), &line);
            let direction = ((ends[0].0 - ends[1].0) / length, (ends[0].1 - ends[1].1) / length);
            drawn += &element(&head(ends[0], direction, 7.0), &fill);
            drawn += &element(&head(ends[1], (-direction.0, -direction.1), 7.0), &fill);
        }
    }
    items.push(Item { depth, points: vec![play.at], drawn });
}

/// A load: an arrow with one head for a force, with two for a moment.
pub(super) fn load(load: &Load, camera: &Camera) -> String {
    let line = format!(" stroke=\"{}\" stroke-width=\"2.4\"", LOAD.hex());
    let fill = format!(" fill=\"{}\"", LOAD.hex());
    let [from, to] = [load.from, load.to].map(|end| camera.spot(&end));
    let length = (to.0 - from.0).hypot(to.1 - from.1);
    if length < 4.0 {
        // Along the line of sight: the tip of an arrow, or its tail.
        let toward = camera.toward(&(load.to - load.from)) > 0.0;
        let dot = circle(from, if toward { 2.0 } else { 3.5 });
        return element(&circle(from, 6.0), &line)
            + &element(&dot, if toward { &fill } else { &line });
    }
    let direction = ((to.0 - from.0) / length, (to.1 - from.1) / length);
    let mut drawn =
        element(&path_data(&[from, to]), &line) + &element(&head(to, direction, 9.0), &fill);
    if load.moment {
        let second = (to.0 - 8.0 * direction.0, to.1 - 8.0 * direction.1);
        drawn += &element(&head(second, direction, 9.0), &fill);
    }
    drawn
}

/// Exaggerated play: a line from the end of a link to its joint, with a mark at the end of the link.
pub(super) fn gap(ends: [Vector3<f64>; 2], camera: &Camera, width: f64) -> Item {
    let [from, to] = ends.map(|end| camera.spot(&end));
    let side = camera.across(&(ends[1] - ends[0]));
    let mark = [-width, width].map(|w| (from.0 + side.0 * w, from.1 + side.1 * w));
    let line = format!(" stroke=\"{}\" stroke-width=\"{}\"", PLAY.hex(), px(GAP));
    let drawn = element(&path_data(&[from, to]), &line) + &element(&path_data(&mark), &line);
    let depth = camera.depth(&ends[0]).max(camera.depth(&ends[1]));
    Item { depth, points: ends.to_vec(), drawn }
}

/// The head of an arrow with its tip slightly beyond `tip`, along `direction` (px).
fn head(tip: (f64, f64), direction: (f64, f64), length: f64) -> String {
    let at = |along: f64, aside: f64| {
        (
            tip.0 + direction.0 * along - direction.1 * aside,
            tip.1 + direction.1 * along + direction.0 * aside,
        )
    };
    let corners =
        [at(0.4 * length, 0.0), at(-0.6 * length, 0.4 * length), at(-0.6 * length, -0.4 * length)];
    path_data(&corners) + "z"
}

fn line_to_center(joint: &DrawnJoint, camera: &Camera) -> Item {
    let ends = [joint.origin, joint.at];
    let depth = camera.depth(&((joint.origin + joint.at) * 0.5));
    let dashes = format!(" stroke=\"{LINE}\" stroke-width=\"1\" stroke-dasharray=\"5 3\"");
    let drawn = element(&path_data(&ends.map(|end| camera.spot(&end))), &dashes);
    Item { depth, points: ends.to_vec(), drawn }
}

/// The rail of a prismatic or cylindrical joint, behind its block.
fn rail(camera: &Camera, at: Vector3<f64>, axis: Vector3<f64>, reach: f64) -> Item {
    let ends = [1.0, -1.0].map(|sign| at + axis * (sign * reach));
    let line = format!(" stroke=\"{LINE}\" stroke-width=\"2.2\" stroke-linecap=\"round\"");
    let drawn = element(&path_data(&ends.map(|end| camera.spot(&end))), &line);
    Item { depth: camera.depth(&at) - 0.3 * reach, points: ends.to_vec(), drawn }
}

/// A circle (px).
pub(super) fn circle((x, y): (f64, f64), r: f64) -> String {
    let (r, d) = (px(r), px(2.0 * r));
    format!("M{} {}m-{r} 0a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0z", px(x), px(y))
}

/// A circle of this radius (px) square to an axis in space.
fn ellipse((x, y): (f64, f64), axis: &Vector3<f64>, r: f64, camera: &Camera) -> String {
    let side = camera.across(axis);
    let flat = r * camera.toward(axis).abs();
    let turned = px(side.1.atan2(side.0).to_degrees());
    let end = |sign: f64| format!("{} {}", px(x + sign * side.0 * r), px(y + sign * side.1 * r));
    let arc = format!("A{} {} {turned} 1 0 ", px(r), px(flat));
    format!("M{}{arc}{}{arc}{}z", end(1.0), end(-1.0), end(1.0))
}

fn ball(camera: &Camera, at: Vector3<f64>, radius: f64, material: Material) -> String {
    let ((x, y), r) = (camera.spot(&at), radius * camera.scale);
    let shine = (x - 0.3 * r, y - 0.32 * r);
    element(&circle((x, y), r), &material.attributes(material.side))
        + &element(&circle(shine, 0.42 * r), &format!(" fill=\"{}\"", material.light.hex()))
}

/// A cylinder about `axis`: its outline, then the end that is seen.
fn cylinder(
    camera: &Camera,
    at: Vector3<f64>,
    axis: Vector3<f64>,
    radius: f64,
    half: f64,
    material: Material,
) -> String {
    let near = if camera.toward(&axis) < 0.0 { -axis } else { axis };
    let [top, foot] = [half, -half].map(|along| camera.spot(&(at + near * along)));
    let (r, side) = (radius * camera.scale, camera.across(&near));
    let flat = r * camera.toward(&near);
    let turned = px(side.1.atan2(side.0).to_degrees());
    let point = |(x, y): (f64, f64), sign: f64| {
        format!("{} {}", px(x + sign * side.0 * r), px(y + sign * side.1 * r))
    };
    // From side to side round each end, bulging outward.
    let arc = format!("A{} {} {turned} 0 0 ", px(r), px(flat));
    let outline = format!(
        "M{}L{}{arc}{}L{}{arc}{}z",
        point(foot, 1.0),
        point(top, 1.0),
        point(top, -1.0),
        point(foot, -1.0),
        point(foot, 1.0)
    );
    element(&outline, &material.attributes(material.side))
        + &element(&ellipse(top, &near, r, camera), &material.attributes(material.light))
}

/// Turns of a thread on the side that is seen.
fn thread(
    camera: &Camera,
    at: Vector3<f64>,
    axis: Vector3<f64>,
    radius: f64,
    material: Material,
) -> String {
    let near = if camera.toward(&axis) < 0.0 { -axis } else { axis };
    let (r, side) = (radius * camera.scale, camera.across(&near));
    let flat = r * camera.toward(&near);
    let turned = px(side.1.atan2(side.0).to_degrees());
    let mut data = String::new();
    for turn in [-1.1, -0.4, 0.3] {
        let [from, to] =
            [turn, turn + 0.5].map(|along| camera.spot(&(at + near * (along * radius))));
        data += &format!(
            "M{} {}A{} {} {turned} 0 1 {} {}",
            px(from.0 + side.0 * r),
            px(from.1 + side.1 * r),
            px(r),
            px(flat),
            px(to.0 - side.0 * r),
            px(to.1 - side.1 * r)
        );
    }
    element(&data, &format!(" stroke=\"{}\" stroke-width=\"1.1\"", material.edge.hex()))
}

/// A box: the faces that are seen, lighter the more they face the eye.
fn cuboid(
    camera: &Camera,
    at: Vector3<f64>,
    frame: &Rotation3<f64>,
    half: Vector3<f64>,
    material: Material,
) -> String {
    let mut faces: Vec<(f64, String)> = Vec::new();
    for k in 0..3 {
        let [out, u, v] =
            [k, (k + 1) % 3, (k + 2) % 3].map(|axis| frame * Vector3::ith(axis, half[axis]));
        let facing = camera.toward(&out) / half[k];
        if facing.abs() < 1e-9 {
            continue;
        }
        let middle = at + out * facing.signum();
        let corners = [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)]
            .map(|(a, b)| camera.spot(&(middle + u * a + v * b)));
        faces.push((facing.abs(), path_data(&corners) + "z"));
    }
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let last = faces.len().saturating_sub(1);
    let shade = |k: usize| if k == last { material.light } else { material.side };
    faces
        .iter()
        .enumerate()
        .map(|(k, (_, data))| element(data, &material.attributes(shade(k))))
        .collect()
}
