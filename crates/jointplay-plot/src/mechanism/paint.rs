//! Bodies on the page, the far ones first.

use nalgebra::{Matrix3, Vector3};

use super::glyph::{self, Item};
use super::order;
use super::scene::{Body, Placed, Scene};
use super::view::View;
use crate::svg::{element, path_data, px};

/// Fill and edge of links, of the base, and of links in another configuration.
const LINK: [&str; 2] = ["#bfd4e6", "#4a6580"];
const BASE: [&str; 2] = ["url(#base)", "#5c5c5c"];
const GHOST: [&str; 2] = ["#f3f6f9", "#8fa3b5"];
/// Width of a link, in radii of a joint.
const WIDTH: f64 = 0.95;
/// Width of an edge [px].
const EDGE: f64 = 1.1;
/// What is nearer to a line than this is on it, in sizes.
const STRAIGHT: f64 = 1e-6;
/// Bars of an arc about the point where axes meet.
const ARC: usize = 12;

/// From the mechanism's space to the page.
pub(super) struct Camera {
    frame: [Vector3<f64>; 3],
    /// Length of one size [px].
    pub(super) scale: f64,
    /// Where the mechanism's middle stands [px].
    middle: (f64, f64),
}

impl Camera {
    pub(super) fn new(view: View, scale: f64, middle: (f64, f64)) -> Self {
        Self { frame: view.frame(), scale, middle }
    }

    /// Where a point stands [px].
    pub(super) fn spot(&self, point: &Vector3<f64>) -> (f64, f64) {
        let [right, up, _] = &self.frame;
        (self.middle.0 + point.dot(right) * self.scale, self.middle.1 - point.dot(up) * self.scale)
    }

    /// How near a point is to the eye.
    pub(super) fn depth(&self, point: &Vector3<f64>) -> f64 {
        point.dot(&self.frame[2])
    }

    /// Part of a direction that points to the eye.
    pub(super) fn toward(&self, direction: &Vector3<f64>) -> f64 {
        direction.dot(&self.frame[2])
    }

    /// Unit vector on the page square to the image of a direction: a quarter turn, such that bulging ends need one sense only.
    pub(super) fn across(&self, direction: &Vector3<f64>) -> (f64, f64) {
        let (x, y) = (direction.dot(&self.frame[0]), -direction.dot(&self.frame[1]));
        let length = x.hypot(y);
        if length < 1e-9 { (1.0, 0.0) } else { (-y / length, x / length) }
    }
}

/// A link as a line through these points.
struct Bar {
    link: usize,
    points: Vec<Vector3<f64>>,
}

/// Everything but words, from far to near.
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
    ghost + &order::far_to_near(items, plates.collect(), camera)
}

fn colours(body: &Body) -> [&'static str; 2] {
    if body.base { BASE } else { LINK }
}

/// The two ends farthest from each other, if all others are on the line between them.
fn straight(body: &Body) -> Option<[Vector3<f64>; 2]> {
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
fn arc(a: &Placed, b: &Placed) -> Option<Vec<Vector3<f64>>> {
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

/// A bar in pieces, each as near as its end, or as where it crosses another.
fn pieces(
    bar: &Bar,
    bars: &[Bar],
    scene: &Scene,
    camera: &Camera,
    width: f64,
    items: &mut Vec<Item>,
) {
    let body = &scene.links[bar.link];
    // What moves lies over the base where both are in one plane.
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
    // Joints on the way lie over it.
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

/// Paints from below to above: a pattern needs a ground.
fn under(fill: &'static str) -> Vec<&'static str> {
    if fill.starts_with("url") { vec!["#ececec", fill] } else { vec![fill] }
}

fn stroked(data: &str, paint: &str, width: f64, more: &str) -> String {
    let width = px(width.max(0.5));
    element(data, &format!(" stroke=\"{paint}\" stroke-width=\"{width}\"{more}"))
}

/// Part of the way from `p` to `q` at which the line from `r` to `s` crosses it, if it does.
pub(super) fn crossing(p: (f64, f64), q: (f64, f64), r: (f64, f64), s: (f64, f64)) -> Option<f64> {
    let (d, e) = ((q.0 - p.0, q.1 - p.1), (s.0 - r.0, s.1 - r.1));
    let determinant = d.0 * e.1 - d.1 * e.0;
    let size = d.0.hypot(d.1) * e.0.hypot(e.1);
    if determinant.abs() <= 1e-9 * size {
        return None;
    }
    let f = (r.0 - p.0, r.1 - p.1);
    let t = (f.0 * e.1 - f.1 * e.0) / determinant;
    let u = (f.0 * d.1 - f.1 * d.0) / determinant;
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u)).then_some(t)
}

/// A link that is no bar.
pub(super) struct Plate {
    /// Its outline on the page [px].
    pub(super) outline: Vec<(f64, f64)>,
    pub(super) middle: Vector3<f64>,
    /// Square to it as well as can be, toward the eye.
    pub(super) normal: Vector3<f64>,
    pub(super) base: bool,
    pub(super) drawn: String,
}

impl Plate {
    fn of(body: &Body, camera: &Camera, width: f64) -> Option<Self> {
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
fn corners(body: &Body) -> Option<&[Vector3<f64>]> {
    (body.joints.len() > 2 && straight(body).is_none()).then_some(&body.ends)
}

/// Corners of the convex hull, by Andrew's monotone chain.
fn hull(mut spots: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
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
