//! Totals of a study of any length.

use jointplay_study::plan::{SampleLimit, Totals};
use serde::Serialize;
use serde_json::Map;

use jointplay_format::study::{Source, StudyFile};

/// Shares of the samples below the reported percentiles.
pub const SHARES: [f64; 7] = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99];

/// Totals of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TotalsReport {
    /// Name of the study.
    pub study: String,
    /// Name of the robot, mechanism or cell.
    pub mechanism: String,
    /// Number of samples.
    pub samples: u64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Outcomes of the samples: under each virtualization of a robot, of the positions of a mechanism, or of the program of a cell.
    pub outcomes: Vec<OutcomeReport>,
    /// Samples with a rod beyond the robot's limits; of studies of three-rod robots.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beyond_rod_limits: Option<u64>,
    /// Samples with a command beyond the tilt limit; of studies of three-rod robots.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beyond_tilt_limit: Option<u64>,
    /// Samples with a joint beyond its limits or clearance; of studies of mechanisms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beyond_joint_limits: Option<u64>,
    /// Number of samples behind the percentiles; exact if all.
    pub percentiles_from: u64,
    /// Columns with numbers.
    pub columns: Vec<ColumnReport>,
}

/// Outcomes of the samples under one virtualization, of the positions of a mechanism, or of the program of a cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutcomeReport {
    /// Name of the virtualization.
    pub name: String,
    /// Number of samples with an answer: a pose, or a program that passed its check.
    pub solved: u64,
    /// Number of samples without an answer.
    pub failed: u64,
    /// Reasons, with the number of samples of each.
    pub reasons: Map<String, serde_json::Value>,
}

/// Statistics of a column, in the unit of its name; `null` without numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnReport {
    /// Name of the column.
    pub name: String,
    /// Number of values.
    pub count: u64,
    /// Least.
    pub min: Option<f64>,
    /// Greatest.
    pub max: Option<f64>,
    /// Mean.
    pub mean: Option<f64>,
    /// Standard deviation, as a sample.
    pub standard_deviation: Option<f64>,
    /// Percentiles by name, such as `p95`.
    pub percentiles: Map<String, serde_json::Value>,
}

impl ColumnReport {
    /// A percentile, such as 95.
    #[must_use]
    pub fn percentile(&self, which: u8) -> Option<f64> {
        self.percentiles.get(&format!("p{which}"))?.as_f64()
    }
}

/// Reports the totals of a study.
///
/// # Arguments
/// * `quantiles` – of each column at [`SHARES`]
#[must_use]
pub fn totals(file: &StudyFile, totals: &Totals, quantiles: &[Vec<Option<f64>>]) -> TotalsReport {
    let outcomes = file.plan.solved_for().into_iter().zip(&totals.outcomes);
    let limits = file.plan.limits();
    let beyond = |limit: SampleLimit, count: u64| limits.contains(&limit).then_some(count);
    let columns = file.columns.iter().filter_map(|column| {
        let Source::Number { index, unit, typed, .. } = column.source else { return None };
        let moments = &totals.columns[index];
        let in_unit =
            |value: f64| if typed { unit.typed_from_si(value) } else { unit.from_si(value) };
        let if_any = |value: f64| (moments.count > 0).then(|| in_unit(value));
        let name = |share: f64| format!("p{}", (share * 100.0).round());
        let percentiles = SHARES.iter().zip(&quantiles[index]);
        Some(ColumnReport {
            name: column.name.clone(),
            count: moments.count,
            min: if_any(moments.min),
            max: if_any(moments.max),
            mean: if_any(moments.mean),
            standard_deviation: moments.deviation().map(|deviation| unit.from_si(deviation)),
            percentiles: percentiles
                .map(|(&share, value)| (name(share), value.map(in_unit).into()))
                .collect(),
        })
    });
    TotalsReport {
        study: file.name.clone(),
        mechanism: file.mechanism.clone(),
        samples: totals.samples,
        seed: file.plan.seed(),
        outcomes: outcomes
            .map(|(name, tally)| OutcomeReport {
                name,
                solved: tally.solved(),
                failed: tally.failed(),
                reasons: tally.reasons().map(|(why, n)| (why.to_owned(), n.into())).collect(),
            })
            .collect(),
        beyond_rod_limits: beyond(SampleLimit::Rods, totals.beyond_rods),
        beyond_tilt_limit: beyond(SampleLimit::Tilt, totals.beyond_tilt),
        beyond_joint_limits: beyond(SampleLimit::Joints, totals.beyond_joints),
        percentiles_from: totals.samples.min(file.plan.portions().quantiles),
        columns: columns.collect(),
    }
}
