//! Progress of a study in parts.

use std::collections::BTreeSet;

use jointplay_format::study::StudyFile;
use serde::Serialize;

use super::error::PartsError;

/// Progress of a study in parts.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StatusReport {
    /// Name of the study.
    pub study: String,
    /// Number of samples.
    pub samples: u64,
    /// Number of parts.
    pub parts: u64,
    /// How many are finished.
    pub done: u64,
    /// How many are missing.
    pub missing: u64,
    /// First and last number of each run of missing parts.
    pub missing_ranges: Vec<[u64; 2]>,
}

/// Reports what is finished of a study.
///
/// # Arguments
/// * `done` – numbers of finished parts; numbers beyond the last part are ignored
///
/// # Errors
/// [`PartsError::Study`].
pub fn status(study: &StudyFile, done: &BTreeSet<u64>) -> Result<StatusReport, PartsError> {
    let parts = study.plan.chunks()?;
    let (mut missing_ranges, mut next, mut finished) = (Vec::new(), 0, 0);
    for &part in done.range(..parts) {
        if next < part {
            missing_ranges.push([next, part - 1]);
        }
        next = part + 1;
        finished += 1;
    }
    if next < parts {
        missing_ranges.push([next, parts - 1]);
    }
    Ok(StatusReport {
        study: study.name.clone(),
        samples: study.plan.samples()?,
        parts,
        done: finished,
        missing: parts - finished,
        missing_ranges,
    })
}
