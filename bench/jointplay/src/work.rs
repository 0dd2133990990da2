//! Interface of the benchmarks.

/// Work that is solved repeatedly.
pub(crate) trait Work {
    /// Solves everything; returns how many were solved.
    fn solve(&mut self) -> usize;
    /// Solves so many positions, by a call each that waits for the one before, or many at a time in one call; returns how many were solved, `None` where that is not measured.
    fn call(&mut self, _times: usize) -> Option<usize> {
        None
    }
    /// The numbers of the last answers, `None` for what was not solved.
    fn answers(&self) -> Vec<Option<Vec<f64>>>;
}
