//! Intervals of coordinates.

/// Least and largest coordinate along a direction [m], or wider.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) least: f64,
    pub(crate) most: f64,
}

impl Span {
    /// What is between two spans; below zero where they overlap.
    pub(crate) fn gap(self, other: Self) -> f64 {
        (self.least - other.most).max(other.least - self.most)
    }

    /// The least span that holds both.
    pub(crate) fn with(self, other: Self) -> Self {
        Self { least: self.least.min(other.least), most: self.most.max(other.most) }
    }

    /// With so much more at either end.
    pub(crate) fn wider(self, by: f64) -> Self {
        Self { least: self.least - by, most: self.most + by }
    }
}
