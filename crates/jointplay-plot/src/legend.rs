//! The legend: a sample and a name per curve, in rows above the data.

use crate::svg::{Anchor, Svg, line_attributes, path_data, point_attributes, point_data};
use crate::text::{HALF_CAPITAL, LEADING, TICK, width, wrap};
use crate::{Panel, Style};

/// Between a sample and its name (px).
const GAP: f64 = 7.0;
/// Between two entries of a row (px).
pub(crate) const APART: f64 = 22.0;
/// Between two rows, and below the last (px).
const BELOW: f64 = 3.0;

/// A curve as the legend names it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    /// Name of the curve, in lines.
    lines: Vec<String>,
    /// How the curve looks.
    style: Style,
}

impl Entry {
    /// Length of the sample: long enough for the dashes, or for a point alone (px).
    fn sample(&self) -> f64 {
        if self.style.line.is_some() { 32.0 } else { 8.0 }
    }

    fn width(&self) -> f64 {
        let name = self.lines.iter().map(|line| width(line, TICK)).fold(0.0, f64::max);
        self.sample() + GAP + name
    }

    fn height(&self) -> f64 {
        self.lines.len() as f64 * TICK * LEADING
    }

    fn draw(&self, svg: &mut Svg, left: f64, top: f64) {
        let middle = top + 0.5 * TICK * LEADING;
        let right = left + self.sample();
        if let Some(attributes) = line_attributes(&self.style) {
            svg.path(&path_data(&[(left, middle), (right, middle)]), &attributes);
        }
        if let Some(shape) = self.style.point {
            let point = point_data(shape, (0.5 * (left + right), middle));
            svg.path(&point, &point_attributes(&self.style, shape));
        }
        for (index, line) in self.lines.iter().enumerate() {
            let base = middle + (HALF_CAPITAL + index as f64 * LEADING) * TICK;
            svg.text((right + GAP, base), TICK, Anchor::Start, line, "");
        }
    }
}

/// The entries of a panel, each once, in the order of the curves, none wider than `room` (px).
pub(crate) fn entries(panel: &Panel, room: f64) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for curve in panel.curves.iter().filter(|curve| !curve.name.trim().is_empty()) {
        let mut entry = Entry { lines: Vec::new(), style: curve.style };
        entry.lines = wrap(&curve.name, TICK, room - entry.sample() - GAP);
        if !entries.contains(&entry) {
            entries.push(entry);
        }
    }
    entries
}

/// Entries in rows.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Legend(Vec<Vec<Entry>>);

impl Legend {
    /// The entries in as few rows as fit into `room` (px).
    pub(crate) fn new(entries: &[Entry], room: f64) -> Self {
        let mut rows: Vec<Vec<Entry>> = Vec::new();
        for entry in entries {
            match rows.last_mut() {
                Some(row) if row_width(row) + APART + entry.width() <= room => {
                    row.push(entry.clone());
                }
                _ => rows.push(vec![entry.clone()]),
            }
        }
        Self(rows)
    }

    /// Width of the widest row (px).
    pub(crate) fn width(&self) -> f64 {
        self.0.iter().map(|row| row_width(row)).fold(0.0, f64::max)
    }

    /// Height of all rows and the room below (px).
    pub(crate) fn height(&self) -> f64 {
        self.0.iter().map(|row| row_height(row)).sum()
    }

    /// Draws the rows about the middle `x`, from `top` down (px).
    pub(crate) fn draw(&self, svg: &mut Svg, x: f64, mut top: f64) {
        for row in &self.0 {
            let mut left = x - 0.5 * row_width(row);
            for entry in row {
                entry.draw(svg, left, top);
                left += entry.width() + APART;
            }
            top += row_height(row);
        }
    }
}

fn row_width(row: &[Entry]) -> f64 {
    row.iter().map(|entry| entry.width() + APART).sum::<f64>() - APART
}

fn row_height(row: &[Entry]) -> f64 {
    row.iter().map(Entry::height).fold(0.0, f64::max) + BELOW
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Curve, rod_style};

    #[test]
    fn entries_fill_rows_once_each() {
        let mut panel = Panel::new(Axis::linear("x"), Axis::linear("y"));
        for rod in [0, 1, 2, 0] {
            let name = format!("rod {}", rod + 1);
            panel = panel.with_curve(Curve::new(name, vec![], vec![], rod_style(rod)));
        }
        let entries = entries(&panel, 500.0);
        assert_eq!(entries.len(), 3);
        let one = entries[0].width();
        for (room, rows) in [(500.0, 1), (2.0 * one + APART, 2), (one, 3)] {
            let legend = Legend::new(&entries, room);
            assert_eq!(legend.0.len(), rows);
            assert!(legend.width() <= room);
        }
    }
}
