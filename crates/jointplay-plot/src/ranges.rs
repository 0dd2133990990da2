//! From where to where the axes of each panel are drawn.

use crate::span::{Extent, Span};
use crate::{Axis, Error, Figure, Panel};

/// Room between the data and the ends of an axis, as a fraction of the extent of the data.
const MARGIN: f64 = 0.06;

/// Whether the panels share one x axis, drawn under the last.
pub(crate) fn shares_x(figure: &Figure) -> bool {
    let first = &figure.panels[0];
    figure.panels.iter().all(|panel| panel.x == first.x && !panel.equal_aspect)
}

/// The spans of the x and y axis of each panel.
pub(crate) fn spans(figure: &Figure) -> Result<Vec<(Span, Span)>, Error> {
    let common: Vec<&Panel> =
        if shares_x(figure) { figure.panels.iter().collect() } else { Vec::new() };
    let spans = figure.panels.iter().enumerate().map(|(index, panel)| {
        let own = [panel];
        let together = if common.is_empty() { &own[..] } else { &common[..] };
        // Lines may touch the ends of the x axis; points and geometry need room there.
        let tight = together.iter().all(|panel| {
            !panel.equal_aspect && panel.curves.iter().all(|curve| curve.style.point.is_none())
        });
        let xs = together.iter().flat_map(|panel| x_values(panel));
        let x = span(index, &panel.x, xs, if tight { 0.0 } else { MARGIN })?;
        let inside = y_values(panel, |value| x.contains(value));
        let y = match Extent::of(inside.iter().copied()) {
            Some(_) => span(index, &panel.y, inside, MARGIN)?,
            None => span(index, &panel.y, y_values(panel, |_| true), MARGIN)?,
        };
        Ok((x, y))
    });
    spans.collect()
}

fn span(
    panel: usize,
    axis: &Axis,
    values: impl IntoIterator<Item = f64>,
    margin: f64,
) -> Result<Span, Error> {
    let extent = match axis.range {
        Some((min, max)) => Extent { min, max },
        None => Extent::of(values).expect("a checked panel has a finite point"),
    };
    let Extent { min, max } = extent;
    let span = match axis.range {
        Some(_) => Span::exact(min, max, axis.scale),
        None => Span::around(extent, margin, axis.scale),
    };
    span.ok_or_else(|| Error::Range { panel, axis: axis.label.clone(), min, max })
}

/// All finite positions along the x axis.
fn x_values(panel: &Panel) -> Vec<f64> {
    let points = panel.curves.iter().flat_map(|curve| curve.points());
    let finite = points.filter(|(x, y)| x.is_finite() && y.is_finite()).map(|(x, _)| x);
    let markers = panel.markers.iter().map(|marker| marker.x);
    finite.chain(markers).chain(panel.labels.iter().map(|label| label.x)).collect()
}

/// All finite positions along the y axis of points that `shows` by their x.
fn y_values(panel: &Panel, shows: impl Fn(f64) -> bool) -> Vec<f64> {
    let points = panel.curves.iter().flat_map(|curve| curve.points());
    let labels = panel.labels.iter().map(|label| (label.x, label.y));
    points
        .chain(labels)
        .filter(|(x, y)| x.is_finite() && y.is_finite() && shows(*x))
        .map(|(_, y)| y)
        .collect()
}
