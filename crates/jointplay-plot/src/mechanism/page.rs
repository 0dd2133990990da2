//! The page: title, mechanism, axes, scale and legend.

use nalgebra::Vector3;

use super::camera::Camera;
use super::glyph::{ACTUATED, GAP, LOAD, PLAY, circle};
use super::labels::{self, LabelArea};
use super::paint;
use super::picture::MechanismPicture;
use super::scene::{RAIL, Scene};
use super::view::View;
use crate::scale_bar::scale_bar;
use crate::svg::{Anchor, INK, RIM, Svg, element, path_data, px};
use crate::text::{HALF_CAPITAL, LEADING, TICK, TITLE, width, wrap};

/// Margin around the mechanism, for labels (px).
const MARGIN: f64 = 46.0;
/// Height of axes, scale and legend (px).
const FOOT: f64 = 74.0;
/// Largest height of the mechanism, as a share of the page width.
const HIGH: f64 = 0.72;
/// Largest length of the scale, as a share of the page width.
const SCALE: f64 = 0.2;
/// Length of the axes (px).
const AXES: f64 = 26.0;

/// The whole picture.
pub(super) fn draw(picture: &MechanismPicture<'_>, scene: &Scene, ghost: Option<&Scene>) -> String {
    let view = picture.view.unwrap_or_else(|| View::of(scene));
    let page = picture.width;
    let title = wrap(&picture.title, TITLE, page - 2.0 * MARGIN);
    #[expect(clippy::cast_precision_loss, reason = "a count of lines")]
    let top = 12.0 + title.len() as f64 * TITLE * LEADING;
    let (low, high) = extent(view, scene, ghost);
    let (across, up) = (high.0 - low.0, high.1 - low.1);
    let scale = ((page - 2.0 * MARGIN) / across).min(HIGH * page / up);
    let bottom = top + 2.0 * MARGIN + scale * up;
    let middle = (
        0.5 * page - 0.5 * (low.0 + high.0) * scale,
        0.5 * (top + bottom) + 0.5 * (low.1 + high.1) * scale,
    );
    let camera = Camera::new(view, scale, middle);
    // The accessible name describes the picture even without a title.
    let about = if title.is_empty() { picture.mechanism.name() } else { &picture.title };
    let mut svg = Svg::new(page, bottom + FOOT, about);
    svg.elements(
        "<defs><pattern id=\"base\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\">\
         <path d=\"M-1 7L7 -1M-1 1L1 -1M5 7L7 5\" stroke=\"#8c8c8c\" stroke-width=\"1\"/></pattern></defs>\n",
    );
    #[expect(clippy::cast_precision_loss, reason = "a count of lines")]
    for (line, text) in title.iter().enumerate() {
        let at = (0.5 * page, 26.0 + line as f64 * TITLE * LEADING);
        svg.text(at, TITLE, Anchor::Middle, text, "");
    }
    svg.elements(&paint::draw(scene, ghost, &camera));
    for name in labels::place(picture, scene, &camera, LabelArea { width: page, top, bottom }) {
        let more =
            if name.play { format!(" style=\"fill:{}\"{RIM}", PLAY.hex()) } else { RIM.to_owned() };
        svg.text(name.at, TICK, Anchor::Start, &name.text, &more);
    }
    axes(&mut svg, view, (MARGIN, bottom + 34.0));
    scale_bar(&mut svg, scene.size / scale, (page - MARGIN, bottom + 40.0), SCALE * page);
    legend(&mut svg, scene, ghost.is_some(), (0.5 * page, bottom + 40.0));
    svg.finish()
}

/// Least and greatest coordinates in the picture, in sizes.
fn extent(view: View, scene: &Scene, ghost: Option<&Scene>) -> ((f64, f64), (f64, f64)) {
    let [right, up, _] = view.frame();
    let (mut low, mut high) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
    for scene in [Some(scene), ghost].into_iter().flatten() {
        let room = 3.0 * scene.radius;
        for [end, _] in &scene.gaps {
            let (x, y) = (end.dot(&right), end.dot(&up));
            low = (low.0.min(x - room), low.1.min(y - room));
            high = (high.0.max(x + room), high.1.max(y + room));
        }
        for load in &scene.loads {
            let (x, y) = (load.to.dot(&right), load.to.dot(&up));
            low = (low.0.min(x - room), low.1.min(y - room));
            high = (high.0.max(x + room), high.1.max(y + room));
        }
        for joint in &scene.joints {
            let reach = if joint.has_rail() { RAIL * scene.radius } else { 0.0 };
            for point in [-reach, reach].map(|along| joint.at + joint.axis() * along) {
                let (x, y) = (point.dot(&right), point.dot(&up));
                low = (low.0.min(x - room), low.1.min(y - room));
                high = (high.0.max(x + room), high.1.max(y + room));
            }
        }
    }
    (low, high)
}

/// The directions of x, y and z, the nearest last.
fn axes(svg: &mut Svg, view: View, (x, y): (f64, f64)) {
    let [right, up, eye] = view.frame();
    let mut named = [("x", Vector3::x()), ("y", Vector3::y()), ("z", Vector3::z())];
    named.sort_by(|a, b| a.1.dot(&eye).total_cmp(&b.1.dot(&eye)));
    let mut set: Vec<(f64, f64)> = Vec::new();
    for (name, axis) in named {
        let (dx, dy) = (axis.dot(&right), -axis.dot(&up));
        let tip = (x + AXES * dx, y + AXES * dy);
        svg.path(
            &path_data(&[(x, y), tip]),
            &format!(" stroke=\"{INK}\" stroke-width=\"1.4\" stroke-linecap=\"round\""),
        );
        let length = dx.hypot(dy);
        if length < 0.15 {
            svg.path(
                &circle((x, y), 3.0),
                &format!(" fill=\"#ffffff\" stroke=\"{INK}\" stroke-width=\"1.2\""),
            );
        }
        let direction = if length < 0.15 { (-0.7, 0.7) } else { (dx / length, dy / length) };
        let beyond = (tip.0 + 9.0 * direction.0, tip.1 + 9.0 * direction.1 + HALF_CAPITAL * TICK);
        let clear = |at: &(f64, f64)| {
            set.iter().all(|other| (other.0 - at.0).hypot(other.1 - at.1) > 1.2 * TICK)
        };
        let candidates = [0.0, -1.0, 1.0, -2.0, 2.0].map(|k| (beyond.0 + k * TICK, beyond.1));
        let at = candidates.into_iter().find(clear).unwrap_or(beyond);
        set.push(at);
        svg.text(at, TICK, Anchor::Middle, name, "");
    }
}

/// The legend of the colours and hatchings that occur.
fn legend(svg: &mut Svg, scene: &Scene, ghost: bool, (middle, y): (f64, f64)) {
    let mut entries: Vec<(String, String)> = Vec::new();
    let line = " stroke=\"#5c5c5c\" stroke-width=\"1.1\"";
    let swatch =
        |fill: &str, line: &str| element("M0 -5h18v10h-18z", &format!(" fill=\"{fill}\"{line}"));
    entries.push((swatch("#ececec", "") + &swatch("url(#base)", line), "base".to_owned()));
    if scene.joints.iter().any(|joint| joint.actuated) {
        entries.push((ACTUATED.swatch(), "actuated".to_owned()));
    }
    if let Some(factor) = scene.exaggeration {
        let line = format!(" stroke=\"{}\" stroke-width=\"{}\"", PLAY.hex(), px(GAP));
        entries.push((element("M0 0h18", &line), format!("play scale {factor}×")));
    } else if !scene.play.is_empty() {
        let arrow = format!(" stroke=\"{}\" stroke-width=\"1.8\"", PLAY.hex());
        entries.push((
            element("M0 0h18M4 -3l-4 3l4 3M14 -3l4 3l-4 3", &arrow),
            "virtual joint".to_owned(),
        ));
    }
    for (moment, text) in [(false, "force"), (true, "moment")] {
        if scene.loads.iter().any(|load| load.moment == moment) {
            let line = format!(" stroke=\"{}\" stroke-width=\"2.4\"", LOAD.hex());
            let heads = if moment {
                "M0 0h18M14 -4l4 4l-4 4M7 -4l4 4l-4 4"
            } else {
                "M0 0h18M14 -4l4 4l-4 4"
            };
            entries.push((element(heads, &line), text.to_owned()));
        }
    }
    if ghost {
        let pale = " stroke=\"#8fa3b5\" stroke-width=\"1.1\"";
        entries.push((swatch("#f3f6f9", pale), "moved".to_owned()));
    }
    let wide = |text: &str| 24.0 + width(text, TICK) + 20.0;
    let mut x = middle - 0.5 * (entries.iter().map(|(_, text)| wide(text)).sum::<f64>() - 20.0);
    for (drawn, text) in entries {
        svg.elements(&format!("<g transform=\"translate({} {})\">\n{drawn}</g>\n", px(x), px(y)));
        svg.text((x + 24.0, y + HALF_CAPITAL * TICK), TICK, Anchor::Start, &text, "");
        x += wide(&text);
    }
}
