//! Options of a check.

/// Sampling rate and reporting range of a check.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckOptions {
    /// Sampling rate (Hz).
    pub rate: f64,
    /// Minimum distances from this on are not reported (m).
    pub near: f64,
}

impl Default for CheckOptions {
    fn default() -> Self {
        Self { rate: 1000.0, near: 0.05 }
    }
}
