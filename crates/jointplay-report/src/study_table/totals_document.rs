//! Totals as a part of JSON documents, without loss of digits.

use jointplay_study::plan::{Moments, Outcomes, Totals};
use serde::{Deserialize, Serialize};

/// Totals of samples as JSON.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TotalsDocument {
    samples: u64,
    beyond_rods: u64,
    beyond_tilt: u64,
    beyond_joints: u64,
    outcomes: Vec<Vec<u64>>,
    /// Count, then least, greatest, mean and sum of squares as the bits of doubles.
    columns: Vec<(u64, [String; 4])>,
}

impl TotalsDocument {
    pub(crate) fn new(totals: &Totals) -> Self {
        let bits = |value: f64| format!("{:016x}", value.to_bits());
        Self {
            samples: totals.samples,
            beyond_rods: totals.beyond_rods,
            beyond_tilt: totals.beyond_tilt,
            beyond_joints: totals.beyond_joints,
            outcomes: totals.outcomes.iter().map(|tally| tally.counts.to_vec()).collect(),
            columns: totals
                .columns
                .iter()
                .map(|m| (m.count, [m.min, m.max, m.mean, m.squares].map(bits)))
                .collect(),
        }
    }

    /// The totals, or what is malformed.
    pub(crate) fn read(&self) -> Result<Totals, &'static str> {
        let columns = self.columns.iter().map(|(count, numbers)| {
            let number = |k: usize| {
                let bits = u64::from_str_radix(&numbers[k], 16);
                bits.map(f64::from_bits)
                    .map_err(|_| "a number of a column is not 16 hexadecimal digits")
            };
            Ok(Moments {
                count: *count,
                min: number(0)?,
                max: number(1)?,
                mean: number(2)?,
                squares: number(3)?,
            })
        });
        let outcomes = self.outcomes.iter().map(|counts| {
            let counts = counts.as_slice().try_into();
            Ok(Outcomes { counts: counts.map_err(|_| "an incorrect number of outcomes")? })
        });
        Ok(Totals {
            samples: self.samples,
            columns: columns.collect::<Result<_, &'static str>>()?,
            outcomes: outcomes.collect::<Result<_, &'static str>>()?,
            beyond_rods: self.beyond_rods,
            beyond_tilt: self.beyond_tilt,
            beyond_joints: self.beyond_joints,
        })
    }
}

/// Whether totals can be those of so many samples: no count exceeds the samples, and the outcomes under each model are as many.
///
/// # Arguments
/// * `of_study` – any totals of the study
pub(crate) fn are_totals_of(totals: &Totals, of_study: &Totals, samples: u64) -> bool {
    let Totals { beyond_rods, beyond_tilt, beyond_joints, .. } = *totals;
    let counts = totals.columns.iter().map(|column| column.count);
    let mut counts = counts.chain([beyond_rods, beyond_tilt, beyond_joints]);
    let sum = |tally: &Outcomes| {
        tally.counts.iter().try_fold(0_u64, |sum, &count| sum.checked_add(count))
    };
    totals.samples == samples
        && totals.columns.len() == of_study.columns.len()
        && totals.outcomes.len() == of_study.outcomes.len()
        && counts.all(|count| count <= samples)
        && totals.outcomes.iter().all(|tally| sum(tally) == Some(samples))
}
