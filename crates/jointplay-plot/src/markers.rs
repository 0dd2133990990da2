//! Placement of the names of vertical lines, in rows above the frame without overlap.

use crate::Marker;
use crate::text::{TICK, width};

/// A marker within the range of its panel.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlacedMarker {
    /// Position of the line (px).
    pub(crate) x: f64,
    /// Middle of the name (px).
    pub(crate) middle: f64,
    /// Row of the name, counted from the frame upwards.
    pub(crate) row: usize,
    /// The name.
    pub(crate) text: String,
}

/// Positions for the names of markers with their x positions (px), between `left` and `right` (px).
///
/// The first `reserved` (px) of the lowest row are kept free.
pub(crate) fn place(
    markers: &[(f64, &Marker)],
    left: f64,
    right: f64,
    reserved: f64,
) -> Vec<PlacedMarker> {
    let mut in_order: Vec<&(f64, &Marker)> = markers.iter().collect();
    in_order.sort_by(|a, b| a.0.total_cmp(&b.0));
    // How far each row is filled.
    let mut filled = vec![left + reserved];
    let mut placed = Vec::new();
    for (x, marker) in in_order {
        let half = 0.5 * width(&marker.label, TICK);
        // Moved inside where the name would be cut off, and never left of the frame.
        let middle = x.min(right - half).max(left + half);
        let free = filled.iter().position(|end| *end <= middle - half);
        let row = free.unwrap_or(filled.len());
        if row == filled.len() {
            filled.push(left);
        }
        filled[row] = middle + half + TICK;
        placed.push(PlacedMarker { x: *x, middle, row, text: marker.label.clone() });
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_names_are_stacked_and_kept_inside() {
        let marker = Marker { x: 0.0, label: "singular pass".to_string() };
        let at = |x| (x, &marker);
        let placed = place(&[at(100.0), at(120.0), at(399.0)], 0.0, 400.0, 0.0);
        assert_eq!(placed.iter().map(|name| name.row).collect::<Vec<_>>(), [0, 1, 0]);
        assert!(placed[2].middle + 0.5 * width("singular pass", TICK) <= 400.0);
    }
}
