//! Series of a study over its samples: the paper's Figs. 5 to 11.

use std::ops::Range;

use jointplay_study::{Order, Samples, Series, SeriesKind};

use super::symbol;
use crate::{Axis, Curve, Figure, Panel, rod_style};

/// Which part of a study a figure shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// All samples.
    Full,
    /// One run over the pitches, with its singular pass.
    NearPass,
}

/// Rod lengths over the samples (Fig. 5).
#[must_use]
pub fn rods(samples: &Samples, extent: Extent) -> Figure {
    figure(samples, extent, "Rod lengths", "rod length (mm)", SeriesKind::Rod)
}

/// Sides over the samples (Figs. 8 and 11).
#[must_use]
pub fn sides(samples: &Samples, extent: Extent) -> Figure {
    let title = format!("Sides between ball centres, {} study", samples.virtualization);
    figure(samples, extent, &title, "side (mm)", SeriesKind::Side)
}

/// Linear or angular virtual joints over the samples (Figs. 6, 7, 9, 10); `None` if there are none of that kind.
#[must_use]
pub fn virtual_joints(samples: &Samples, extent: Extent, kind: SeriesKind) -> Option<Figure> {
    if !samples.series().iter().any(|series| series.kind == kind) {
        return None;
    }
    let (title, label) = match kind {
        SeriesKind::Angular => ("Angular virtual joints", "angle (deg)"),
        _ => ("Linear virtual joints", "length (mm)"),
    };
    let title = format!("{title}, {} virtualization", samples.virtualization);
    Some(figure(samples, extent, &title, label, kind))
}

/// One panel for each symbol of the kind, one curve for each limb.
fn figure(samples: &Samples, extent: Extent, title: &str, label: &str, kind: SeriesKind) -> Figure {
    let shown = shown(samples, extent);
    let mut figure = Figure::new(title);
    let series: Vec<Series<'_>> =
        samples.series().into_iter().filter(|series| series.kind == kind).collect();
    for limbs in series.chunk_by(|a, b| family(&a.name) == family(&b.name)) {
        let mut panel = Panel::new(Axis::linear("sample"), Axis::linear(label));
        for (k, series) in limbs.iter().enumerate() {
            let (x, y) = points(samples, series, &shown);
            panel = panel.with_curve(Curve::new(symbol(&series.name), x, y, rod_style(k)));
        }
        if extent == Extent::NearPass {
            for pass in samples.singular_passes().filter(|pass| shown.contains(pass)) {
                panel = panel.with_marker(position(pass), "singular pass");
            }
        }
        figure = figure.with_panel(panel);
    }
    figure
}

/// The letters of a name, without the number of the limb.
fn family(name: &str) -> &str {
    name.trim_end_matches(|letter: char| letter.is_ascii_digit())
}

/// Samples that a figure shows; near a pass, the row of the one a ninth of the way through, where no rod stays at rest.
fn shown(samples: &Samples, extent: Extent) -> Range<usize> {
    let passes: Vec<usize> = samples.singular_passes().collect();
    match (extent, passes.get(passes.len() / 9)) {
        (Extent::NearPass, Some(pass)) => {
            let row = pass / samples.samples_per_row * samples.samples_per_row;
            row..row + samples.samples_per_row
        }
        _ => 0..samples.len(),
    }
}

/// Points of a series; the line breaks where a raster jumps back to its first pitch.
fn points(samples: &Samples, series: &Series<'_>, shown: &Range<usize>) -> (Vec<f64>, Vec<f64>) {
    let unit = if series.kind == SeriesKind::Angular { 180.0 / std::f64::consts::PI } else { 1e3 };
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for sample in shown.clone() {
        let jumps = samples.order == Order::Raster && sample % samples.samples_per_row == 0;
        if jumps && sample != shown.start {
            x.push(position(sample) - 0.5);
            y.push(f64::NAN);
        }
        x.push(position(sample));
        y.push(series.values[sample] * unit);
    }
    (x, y)
}

#[expect(clippy::cast_precision_loss, reason = "a sample number, far below 2⁵³")]
fn position(sample: usize) -> f64 {
    sample as f64
}
