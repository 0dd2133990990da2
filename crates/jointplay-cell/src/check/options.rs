//! Options of a check.

/// Sampling rate and reporting range of a check.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckOptions {
    /// Sampling rate (Hz).
    pub rate: f64,
    /// Minimum distances from this on are not reported (m).
    pub report_distance: f64,
}

impl Default for CheckOptions {
    fn default() -> Self {
        Self { rate: 1000.0, report_distance: 0.05 }
    }
}
