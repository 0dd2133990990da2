//! Intervals of the timing diagram.

/// A time interval of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    /// Start (s).
    pub from: f64,
    /// End (s).
    pub to: f64,
    /// Its kind.
    pub kind: IntervalKind,
}

/// The kind of a time interval.
#[derive(Debug, Clone, PartialEq)]
pub enum IntervalKind {
    /// Motion of an axis, by index, without a wafer on any effector.
    Empty(usize),
    /// Motion of an axis, by index, with a wafer on an effector.
    Loaded(usize),
    /// An instruction, with its labels from long to short; the first one that fits is shown.
    Instruction(Vec<String>),
    /// Wafers on an effector or at a station, by row of `places`.
    Wafers {
        /// The row.
        row: usize,
        /// Number of wafers as a share of the slots.
        share: f64,
    },
    /// Process of a station, by row of `places`.
    Process(usize),
    /// A violation.
    Violation,
}
