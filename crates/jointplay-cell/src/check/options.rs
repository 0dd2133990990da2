//! Options of a check.

/// How closely a motion is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckOptions {
    /// SegmentSampleTimes a second [Hz].
    pub rate: f64,
    /// Distances of bodies are followed below this; farther ones count as far [m].
    pub near: f64,
}

impl Default for CheckOptions {
    fn default() -> Self {
        Self { rate: 1000.0, near: 0.05 }
    }
}
