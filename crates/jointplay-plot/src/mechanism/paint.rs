//! Links and joints on the page, from far to near.

use nalgebra::Vector3;

use super::camera::Camera;
use super::item::Item;
use super::plate::{EDGE, GHOST, Plate, STRAIGHT, colours, corners, hull, straight, under};
use super::scene::{DrawnJoint, Scene};
use super::{glyph, order};
use crate::path::crossing;
use crate::svg::{element, path_data, px};

/// Width of a link, in radii of a joint.
const WIDTH: f64 = 0.95;
/// Bars of an arc about the point where axes meet.
const ARC: usize = 12;

/// A link as a line through these points.
struct Bar {
    link: usize,
    points: Vec<Vector3<f64>>,
}

/// All shapes, from far to near.
pub(super) fn draw(scene: &Scene, ghost: Option<&Scene>, camera: &Camera) -> String {
    let mut items: Vec<Item> = Vec::new();
    let width = WIDTH * scene.radius * camera.scale;
    let bars = bars(scene);
    for bar in &bars {
        pieces(bar, &bars, scene, camera, width, &mut items);
    }
    for joint in &scene.joints {
        glyph::joint(joint, camera, scene.radius, &mut items);
    }
    for gap in &scene.gaps {
        items.push(glyph::gap(*gap, camera, width));
    }
    for play in scene.play.iter().filter(|_| scene.exaggeration.is_none()) {
        glyph::play(play, camera, scene.radius, &mut items);
    }
    let plates = scene.links.iter().filter_map(|body| Plate::of(body, camera, width));
    let ghost = ghost.map_or(String::new(), |ghost| ghosts(ghost, camera, width));
    let loads: String = scene.loads.iter().map(|load| glyph::load(load, camera)).collect();
    ghost + &order::far_to_near(items, plates.collect(), camera) + &loads
}

/// Links as bars; a link with one joint sticks out of it.
fn bars(scene: &Scene) -> Vec<Bar> {
    let mut bars = Vec::new();
    for (link, body) in scene.links.iter().enumerate() {
        if let [only] = body.joints[..] {
            let joint = &scene.joints[only];
            let out = joint.frames[usize::from(!body.base)] * Vector3::x();
            let sign = if body.base { -1.0 } else { 1.0 };
            let to = body.ends[0] + out * (sign * 7.0 * scene.radius);
            bars.push(Bar { link, points: vec![body.ends[0], to] });
        } else if let [a, b] = body.joints[..]
            && let Some(points) = arc(&scene.joints[a], &scene.joints[b])
        {
            bars.push(Bar { link, points });
        } else if let Some([a, b]) = straight(body) {
            bars.push(Bar { link, points: vec![a, b] });
        }
    }
    bars
}

/// The arc between two hinges about the point where their axes meet.
fn arc(a: &DrawnJoint, b: &DrawnJoint) -> Option<Vec<Vector3<f64>>> {
    let together = (a.origin - b.origin).norm() < STRAIGHT;
    if !(a.on_sphere && b.on_sphere && together) {
        return None;
    }
    let (from, to) = (a.at - a.origin, b.at - b.origin);
    let angle = from.angle(&to);
    let sin = angle.sin();
    if sin.abs() < 1e-3 {
        return None;
    }
    #[expect(clippy::cast_precision_loss, reason = "a count of bars")]
    let point = |k: usize| {
        let part = k as f64 / ARC as f64 * angle;
        a.origin + from * ((angle - part).sin() / sin) + to * (part.sin() / sin)
    };
    Some((0..=ARC).map(point).collect())
}

/// Splits a bar into pieces, each with the depth of its end or of its crossing with another bar.
fn pieces(
    bar: &Bar,
    bars: &[Bar],
    scene: &Scene,
    camera: &Camera,
    width: f64,
    items: &mut Vec<Item>,
) {
    let body = &scene.links[bar.link];
    // Moving links are drawn over the base in one plane.
    let (colours, back) = (colours(body), if body.base { 0.5 * scene.radius } else { 0.0 });
    let [from, to] = [bar.points[0], bar.points[bar.points.len() - 1]];
    if bar.points.len() > 2 {
        let spots: Vec<_> = bar.points.iter().map(|point| camera.spot(point)).collect();
        let half = spots.len() / 2;
        let ends = [(from, &spots[..=half]), (to, &spots[half..])];
        for (end, spots) in ends {
            let depth = camera.depth(&end) - back;
            let drawn = tube(spots, &[camera.spot(&end)], colours, width);
            items.push(Item { depth, points: bar.points.clone(), drawn });
        }
        return;
    }
    let (p, q) = (camera.spot(&from), camera.spot(&to));
    let meets = |other: &Bar| {
        let (own, theirs) = (&scene.links[bar.link].joints, &scene.links[other.link].joints);
        own.iter().any(|joint| theirs.contains(joint))
    };
    let mut crossings = vec![0.0, 1.0];
    for other in bars.iter().filter(|other| other.link != bar.link && !meets(other)) {
        let across = other.points.windows(2);
        crossings.extend(
            across.filter_map(|pair| crossing(p, q, camera.spot(&pair[0]), camera.spot(&pair[1]))),
        );
    }
    // Joints along the bar are drawn over it.
    let along = (to - from) / (to - from).norm_squared().max(f64::MIN_POSITIVE);
    let own = scene.links[bar.link].ends.iter().map(|end| (end - from).dot(&along));
    crossings.extend(own.filter(|t| (1e-6..1.0 - 1e-6).contains(t)));
    crossings.sort_by(f64::total_cmp);
    let length = (q.0 - p.0).hypot(q.1 - p.1).max(1.0);
    let at = |t: f64| (p.0 + (q.0 - p.0) * t, p.1 + (q.1 - p.1) * t);
    let in_space = |t: f64| from + (to - from) * t;
    let last = crossings.len() - 1;
    for (k, &t) in crossings.iter().enumerate() {
        // Pieces overlap a little, so that no seam shows.
        let lap = 0.7 / length;
        let start = if k == 0 { 0.0 } else { 0.5 * (crossings[k - 1] + t) };
        let end = if k == last { 1.0 } else { 0.5 * (t + crossings[k + 1]) };
        let caps: &[(f64, f64)] = match k {
            0 => &[p],
            _ if k == last => &[q],
            _ => &[],
        };
        let line = [at((start - lap).max(0.0)), at((end + lap).min(1.0))];
        let drawn = tube(&line, caps, colours, width);
        let sample = |k: i32| in_space(start + (end - start) * f64::from(k) / 8.0);
        let points = (0..=8).map(sample).collect();
        items.push(Item { depth: camera.depth(&in_space(t)) - back, points, drawn });
    }
}

/// A line with edges, round at `caps`.
fn tube(
    line: &[(f64, f64)],
    caps: &[(f64, f64)],
    [fill, edge]: [&'static str; 2],
    width: f64,
) -> String {
    let (data, round) = (path_data(line), " stroke-linecap=\"round\"");
    let join = " stroke-linejoin=\"round\"";
    let caps: String = caps.iter().map(|cap| path_data(&[*cap])).collect();
    let mut drawn = stroked(&caps, edge, width, round) + &stroked(&data, edge, width, join);
    for paint in under(fill) {
        drawn += &stroked(&caps, paint, width - 2.0 * EDGE, round);
        drawn += &stroked(&data, paint, width - 2.0 * EDGE, join);
    }
    drawn
}

fn stroked(data: &str, paint: &str, width: f64, more: &str) -> String {
    let width = px(width.max(0.5));
    element(data, &format!(" stroke=\"{paint}\" stroke-width=\"{width}\"{more}"))
}

/// The links of another configuration as outlines, behind everything.
fn ghosts(scene: &Scene, camera: &Camera, width: f64) -> String {
    let mut drawn = String::new();
    for bar in bars(scene).iter().filter(|bar| !scene.links[bar.link].base) {
        let spots: Vec<_> = bar.points.iter().map(|point| camera.spot(point)).collect();
        let caps = [spots[0], spots[spots.len() - 1]];
        drawn += &tube(&spots, &caps, GHOST, width);
    }
    for body in scene.links.iter().filter(|body| !body.base) {
        if let Some(corners) = corners(body) {
            let spots = hull(corners.iter().map(|corner| camera.spot(corner)).collect());
            let [fill, edge] = GHOST;
            let paints = format!(
                " fill=\"{fill}\" fill-opacity=\"0.7\" stroke=\"{edge}\" stroke-width=\"{EDGE}\" stroke-linejoin=\"round\""
            );
            drawn += &element(&(path_data(&spots) + "z"), &paints);
        }
    }
    drawn
}
