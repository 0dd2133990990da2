//! Summary of a study.

use jointplay_core::gpr::{Gpr, Limits};
use jointplay_study::{BoundsCheck, Samples, Summary};

use crate::table::{column_name, column_value};
use jointplay_format::units::{deg, mm, um};

/// Summary of a study under one virtualization.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct StudyReport {
    /// Name of the virtualization.
    pub virtualization: String,
    /// Solver used.
    pub solver: String,
    /// ρ of the metric (mm).
    pub characteristic_length_mm: f64,
    /// Number of samples.
    pub samples: usize,
    /// Samples at the singular configuration.
    pub singular_passes: usize,
    /// Rods, sides and virtual joints.
    pub series: Vec<SeriesReport>,
    /// Largest distance of O_p from the base axis (µm).
    pub largest_center_shift_um: f64,
    /// Largest torsion about the platform normal (deg).
    pub largest_torsion_deg: f64,
    /// Largest residual of the sides (mm).
    pub largest_residual_mm: f64,
    /// Largest number of iterations of a sample.
    pub most_iterations: usize,
    /// Number of samples with 0, 1, 2, … iterations.
    pub iteration_counts: Vec<usize>,
    /// Number of poses within the first-order bounds of the sensitivity.
    pub bounds: BoundsHeldReport,
    /// Samples that tilt beyond the robot's limit, which studies include on purpose.
    pub samples_beyond_tilt_limit: usize,
    /// Samples with a rod beyond the robot's limits.
    pub samples_beyond_stroke: usize,
    /// The tilt limit (deg).
    pub tilt_limit_deg: f64,
}

/// Summary of one series, in the unit of its name.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct SeriesReport {
    /// Name with unit, as the column in the table.
    pub name: String,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Least and greatest value at the singular passes; `null` without passes.
    pub at_singular_passes: Option<[f64; 2]>,
    /// Passes at which the series is least in its row.
    pub minimum_at_passes: usize,
    /// Passes at which the series is greatest in its row.
    pub maximum_at_passes: usize,
    /// Passes at which the whole row is constant, to a hundredth of the series' span.
    pub constant_at_passes: usize,
}

/// Number of poses whose displacement is within the bounds, by the configuration of the derivatives.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[expect(missing_docs, reason = "the names are the configurations")]
pub struct BoundsHeldReport {
    pub poses: usize,
    pub held_at_start: usize,
    pub held_at_midpoint: usize,
    pub held_at_end: usize,
}

/// Reports the summary of a study.
#[must_use]
pub fn study(gpr: &Gpr, samples: &Samples, summary: &Summary, bounds: &BoundsCheck) -> StudyReport {
    let kinds = samples.series();
    let series = summary.series.iter().zip(&kinds).map(|(summed, series)| {
        let value = |x| column_value(x, series.kind);
        SeriesReport {
            name: column_name(&summed.name, series.kind),
            min: value(summed.min),
            max: value(summed.max),
            at_singular_passes: summed
                .pass_min
                .zip(summed.pass_max)
                .map(|(a, b)| [value(a), value(b)]),
            minimum_at_passes: summed.minimum_at,
            maximum_at_passes: summed.maximum_at,
            constant_at_passes: summed.constant_at,
        }
    });
    let Limits { tilt_max, .. } = *gpr.limits();
    StudyReport {
        virtualization: samples.virtualization.clone(),
        solver: samples.solver.to_string(),
        characteristic_length_mm: mm(samples.characteristic_length),
        samples: summary.samples,
        singular_passes: summary.singular_passes,
        series: series.collect(),
        largest_center_shift_um: um(summary.largest_center_shift),
        largest_torsion_deg: deg(summary.largest_torsion),
        largest_residual_mm: mm(summary.largest_residual),
        most_iterations: summary.iterations.len().saturating_sub(1),
        iteration_counts: summary.iterations.clone(),
        bounds: BoundsHeldReport {
            poses: bounds.poses,
            held_at_start: bounds.held_at_start,
            held_at_midpoint: bounds.held_at_midpoint,
            held_at_end: bounds.held_at_end,
        },
        samples_beyond_tilt_limit: summary.beyond_tilt,
        samples_beyond_stroke: summary.beyond_stroke,
        tilt_limit_deg: deg(tilt_max),
    }
}
