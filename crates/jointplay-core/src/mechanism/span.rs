//! Spans of vectors.

use nalgebra::DVector;

/// A unit vector with less than this outside a span depends on it.
const INDEPENDENT: f64 = 1e-4;

/// Span of vectors by an orthonormal basis.
pub(super) struct Span {
    pub(super) vectors: Vec<DVector<f64>>,
    pub(super) most: usize,
}

impl Span {
    /// Part of a vector outside the span.
    pub(super) fn outside(&self, vector: &DVector<f64>) -> DVector<f64> {
        let mut rest = vector.clone();
        // Twice, so that the rest is orthogonal to round-off.
        for known in self.vectors.iter().chain(&self.vectors) {
            let share = known.dot(&rest);
            rest.axpy(-share, known, 1.0);
        }
        rest
    }

    /// Whether a unit vector does not depend on those of the span.
    pub(super) fn excludes(&self, vector: &DVector<f64>) -> bool {
        self.vectors.len() < self.most && self.outside(vector).norm() > INDEPENDENT
    }

    /// Includes a unit vector, unless it depends on the others.
    pub(super) fn add(&mut self, vector: &DVector<f64>) -> bool {
        let new = self.excludes(vector);
        if new {
            self.vectors.push(self.outside(vector).normalize());
        }
        new
    }
}
