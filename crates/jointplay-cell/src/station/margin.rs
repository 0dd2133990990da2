//! Distances that the uncertainty of a station requires.

use nalgebra::Vector3;

use super::description::{SlotId, Station};
use crate::workcell::Cell;

/// Number of points on the edge of a wafer at which its displacement is computed.
const EDGE_POINTS: usize = 24;

impl Cell {
    /// Distances that the wafers in the slots of a station need for the uncertainty of its frame, the lowest first (m); zero for a station without a known uncertainty, which counts as exact.
    ///
    /// ```text
    ///    coverage factor · largest standard deviation of the displacement of a point on the wafer's edge, in any direction
    /// ```
    #[must_use]
    pub fn slot_margins(&self, station: &Station) -> Vec<f64> {
        let known = &station.uncertainty;
        if !known.is_known() {
            return vec![0.0; station.slots];
        }
        let factor = known.coverage(self.coverage_factor);
        let radius = 0.5 * self.wafer.diameter;
        let margin = |slot: usize| {
            let center = station.slot_position(slot);
            let edge = (0..EDGE_POINTS).map(|k| {
                let angle = std::f64::consts::TAU * k as f64 / EDGE_POINTS as f64;
                center + Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
            });
            factor * edge.map(|point| known.largest_deviation(&point)).fold(0.0, f64::max)
        };
        (1..=station.slots).map(margin).collect()
    }

    /// Distance that the wafer in a slot needs for the uncertainty of its station, see [`Self::slot_margins`] (m).
    ///
    /// # Panics
    /// If the cell has no such slot.
    #[must_use]
    pub fn slot_margin(&self, SlotId { station, slot }: SlotId) -> f64 {
        self.slot_margins(&self.stations[station])[slot - 1]
    }
}
