//! Placement of names.

use jointplay_core::mechanism::JointKind;
use nalgebra::Vector3;

use super::camera::Camera;
use super::picture::{Labels, MechanismPicture};
use super::scene::Scene;
use crate::text::{HALF_CAPITAL, TICK, width};

/// Number of joints and virtual joints from which only actuated joints are named by default.
const MANY: usize = 16;

/// A name and the position of what it names.
struct Wanted<'a> {
    text: &'a str,
    at: Vector3<f64>,
    /// Extent of the drawing there, in radii of a joint.
    reach: f64,
    play: bool,
}

/// A name on the page.
pub(super) struct Name {
    pub(super) text: String,
    /// Left end of its base line (px).
    pub(super) at: (f64, f64),
    pub(super) play: bool,
}

/// A rectangle on the page (px).
#[derive(Clone, Copy)]
struct Room {
    x: f64,
    y: f64,
    w: f64,
    h: f64,
}

impl Room {
    /// Area in common with another.
    fn shared(&self, other: &Room) -> f64 {
        let w = (self.x + self.w).min(other.x + other.w) - self.x.max(other.x);
        let h = (self.y + self.h).min(other.y + other.h) - self.y.max(other.y);
        w.max(0.0) * h.max(0.0)
    }

    fn about((x, y): (f64, f64), half: f64) -> Self {
        Self { x: x - half, y: y - half, w: 2.0 * half, h: 2.0 * half }
    }
}

/// The part of the page that labels may use.
#[derive(Clone, Copy)]
pub(super) struct LabelArea {
    /// Width of the page (px).
    pub(super) width: f64,
    /// Upper edge (px).
    pub(super) top: f64,
    /// Lower edge (px).
    pub(super) bottom: f64,
}

/// Positions of the names within an area of the page.
pub(super) fn place(
    picture: &MechanismPicture<'_>,
    scene: &Scene,
    camera: &Camera,
    area: LabelArea,
) -> Vec<Name> {
    let radius = scene.radius * camera.scale;
    let mut taken: Vec<Room> = scene
        .joints
        .iter()
        .map(|joint| Room::about(camera.spot(&joint.at), reach(joint.kind) * radius))
        .collect();
    for link in &scene.links {
        for pair in link.joints.windows(2) {
            let (a, b) = (scene.joints[pair[0]].at, scene.joints[pair[1]].at);
            let along = |k: i32| a + (b - a) * (f64::from(k) / 12.0);
            taken.extend((1..12).map(|k| Room::about(camera.spot(&along(k)), 0.5 * radius)));
        }
    }
    for joint in &scene.joints {
        if joint.has_rail() {
            let rail = |k: i32| joint.at + joint.axis() * (f64::from(k) * scene.radius);
            taken.extend((-6..=6).map(|k| Room::about(camera.spot(&rail(k)), 3.0)));
        }
    }
    let mut names = Vec::new();
    for Wanted { text, at, reach, play } in wanted(picture, scene) {
        let spot = camera.spot(&at);
        let room = best(text, spot, reach * radius, &taken, area);
        taken.push(room);
        let base = room.y + 0.5 * room.h + HALF_CAPITAL * TICK;
        names.push(Name { text: text.to_owned(), at: (room.x, base), play });
    }
    names
}

/// The names to be shown: joints, virtual joints, then links.
fn wanted<'a>(picture: &'a MechanismPicture<'_>, scene: &'a Scene) -> Vec<Wanted<'a>> {
    let many = scene.joints.len() + scene.play.len() >= MANY;
    let labels = picture.labels;
    let (joints, links) = match labels {
        Labels::Auto | Labels::Joints => (true, false),
        Labels::Links => (false, true),
        Labels::All => (true, true),
        Labels::None => (false, false),
    };
    let all = joints && !(many && labels == Labels::Auto);
    let text = |name: &'a str, shown: bool| match picture.own_labels.get(name) {
        Some(own) => Some(own.as_str()).filter(|own| !own.is_empty()),
        None => shown.then_some(name),
    };
    let of_joints = scene.joints.iter().filter_map(|joint| {
        let text = text(&joint.name, all || (joints && joint.actuated))?;
        Some(Wanted { text, at: joint.at, reach: reach(joint.kind), play: false })
    });
    let of_play = scene.play.iter().filter_map(|play| {
        Some(Wanted { text: text(&play.name, all)?, at: play.at, reach: 2.5, play: true })
    });
    let of_links = scene.links.iter().filter(|link| !link.joints.is_empty()).filter_map(|link| {
        Some(Wanted { text: text(&link.name, links)?, at: link.middle(), reach: 0.5, play: false })
    });
    of_joints.chain(of_play).chain(of_links).collect()
}

/// Extent of the drawing of a joint, in radii.
fn reach(kind: JointKind) -> f64 {
    match kind {
        JointKind::Prismatic | JointKind::Cylindrical => 2.0,
        JointKind::Planar => 3.4,
        JointKind::Fixed => 1.0,
        _ => 1.65,
    }
}

/// The free rectangle next to a position with the least overlap.
fn best(text: &str, spot: (f64, f64), reach: f64, taken: &[Room], area: LabelArea) -> Room {
    let (w, h) = (width(text, TICK), 1.1 * TICK);
    let LabelArea { width: right, top, bottom } = area;
    let mut found: Option<(f64, Room)> = None;
    for ring in 0..3 {
        for step in 0..16 {
            let angle = f64::from(step) * std::f64::consts::PI / 8.0 - std::f64::consts::PI / 4.0;
            let (sin, cos) = angle.sin_cos();
            let gap = reach + 3.0 + f64::from(ring) * 12.0;
            let middle = (spot.0 + cos * (gap + 0.5 * w), spot.1 + sin * (gap + 0.5 * h));
            let room = Room { x: middle.0 - 0.5 * w, y: middle.1 - 0.5 * h, w, h };
            let outside = (4.0 - room.x).max(0.0)
                + (room.x + w - right + 4.0).max(0.0)
                + (top - room.y).max(0.0)
                + (room.y + h - bottom).max(0.0);
            let hidden: f64 = taken.iter().map(|other| room.shared(other)).sum();
            let cost = hidden + 50.0 * outside + 14.0 * f64::from(ring);
            if found.is_none_or(|(least, _)| cost < least - 1e-9) {
                found = Some((cost, room));
            }
        }
    }
    found.map_or(Room { x: spot.0, y: spot.1, w, h }, |(_, room)| room)
}
