//! Layout of a figure on the page.

use crate::legend::{APART, Entry, Legend, entries};
use crate::markers::{self, PlacedMarker};
use crate::path::Rectangle;
use crate::ranges::{shares_x, spans};
use crate::span::Span;
use crate::text::{LABEL, LEADING, TICK, TITLE, width, wrap};
use crate::tick::Ticks;
use crate::ticks::{level_ticks, upright_ticks};
use crate::{Error, Figure, Panel};

/// Left and right of everything (px).
const EDGE: f64 = 12.0;
/// Length of a tick (px).
pub(crate) const TICK_LENGTH: f64 = 5.0;
/// From row to row of the names of markers (px).
pub(crate) const MARKER_ROW: f64 = 15.0;
/// Smallest side of a frame with equal aspect (px).
const SMALLEST: f64 = 120.0;

/// A panel on the page.
pub(crate) struct Place {
    /// Between the ends of the axes.
    pub(crate) frame: Rectangle,
    /// Drawn part of the x axis.
    pub(crate) x: Span,
    /// Drawn part of the y axis.
    pub(crate) y: Span,
    /// Ticks of the x axis.
    pub(crate) x_ticks: Ticks,
    /// Ticks of the y axis.
    pub(crate) y_ticks: Ticks,
    /// Label of the x axis, in lines; empty where the axis is that of a panel below.
    pub(crate) x_label: Vec<String>,
    /// Line of the x axis label that holds the note of its ticks.
    pub(crate) x_note_line: usize,
    /// Label of the y axis, in lines.
    pub(crate) y_label: Vec<String>,
    /// Whether this panel writes the labels of the x axis.
    pub(crate) x_written: bool,
    /// Base line of the last line of the label of the y axis (px).
    pub(crate) y_label_at: f64,
    /// Caption, in lines.
    pub(crate) caption: Vec<String>,
    /// Base line of the first line of the caption (px).
    pub(crate) caption_at: f64,
    /// Own legend, which may have no entry.
    pub(crate) legend: Legend,
    /// Middle and upper edge of the own legend (px).
    pub(crate) legend_at: (f64, f64),
    /// Vertical lines.
    pub(crate) markers: Vec<PlacedMarker>,
}

/// A figure on its page.
pub(crate) struct Layout {
    /// Height of the page (px).
    pub(crate) height: f64,
    /// Title, in lines.
    pub(crate) title: Vec<String>,
    /// Middle of the title (px).
    pub(crate) title_at: f64,
    /// Common legend, which may have no entry.
    pub(crate) legend: Legend,
    /// Middle and upper edge of the common legend (px).
    pub(crate) legend_at: (f64, f64),
    /// Panels from top to bottom.
    pub(crate) places: Vec<Place>,
}

/// Size of a frame and what is written along it, before it has a position.
struct Sized {
    w: f64,
    h: f64,
    x: Span,
    y: Span,
    x_ticks: Ticks,
    y_ticks: Ticks,
}

/// Lays out a figure that has passed [`crate::check`].
pub(crate) fn lay_out(figure: &Figure) -> Result<Layout, Error> {
    let spans = spans(figure)?;
    let panels = || figure.panels.iter().zip(&spans);

    // 1. The margins depend on the tick labels, and these on the room between the margins: a few rounds settle both.
    let y_lines = |panel: &Panel| wrap(&panel.y.label, LABEL, panel.height + 20.0).len() as f64;
    let most_lines = figure.panels.iter().map(y_lines).fold(0.0, f64::max);
    let label_room = if most_lines > 0.0 { most_lines * LABEL * LEADING + 4.0 } else { 0.0 };
    let (mut widest, mut right) = (40.0, EDGE);
    let mut sized: Vec<Sized> = Vec::new();
    let (mut left, mut settled) = (EDGE, 0.0);
    for round in 0..4 {
        settled = widest;
        left = EDGE + label_room + settled + TICK_LENGTH + 4.0;
        let room = (figure.width - left - right).max(SMALLEST);
        sized = panels().map(|(panel, (x, y))| size(panel, x, y, room)).collect();
        // The first guess may shrink; after that the margins only grow, so that they do not swing.
        let (least, edge) = if round == 0 { (0.0, EDGE) } else { (widest, right) };
        widest = sized.iter().map(|size| size.y_ticks.widest()).fold(least, f64::max);
        right = sized.iter().map(overhang).fold(edge, f64::max);
    }
    let room = (figure.width - left - right).max(SMALLEST);
    let page = figure.width - 2.0 * EDGE;
    // Titles and legends are centred over the frames, or shifted to fit the page.
    let middle = |wide: f64| {
        let half = 0.5 * wide;
        (left + 0.5 * room).min(figure.width - EDGE - half).max(EDGE + half)
    };

    // 2. Title and common legend.
    let mut y = EDGE;
    let title = wrap(&figure.title, TITLE, page);
    let title_at = middle(title.iter().map(|line| width(line, TITLE)).fold(0.0, f64::max));
    if !title.is_empty() {
        y += title.len() as f64 * TITLE * LEADING + 5.0;
    }
    let named: Vec<Vec<Entry>> = figure.panels.iter().map(|panel| entries(panel, page)).collect();
    let common = named.iter().all(|entries| *entries == named[0]);
    let legend = if common { Legend::new(&named[0], page) } else { Legend::default() };
    let legend_at = (middle(legend.width()), y);
    y += legend.height();

    // 3. Panels, downwards.
    let shared = shares_x(figure);
    let last = figure.panels.len() - 1;
    let mut places = Vec::new();
    for (index, (panel, size)) in figure.panels.iter().zip(sized).enumerate() {
        let Sized { w, h, x, y: y_span, x_ticks, y_ticks } = size;
        let frame_x = left + 0.5 * (room - w);
        let caption = wrap(&panel.title, LABEL, figure.width - EDGE - frame_x);
        let caption_at = y + LABEL;
        let caption_width = caption.iter().map(|line| width(line, LABEL)).fold(0.0, f64::max);
        let own = if common { Legend::default() } else { Legend::new(&named[index], page) };
        let caption_height = caption.len() as f64 * LABEL * LEADING;
        let own_at = if caption_width + APART + own.width() <= w {
            // Side by side: the caption on the left, the legend on the right.
            let top = y;
            y += caption_height.max(own.height());
            (frame_x + w - 0.5 * own.width(), top)
        } else {
            y += caption_height + own.height();
            (middle(own.width()), y - own.height())
        };

        let note = if y_ticks.note.is_empty() { 0.0 } else { width(&y_ticks.note, TICK) + TICK };
        let shown: Vec<_> = panel
            .markers
            .iter()
            .filter(|marker| x.contains(marker.x))
            .map(|marker| (frame_x + x.place(marker.x) * w, marker))
            .collect();
        let markers = markers::place(&shown, frame_x, figure.width - EDGE, note);
        let named = markers.iter().filter(|name| !name.text.is_empty());
        let rows = named.map(|name| name.row + 1).max().unwrap_or(usize::from(note > 0.0));
        y += rows as f64 * MARKER_ROW + 7.0;

        let frame = Rectangle { x: frame_x, y, w, h };
        y = frame.bottom();
        let x_written = !shared || index == last;
        let (mut x_label, mut x_note_line) = (Vec::new(), 0);
        if x_written {
            let note = width(&x_ticks.note, TICK);
            // The note is at the right end of the label, or below it if they would touch.
            x_label = wrap(&panel.x.label, LABEL, 2.0 * (figure.width - EDGE - frame_x - 0.5 * w));
            let widest = x_label.iter().map(|line| width(line, LABEL)).fold(0.0, f64::max);
            let fits = 0.5 * w - 0.5 * widest >= note + TICK;
            x_note_line = if fits { 0 } else { x_label.len() };
            let note_end = if note > 0.0 { x_note_line + 1 } else { 0 };
            let lines = x_label.len().max(note_end);
            y += TICK_LENGTH + 4.0 + TICK + 4.0 + lines as f64 * LABEL * LEADING;
        }
        y += EDGE;
        places.push(Place {
            frame,
            x,
            y: y_span,
            y_label_at: frame_x - TICK_LENGTH - 4.0 - settled - 9.0,
            x_ticks,
            y_ticks,
            x_label,
            x_note_line,
            y_label: wrap(&panel.y.label, LABEL, h + 20.0),
            x_written,
            caption,
            caption_at,
            legend: own,
            legend_at: own_at,
            markers,
        });
    }
    Ok(Layout { height: y.ceil(), title, title_at, legend, legend_at, places })
}

/// Overhang of the last x axis label to the right, with the edge (px).
fn overhang(size: &Sized) -> f64 {
    let out = |tick: &crate::tick::Tick| {
        0.5 * width(&tick.label, TICK) - (1.0 - size.x.place(tick.value)) * size.w
    };
    EDGE + size.x_ticks.major.last().map_or(0.0, out).max(0.0)
}

/// The size and ticks of a panel that has `room` (px) from left to right.
fn size(panel: &Panel, x: &Span, y: &Span, room: f64) -> Sized {
    if !panel.equal_aspect {
        let h = panel.height;
        let x_ticks = level_ticks(x, room, 75.0);
        let y_ticks = upright_ticks(y, h, 40.0);
        return Sized { w: room, h, x: *x, y: *y, x_ticks, y_ticks };
    }
    // One scale for both axes; a side that would become tiny shows more of its axis instead.
    let scale = (room / (x.hi - x.lo)).min(panel.height / (y.hi - y.lo));
    let fit = |span: &Span, most: f64| {
        let needed = (span.hi - span.lo) * scale;
        let side = needed.max(SMALLEST.min(most));
        (side, span.widened(side / needed))
    };
    let ((w, x), (h, y)) = (fit(x, room), fit(y, panel.height));
    // The same distance between ticks on both axes gives both the same steps.
    let spacing = 0.18 * w.max(h).min(400.0);
    let x_ticks = level_ticks(&x, w, spacing);
    let y_ticks = upright_ticks(&y, h, spacing);
    Sized { w, h, x, y, x_ticks, y_ticks }
}
