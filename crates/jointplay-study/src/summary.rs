//! Summary of a study.

use jointplay_core::gpr::{BrokenLimits, Gpr};
use jointplay_core::spatial::Tilt;

use crate::Samples;

/// One series summed up, in its own SI unit.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesSummary {
    /// Name of the series.
    pub name: String,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Least value at a singular pass; `None` without passes.
    pub pass_min: Option<f64>,
    /// Greatest value at a singular pass; `None` without passes.
    pub pass_max: Option<f64>,
    /// Passes at which the series is least of its row and not constant there.
    pub minimum_at: usize,
    /// Passes at which it is greatest of its row and not constant there.
    pub maximum_at: usize,
    /// Passes at which it is constant along the row, to a hundredth of the study's own span.
    pub constant_at: usize,
}

/// A study summed up.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Number of samples.
    pub samples: usize,
    /// Number of samples at the singular configuration.
    pub singular_passes: usize,
    /// Rods, sides and virtual joints.
    pub series: Vec<SeriesSummary>,
    /// Largest distance of O_p from the base axis (m).
    pub largest_center_shift: f64,
    /// Largest magnitude of the torsion about the platform normal (rad).
    pub largest_torsion: f64,
    /// Largest residual of the sides (m).
    pub largest_residual: f64,
    /// `iterations[n]`: how many samples took n iterations.
    pub iterations: Vec<usize>,
    /// Samples that tilt beyond the robot's limit.
    pub beyond_tilt: usize,
    /// Samples with a rod beyond the robot's limits.
    pub beyond_stroke: usize,
}

/// Extrema, values at the singular passes, residuals and iteration counts of a study.
#[must_use]
pub fn summarize(gpr: &Gpr, samples: &Samples) -> Summary {
    let passes: Vec<usize> = samples.singular_passes().collect();
    let series = samples
        .series()
        .into_iter()
        .map(|series| {
            summarize_series(series.name, series.values, &passes, samples.samples_per_row)
        })
        .collect();
    let mut iterations = vec![0; samples.iterations.iter().max().map_or(0, |most| most + 1)];
    for &count in &samples.iterations {
        iterations[count] += 1;
    }
    let broken = (0..samples.len()).map(|i| {
        let rods = [0, 1, 2].map(|k| samples.rods[k][i]);
        gpr.limits()
            .broken(&rods, Tilt { azimuth: samples.azimuth[i], angle: samples.tilt_angle[i] })
    });
    let [x, y, _] = &samples.origin;
    Summary {
        samples: samples.len(),
        singular_passes: passes.len(),
        series,
        largest_center_shift: largest(x.iter().zip(y).map(|(x, y)| x.hypot(*y))),
        largest_torsion: largest(samples.torsion.iter().map(|torsion| torsion.abs())),
        largest_residual: largest(samples.residual.iter().copied()),
        iterations,
        beyond_tilt: broken.clone().filter(BrokenLimits::tilt).count(),
        beyond_stroke: broken.filter(|broken| broken.rods() != [false; 3]).count(),
    }
}

fn summarize_series(
    name: String,
    values: &[f64],
    passes: &[usize],
    per_row: usize,
) -> SeriesSummary {
    let (min, max) = extrema(values);
    let mut summary = SeriesSummary {
        name,
        min,
        max,
        pass_min: None,
        pass_max: None,
        minimum_at: 0,
        maximum_at: 0,
        constant_at: 0,
    };
    for &pass in passes {
        let value = values[pass];
        summary.pass_min = Some(summary.pass_min.map_or(value, |least| least.min(value)));
        summary.pass_max = Some(summary.pass_max.map_or(value, |most| most.max(value)));
        let row = pass / per_row * per_row;
        let (row_min, row_max) = extrema(&values[row..row + per_row]);
        if row_max - row_min <= 1e-2 * (max - min) {
            summary.constant_at += 1;
        } else if value <= row_min {
            summary.minimum_at += 1;
        } else if value >= row_max {
            summary.maximum_at += 1;
        }
    }
    summary
}

fn extrema(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), &v| (min.min(v), max.max(v)))
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}
