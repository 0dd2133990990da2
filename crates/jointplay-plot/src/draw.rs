//! Drawing of a figure after its layout.

use crate::label;
use crate::layout::{Layout, MARKER_ROW, Place, TICK_LENGTH};
use crate::markers::PlacedMarker;
use crate::path::{Spot, points, strokes};
use crate::svg::{
    Anchor, INK, RIM, Svg, line_attributes, path_data, point_attributes, point_data, px,
};
use crate::text::{HALF_CAPITAL, LABEL, LEADING, TICK, TITLE};
use crate::{Curve, Figure, Panel};

/// The figure as SVG.
pub(crate) fn figure(figure: &Figure, layout: &Layout) -> String {
    let mut svg = Svg::new(figure.width, layout.height, &figure.title);
    for (line, text) in layout.title.iter().enumerate() {
        let at = (layout.title_at, 26.0 + line as f64 * TITLE * LEADING);
        svg.text(at, TITLE, Anchor::Middle, text, "");
    }
    layout.legend.draw(&mut svg, layout.legend_at.0, layout.legend_at.1);
    for (panel, place) in figure.panels.iter().zip(&layout.places) {
        for (line, text) in place.caption.iter().enumerate() {
            let at = (place.frame.x, place.caption_at + line as f64 * LABEL * LEADING);
            svg.text(at, LABEL, Anchor::Start, text, "");
        }
        place.legend.draw(&mut svg, place.legend_at.0, place.legend_at.1);
        grid(&mut svg, place);
        markers(&mut svg, place);
        curves(&mut svg, panel, place);
        axes(&mut svg, place);
    }
    svg.finish()
}

impl Place {
    /// Position of a value of the x axis (px).
    fn across(&self, value: f64) -> f64 {
        self.frame.x + self.x.place(value) * self.frame.w
    }

    /// Position of a value of the y axis (px).
    fn down(&self, value: f64) -> f64 {
        self.frame.bottom() - self.y.place(value) * self.frame.h
    }

    /// Positions of the points of a curve; `None` for a gap.
    fn spots<'a>(&'a self, curve: &'a Curve) -> impl Iterator<Item = Option<Spot>> + 'a {
        curve
            .points()
            .map(|(x, y)| (x.is_finite() && y.is_finite()).then(|| (self.across(x), self.down(y))))
    }
}

fn grid(svg: &mut Svg, place: &Place) {
    let frame = &place.frame;
    let mut data = String::new();
    for tick in &place.x_ticks.major {
        data += &format!("M{} {}v{}", px(place.across(tick.value)), px(frame.y), px(frame.h));
    }
    for tick in &place.y_ticks.major {
        data += &format!("M{} {}h{}", px(frame.x), px(place.down(tick.value)), px(frame.w));
    }
    svg.path(&data, " stroke=\"#e4e4e4\" stroke-width=\"0.8\"");
}

fn markers(svg: &mut Svg, place: &Place) {
    let frame = &place.frame;
    let base = |marker: &PlacedMarker| frame.y - 6.0 - marker.row as f64 * MARKER_ROW;
    for marker in &place.markers {
        let top = if marker.text.is_empty() { frame.y } else { base(marker) + 4.5 };
        let data = format!("M{} {}V{}", px(marker.x), px(top), px(frame.bottom()));
        svg.path(&data, " stroke=\"#666666\" stroke-width=\"1\" stroke-dasharray=\"4 3\"");
    }
    // Names after all lines, as lines to upper rows may pass behind names in lower ones.
    for marker in place.markers.iter().filter(|marker| !marker.text.is_empty()) {
        svg.text((marker.middle, base(marker)), TICK, Anchor::Middle, &marker.text, RIM);
    }
}

fn curves(svg: &mut Svg, panel: &Panel, place: &Place) {
    let frame = &place.frame;
    let mut drawn: Vec<Vec<Spot>> = Vec::new();
    for curve in &panel.curves {
        let style = &curve.style;
        if let Some(attributes) = line_attributes(style) {
            let strokes = strokes(place.spots(curve), frame);
            let (alone, lines): (Vec<_>, Vec<_>) =
                strokes.iter().partition(|stroke| stroke.len() == 1);
            let join = |strokes: Vec<&Vec<Spot>>| -> String {
                strokes.into_iter().map(|stroke| path_data(stroke)).collect()
            };
            svg.path(&join(lines), &attributes);
            // A single point between gaps is drawn as a dot, since a line would not show.
            let dot = format!(
                " stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\"",
                style.colour.hex(),
                px(1.5 * style.width)
            );
            svg.path(&join(alone), &dot);
            drawn.extend(strokes);
        }
        if let Some(shape) = style.point {
            let spots = points(place.spots(curve), frame);
            let data: String = spots.iter().map(|spot| point_data(shape, *spot)).collect();
            svg.path(&data, &point_attributes(style, shape));
        }
    }
    let shown =
        panel.labels.iter().filter(|label| place.x.contains(label.x) && place.y.contains(label.y));
    let texts: Vec<(Spot, &str)> = shown
        .map(|label| ((place.across(label.x), place.down(label.y)), label.text.as_str()))
        .collect();
    for label in label::place(&texts, &drawn, frame) {
        svg.text(label.at, TICK, label.anchor, &label.text, RIM);
    }
}

fn axes(svg: &mut Svg, place: &Place) {
    let frame = &place.frame;
    let mut data = format!(
        "M{} {}h{}v{}h{}z",
        px(frame.x),
        px(frame.y),
        px(frame.w),
        px(frame.h),
        px(-frame.w)
    );
    let x_ticks = place.x_ticks.major.iter().map(|tick| (tick.value, TICK_LENGTH));
    for (value, length) in x_ticks.chain(place.x_ticks.minor.iter().map(|v| (*v, 3.0))) {
        data += &format!("M{} {}v{}", px(place.across(value)), px(frame.bottom()), px(length));
    }
    let y_ticks = place.y_ticks.major.iter().map(|tick| (tick.value, TICK_LENGTH));
    for (value, length) in y_ticks.chain(place.y_ticks.minor.iter().map(|v| (*v, 3.0))) {
        data += &format!("M{} {}h{}", px(frame.x), px(place.down(value)), px(-length));
    }
    svg.path(&data, &format!(" stroke=\"{INK}\" stroke-width=\"0.9\""));

    for tick in &place.y_ticks.major {
        let at = (frame.x - TICK_LENGTH - 4.0, place.down(tick.value) + HALF_CAPITAL * TICK);
        svg.text(at, TICK, Anchor::End, &tick.label, "");
    }
    if !place.y_ticks.note.is_empty() {
        let at = (frame.x, frame.y - 6.0);
        svg.text(at, TICK, Anchor::Start, &place.y_ticks.note, RIM);
    }
    y_label(svg, place);
    if place.x_written {
        x_labels(svg, place);
    }
}

fn y_label(svg: &mut Svg, place: &Place) {
    let middle = place.frame.y + 0.5 * place.frame.h;
    for (line, text) in place.y_label.iter().rev().enumerate() {
        let x = place.y_label_at - line as f64 * LABEL * LEADING;
        let turn = format!(" transform=\"rotate(-90 {} {})\"", px(x), px(middle));
        svg.text((x, middle), LABEL, Anchor::Middle, text, &turn);
    }
}

fn x_labels(svg: &mut Svg, place: &Place) {
    let frame = &place.frame;
    let base = frame.bottom() + TICK_LENGTH + 3.0 + TICK;
    for tick in &place.x_ticks.major {
        if !tick.label.is_empty() {
            svg.text((place.across(tick.value), base), TICK, Anchor::Middle, &tick.label, "");
        }
    }
    let below = base + 5.0 + LABEL;
    for (line, text) in place.x_label.iter().enumerate() {
        let at = (frame.x + 0.5 * frame.w, below + line as f64 * LABEL * LEADING);
        svg.text(at, LABEL, Anchor::Middle, text, "");
    }
    if !place.x_ticks.note.is_empty() {
        let at = (frame.right(), below + place.x_note_line as f64 * LABEL * LEADING);
        svg.text(at, TICK, Anchor::End, &place.x_ticks.note, "");
    }
}
