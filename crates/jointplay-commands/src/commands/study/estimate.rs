//! Expected size and duration of a study.

use std::time::Instant;

use jointplay::format::study::StudyFile;
use jointplay::report::study_table::Table;

use crate::failure::Failure;

/// Blocks computed to measure time and size.
const MEASURED_BLOCKS: u64 = 2;
/// Consecutive samples in each measured run.
const RUN_LENGTH: u64 = 64;
/// Typical size of one number in a table (bytes).
const NUMBER_SIZE: f64 = 15.0;

/// Expected size and duration of a study, measured on a few samples.
pub(super) struct Estimate {
    pub(super) samples: u64,
    /// Size of the table (bytes).
    pub(super) bytes: f64,
    /// Duration (s).
    pub(super) time: f64,
}

impl Estimate {
    /// Measures samples that are spread over the whole study, on the current thread pool.
    pub(super) fn measure(file: &StudyFile, table: &Table) -> Result<Self, Failure> {
        let samples = file.plan.samples()?;
        let measured = samples.min(MEASURED_BLOCKS * file.plan.portions().block as u64);
        // Consecutive samples share work, so runs of them are representative and single samples are not.
        let run = measured.min(RUN_LENGTH);
        let runs = measured.div_ceil(run);
        let chosen: Vec<u64> = (0..runs)
            .flat_map(|k| {
                let whole = u128::from(samples - run) * u128::from(k);
                let first = whole / u128::from((runs - 1).max(1));
                let first = u64::try_from(first).expect("at most the number of samples");
                first..first + run
            })
            .collect();
        let start = Instant::now();
        let block = file.plan.compute(&chosen)?;
        let encoded = table.encode(&[block])?;
        let time = start.elapsed().as_secs_f64();
        let bytes: usize = encoded.parts.iter().map(Vec::len).sum();
        let share = samples as f64 / chosen.len() as f64;
        let threads = rayon::current_num_threads() as f64;
        Ok(Self { samples, bytes: bytes as f64 * share, time: time * share / threads })
    }
}

/// Approximate size of the table of a study, without any measurement (bytes).
pub(super) fn rough_size(file: &StudyFile) -> Result<f64, Failure> {
    Ok(file.plan.samples()? as f64 * file.columns.len() as f64 * NUMBER_SIZE)
}
