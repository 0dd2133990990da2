//! Cycle time and margins of a checked program.

use super::report::{Report, Utilization};

/// Cycle time of a program and its least favourable values over all instructions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeyFigures {
    /// Duration of the trajectory (s).
    pub duration: f64,
    /// Wafers per hour of the repeated program; `None` without wafers (1/h).
    pub wafers_per_hour: Option<f64>,
    /// Minimum distance of all pairs; `None` where all exceed the reporting range (m).
    pub minimum_distance: Option<f64>,
    /// Largest velocity relative to its limit; `None` without motion.
    pub velocity: Option<f64>,
    /// Largest acceleration relative to its limit; `None` without motion.
    pub acceleration: Option<f64>,
    /// Largest jerk relative to its limit; `None` without motion.
    pub jerk: Option<f64>,
    /// Largest tilt relative to its limit.
    pub tilt: f64,
    /// Largest displacement of the virtual joints relative to the play budget.
    pub play: f64,
    /// Largest utilization of friction; `None` where no wafer is carried.
    pub slip: Option<f64>,
    /// Number of violations.
    pub violations: usize,
}

impl KeyFigures {
    /// The key figures of a report.
    #[must_use]
    pub fn of(report: &Report) -> Self {
        let rows = &report.by_instruction;
        let largest = |found: &mut dyn Iterator<Item = Option<Utilization>>| {
            found.flatten().map(|one| one.ratio).reduce(f64::max)
        };
        Self {
            duration: report.duration,
            wafers_per_hour: report.wafers_per_hour,
            // Pairs are sorted, the nearest first.
            minimum_distance: report.distances.first().map(|pair| pair.distance),
            velocity: largest(&mut rows.iter().map(|row| row.velocity)),
            acceleration: largest(&mut rows.iter().map(|row| row.acceleration)),
            jerk: largest(&mut rows.iter().map(|row| row.jerk)),
            tilt: rows.iter().map(|row| row.tilt).fold(0.0, f64::max),
            play: rows.iter().map(|row| row.play).fold(0.0, f64::max),
            slip: largest(&mut rows.iter().map(|row| row.slip)),
            violations: report.violations.len(),
        }
    }
}
