//! Series of a study: the paper's Figs. 5 to 11 over a raster, or over the tilt angle for one tilt direction.

use jointplay_study::{Order, Samples, Series, SeriesKind};

use super::{coincident, symbol};
use crate::{Axis, Curve, Dash, Figure, Panel, Style, rod_style};

/// Height of a panel that shows one curve of a raster (px).
const RASTER_PANEL: f64 = 120.0;
/// Width of a curve with many steep strokes (px).
const THIN: f64 = 1.0;

/// Rod lengths (Fig. 5).
#[must_use]
pub fn rods(samples: &Samples) -> Figure {
    figure(samples, "Rod lengths", "rod length (mm)", SeriesKind::Rod)
}

/// Sides between ball centres (Figs. 8 and 11); the rods determine them, so they are the same for every virtualization.
#[must_use]
pub fn sides(samples: &Samples) -> Figure {
    figure(samples, "Sides between ball centres", "side (mm)", SeriesKind::Side)
}

/// Linear or angular virtual joints (Figs. 6, 7, 9, 10); `None` if there are none of that kind.
#[must_use]
pub fn virtual_joints(samples: &Samples, kind: SeriesKind) -> Option<Figure> {
    if !samples.series().iter().any(|series| series.kind == kind) {
        return None;
    }
    let (title, label) = match kind {
        SeriesKind::Angular => ("Angular virtual joints", "angle (deg)"),
        _ => ("Linear virtual joints", "length (mm)"),
    };
    let title = format!("{title}, {} virtualization", samples.virtualization);
    Some(figure(samples, &title, label, kind))
}

/// The series of a kind: over the tilt angle in one panel a symbol if there is one tilt direction, else one panel a curve.
fn figure(samples: &Samples, title: &str, label: &str, kind: SeriesKind) -> Figure {
    let series: Vec<Series<'_>> =
        samples.series().into_iter().filter(|series| series.kind == kind).collect();
    let families = series.chunk_by(|a, b| family(&a.name) == family(&b.name));
    if samples.len() == samples.samples_per_row {
        let direction = samples.azimuth.first().map_or(0.0, |azimuth| azimuth.to_degrees());
        let title = format!("{title}, tilt direction {:.4}°", direction);
        let title = title.replace(".0000°", "°");
        families.fold(Figure::new(title), |figure, limbs| {
            figure.with_panel(one_direction(samples, limbs, label))
        })
    } else {
        families.fold(Figure::new(title), |figure, limbs| raster(samples, limbs, label, figure))
    }
}

/// A panel over the tilt angle, with its singular configuration.
fn one_direction(samples: &Samples, limbs: &[Series<'_>], label: &str) -> Panel {
    let angles: Vec<f64> =
        samples.tilt_angle.iter().map(|tilt_angle| tilt_angle.to_degrees()).collect();
    let curves = limbs.iter().enumerate().map(|(limb, series)| {
        Curve::new(symbol(&series.name), angles.clone(), values(series), rod_style(limb))
    });
    let mut panel = Panel::new(Axis::linear("tilt angle (deg)"), Axis::linear(label));
    panel.curves = coincident::merged(curves.collect(), unit(limbs), panel.height);
    for sample in samples.singular_passes() {
        panel = panel.with_marker(angles[sample], "singular: rods equal");
    }
    panel
}

/// The figure with a panel for each curve that differs from the others of its symbol.
fn raster(samples: &Samples, limbs: &[Series<'_>], label: &str, mut figure: Figure) -> Figure {
    let x = positions(samples);
    let curves = limbs.iter().enumerate().map(|(limb, series)| {
        let style = Style::line(rod_style(limb).colour, Dash::Solid).with_width(THIN);
        Curve::new(symbol(&series.name), x.clone(), values(series), style)
    });
    for mut curve in coincident::merged(curves.collect(), unit(limbs), RASTER_PANEL) {
        broken_between_rows(&mut curve, samples);
        let panel = Panel::new(Axis::linear(axis_label(samples)), Axis::linear(label))
            .with_height(RASTER_PANEL)
            .with_curve(curve);
        figure = figure.with_panel(panel);
    }
    figure
}

/// Label of the horizontal axis of a raster: an interval for each tilt direction, with all tilt angles in it.
fn axis_label(samples: &Samples) -> String {
    let ends = [samples.tilt_angle.first(), samples.tilt_angle.get(samples.samples_per_row - 1)];
    let [from, to] = ends.map(|tilt_angle| {
        let text = format!("{:.3}", tilt_angle.copied().unwrap_or_default().to_degrees());
        text.trim_end_matches('0').trim_end_matches('.').replace('-', "−")
    });
    let back = if samples.order == Order::Serpentine { " or back" } else { "" };
    format!("tilt direction (deg); from each to the next, tilt angle from {from}° to {to}°{back}")
}

/// Position of each sample along the axis of tilt directions (deg).
#[expect(clippy::cast_precision_loss, reason = "a sample number, far below 2⁵³")]
fn positions(samples: &Samples) -> Vec<f64> {
    let count = samples.samples_per_row;
    let direction = |row: usize| samples.azimuth[row * count].to_degrees();
    let last_row = samples.len() / count - 1;
    (0..samples.len())
        .map(|sample| {
            let (row, within) = (sample / count, sample % count);
            // The last direction gets an interval as wide as the one before it.
            let step = if row < last_row {
                direction(row + 1) - direction(row)
            } else {
                direction(row) - direction(row - 1)
            };
            direction(row) + step * within as f64 / count as f64
        })
        .collect()
}

/// Ends the line where a raster jumps back to its first tilt angle.
fn broken_between_rows(curve: &mut Curve, samples: &Samples) {
    if samples.order == Order::Raster {
        for row in (1..samples.len() / samples.samples_per_row).rev() {
            let start = row * samples.samples_per_row;
            curve.x.insert(start, curve.x[start]);
            curve.y.insert(start, f64::NAN);
        }
    }
}

/// The letters of a name, without the number of the limb.
fn family(name: &str) -> &str {
    name.trim_end_matches(|letter: char| letter.is_ascii_digit())
}

/// Values in the unit of the figure.
fn values(series: &Series<'_>) -> Vec<f64> {
    let factor = match series.kind {
        SeriesKind::Angular => 180.0 / std::f64::consts::PI,
        _ => 1e3,
    };
    series.values.iter().map(|value| value * factor).collect()
}

/// The unit of [`values`].
fn unit(limbs: &[Series<'_>]) -> &'static str {
    match limbs.first().map(|series| series.kind) {
        Some(SeriesKind::Angular) => "deg",
        _ => "mm",
    }
}
