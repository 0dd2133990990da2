//! Checks of a figure before it is drawn.

use crate::span::Span;
use crate::{Axis, Error, Figure, Panel, Scale};

/// Accepted widths of a figure (px).
const WIDTHS: (f64, f64) = (240.0, 4000.0);
/// Accepted heights of a panel (px).
const HEIGHTS: (f64, f64) = (60.0, 4000.0);
/// Accepted widths of a line (px).
const LINES: (f64, f64) = (0.1, 20.0);

/// Checks that the figure can be drawn.
pub(crate) fn check(figure: &Figure) -> Result<(), Error> {
    if figure.panels.is_empty() {
        return Err(Error::NoPanel { title: figure.title.clone() });
    }
    width(figure.width)?;
    figure.panels.iter().enumerate().try_for_each(|(index, panel)| check_panel(index, panel))
}

/// Checks the width of a figure or picture (px).
pub(crate) fn width(found: f64) -> Result<(), Error> {
    size("width of the figure", found, WIDTHS)
}

fn check_panel(index: usize, panel: &Panel) -> Result<(), Error> {
    size("height of a panel", panel.height, HEIGHTS)?;
    for axis in [&panel.x, &panel.y] {
        check_axis(index, axis)?;
        if panel.equal_aspect && axis.scale == Scale::Log10 {
            return Err(Error::EqualAspect { panel: index, axis: axis.label.clone() });
        }
    }
    let mut drawn = false;
    for curve in &panel.curves {
        size("width of a line", curve.style.width, LINES)?;
        if curve.x.len() != curve.y.len() {
            return Err(Error::UnequalLengths {
                panel: index,
                curve: curve.name.clone(),
                x: curve.x.len(),
                y: curve.y.len(),
            });
        }
        for (point, (x, y)) in curve.points().enumerate() {
            if !(x.is_finite() && y.is_finite()) {
                continue;
            }
            drawn = true;
            for (axis, value) in [(&panel.x, x), (&panel.y, y)] {
                positive(index, axis, value, || format!("curve {:?}, point {point}", curve.name))?;
            }
        }
    }
    for marker in &panel.markers {
        position(index, &panel.x, marker.x, || format!("marker {:?}", marker.label))?;
    }
    for label in &panel.labels {
        for (axis, value) in [(&panel.x, label.x), (&panel.y, label.y)] {
            position(index, axis, value, || format!("label {:?}", label.text))?;
        }
    }
    if drawn {
        Ok(())
    } else {
        Err(Error::NoFinitePoint { panel: index, curves: panel.curves.len() })
    }
}

fn check_axis(panel: usize, axis: &Axis) -> Result<(), Error> {
    let Some((min, max)) = axis.range else { return Ok(()) };
    positive(panel, axis, min, || "lower end of the range".to_string())?;
    match Span::exact(min, max, axis.scale) {
        Some(_) => Ok(()),
        None => Err(Error::Range { panel, axis: axis.label.clone(), min, max }),
    }
}

fn position(panel: usize, axis: &Axis, value: f64, item: impl Fn() -> String) -> Result<(), Error> {
    if !value.is_finite() {
        let (item, axis) = (item(), axis.label.clone());
        return Err(Error::NotFinite { panel, item, axis, value });
    }
    positive(panel, axis, value, item)
}

fn positive(panel: usize, axis: &Axis, value: f64, item: impl Fn() -> String) -> Result<(), Error> {
    if axis.scale == Scale::Log10 && value <= 0.0 {
        let (item, axis) = (item(), axis.label.clone());
        return Err(Error::NotPositive { panel, item, axis, value });
    }
    Ok(())
}

fn size(what: &'static str, found: f64, (min, max): (f64, f64)) -> Result<(), Error> {
    if (min..=max).contains(&found) { Ok(()) } else { Err(Error::Size { what, found, min, max }) }
}
