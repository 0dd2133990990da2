//! The overlap of two successive segments.

/// Overlap of a step with the next, so that the axes do not stop between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    /// Time during which both segments are superposed (s).
    pub overlap: f64,
    /// Upper bound on the distance of a wafer's centre from the unblended path (m).
    pub deviation: f64,
}
