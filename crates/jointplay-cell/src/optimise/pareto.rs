//! Objectives and their Pareto front.

use crate::check::{CheckResult, Report};

/// Resolutions of the objectives: wafers per hour, the least tolerance of minimum distances (m), and a share.
const THROUGHPUT_RESOLUTION: f64 = 0.1;
const CLEARANCE_RESOLUTION: f64 = 2e-5;
const SLIP_RESOLUTION: f64 = 1e-3;

/// Objectives of a program without violations; larger is better for all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Objectives {
    /// Wafers per hour of the repeated program (1/h).
    pub wafers_per_hour: f64,
    /// Minimum distance of all pairs; the reporting range where none is smaller (m).
    pub clearance: f64,
    /// 1 minus the largest utilization of friction.
    pub slip_margin: f64,
}

impl Objectives {
    /// Objectives of a report; `None` with violations, and without placed wafers.
    ///
    /// # Arguments
    /// * `report_distance` – reporting range of minimum distances (m)
    #[must_use]
    pub fn of(report: &Report, report_distance: f64) -> Option<Self> {
        if report.result != CheckResult::Passed {
            return None;
        }
        let slip = report.by_instruction.iter().filter_map(|row| row.slip);
        Some(Self {
            wafers_per_hour: report.wafers_per_hour?,
            clearance: report.distances.first().map_or(report_distance, |pair| pair.distance),
            slip_margin: 1.0 - slip.map(|slip| slip.ratio).fold(0.0, f64::max),
        })
    }

    /// Objectives as multiples of their resolutions.
    fn steps(&self) -> [f64; 3] {
        let values = [self.wafers_per_hour, self.clearance, self.slip_margin];
        let resolutions = [THROUGHPUT_RESOLUTION, CLEARANCE_RESOLUTION, SLIP_RESOLUTION];
        std::array::from_fn(|k| (values[k] / resolutions[k]).round())
    }

    /// Whether all objectives are at least as large as those of another program, and at least one is larger, at the resolution of the objectives: 0.1 wafers per hour, 20 µm, 0.1 % of the friction.
    #[must_use]
    pub fn dominates(&self, other: &Self) -> bool {
        let pairs = || self.steps().into_iter().zip(other.steps());
        pairs().all(|(one, other)| one >= other) && pairs().any(|(one, other)| one > other)
    }
}

/// Indices of the objectives that no others dominate, by decreasing throughput; of equal ones the first.
#[must_use]
pub fn pareto_front(all: &[Objectives]) -> Vec<usize> {
    let is_best = |index: &usize| {
        let one = &all[*index];
        !(all.iter().any(|other| other.dominates(one))
            || all[..*index].iter().any(|other| other.steps() == one.steps()))
    };
    let mut front: Vec<usize> = (0..all.len()).filter(is_best).collect();
    front.sort_by(|&one, &other| all[other].wafers_per_hour.total_cmp(&all[one].wafers_per_hour));
    front
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_has_what_no_other_exceeds_at_the_resolution() {
        let one = |wafers_per_hour, clearance, slip_margin| Objectives {
            wafers_per_hour,
            clearance,
            slip_margin,
        };
        let all = [
            one(100.0, 2e-3, 0.2),
            one(120.0, 2e-3, 0.1),
            // Dominated by the first, equal to it at the resolution, and better by less than it.
            one(90.0, 2e-3, 0.2),
            one(100.0, 2e-3, 0.2),
            one(100.01, 2.001e-3, 0.2),
            one(80.0, 3e-3, 0.2),
        ];
        assert_eq!(pareto_front(&all), [1, 0, 5]);
        assert!(all[0].dominates(&all[2]) && !all[0].dominates(&all[1]));
        assert!(!all[4].dominates(&all[0]));
    }
}
