//! Intervals of coordinates, of which axis-aligned boxes are made.

/// Interval that contains the coordinates of a collider along a direction (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval {
    pub(crate) min: f64,
    pub(crate) max: f64,
}

impl Interval {
    /// Gap between two intervals (m); negative where they overlap.
    pub(crate) fn gap(self, other: Self) -> f64 {
        (self.min - other.max).max(other.min - self.max)
    }

    /// The least interval that contains both.
    pub(crate) fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// This interval extended at both ends (m).
    pub(crate) fn inflated(self, by: f64) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }
}
