//! Progress of an interrupted run, from which another run continues.

use std::collections::BTreeMap;

use jointplay_core::bulk::instruction_set;
use jointplay_study::plan::Totals;
use serde::{Deserialize, Serialize};

use jointplay_format::study::{StudyFile, from_files, parse};

use super::kind::TableKind;
use super::totals_document::{TotalsDocument, are_totals_of};
use crate::instructions::instructions;
use crate::study_files::{StudyFiles, from_hexadecimal, to_hexadecimal};

/// Progress file next to an incomplete table.
#[derive(Debug, Clone, PartialEq)]
pub struct Marker {
    /// The file of the study (TOML).
    pub study: String,
    /// The files that it names.
    pub files: BTreeMap<String, Vec<u8>>,
    /// Format of the table.
    pub kind: TableKind,
    /// Number of completed chunks.
    pub chunks: u64,
    /// Length of the table with these chunks, in bytes.
    pub bytes: u64,
    /// Totals of the columns of these chunks.
    pub totals: Totals,
    /// End of the table if it had only these chunks.
    pub foot: Vec<u8>,
    /// Instruction set of the processor, where numbers depend on it.
    pub instructions: Option<&'static str>,
}

/// Error of a marker from which this program cannot continue.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MarkerError {
    /// A text that no run writes.
    #[error("it is no marker of an interrupted study: {0}")]
    Malformed(String),
    /// A marker of another version, whose numbers may differ in their last digits.
    #[error(
        "jointplay {found} began this study, and only the same version can continue it; this is {here}"
    )]
    Version {
        /// Version that began the study.
        found: String,
        /// This version.
        here: &'static str,
    },
    /// A marker of a study whose last digits depend on the processor, begun on another kind.
    #[error(
        "this study was begun with the instruction set {found}, and this processor has {here}: its numbers may differ in their last digits; continue on the kind of processor that began it, or start again with --force"
    )]
    Processor {
        /// Instruction set that began the study.
        found: String,
        /// Instruction set of this processor.
        here: &'static str,
    },
}

const VERSION: &str = env!("CARGO_PKG_VERSION");

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    jointplay: String,
    format: String,
    chunks: u64,
    bytes: u64,
    seed: u64,
    totals: TotalsDocument,
    foot: String,
    study: String,
    files: StudyFiles,
    #[serde(skip_serializing_if = "Option::is_none")]
    instructions: Option<String>,
}

impl Marker {
    /// A marker without completed chunks.
    #[must_use]
    pub fn new(study: &StudyFile, kind: TableKind, totals: Totals) -> Self {
        Self {
            study: study.text.clone(),
            files: study.files.clone(),
            kind,
            chunks: 0,
            bytes: 0,
            totals,
            foot: Vec::new(),
            instructions: instructions(study),
        }
    }

    /// The marker as a JSON file.
    ///
    /// # Arguments
    /// * `seed` – written for readers of the file
    #[must_use]
    pub fn to_json(&self, seed: u64) -> String {
        let document = Document {
            jointplay: VERSION.to_owned(),
            format: self.kind.ending().to_owned(),
            chunks: self.chunks,
            bytes: self.bytes,
            seed,
            totals: TotalsDocument::new(&self.totals),
            foot: to_hexadecimal(&self.foot),
            study: self.study.clone(),
            files: StudyFiles::new(&self.files),
            instructions: self.instructions.map(str::to_owned),
        };
        let json = serde_json::to_string_pretty(&document);
        json.expect("a document of texts and whole numbers") + "\n"
    }

    /// Reads a file written by [`Self::to_json`].
    ///
    /// # Errors
    /// [`MarkerError`].
    pub fn parse(text: &str) -> Result<Self, MarkerError> {
        let malformed = |why: &str| MarkerError::Malformed(why.to_owned());
        let version: serde_json::Value = serde_json::from_str(text).map_err(|error| {
            malformed(&format!("no JSON at line {}, column {}", error.line(), error.column()))
        })?;
        if let Some(found) = version["jointplay"].as_str()
            && found != VERSION
        {
            return Err(MarkerError::Version { found: found.to_owned(), here: VERSION });
        }
        let document: Document = serde_json::from_value(version)
            .map_err(|_| malformed("a key is missing, or has a value of another kind"))?;
        let kind = TableKind::of_ending(&document.format)
            .ok_or_else(|| malformed("its format is neither csv nor parquet"))?;
        let totals = document.totals.read().map_err(malformed)?;
        let foot = from_hexadecimal(&document.foot)
            .ok_or_else(|| malformed("its foot is not hexadecimal"))?;
        let here = instruction_set();
        let instructions = match &document.instructions {
            Some(found) if found != here => {
                return Err(MarkerError::Processor { found: found.clone(), here });
            }
            found => found.as_ref().map(|_| here),
        };
        let Document { study, files, chunks, bytes, .. } = document;
        let files = files.read().map_err(malformed)?;
        Ok(Self { study, files, kind, chunks, bytes, totals, foot, instructions })
    }

    /// The study that was begun, of which the marker has a possible progress.
    ///
    /// # Errors
    /// [`MarkerError::Malformed`] for an invalid study, more chunks than it has, and totals that are not those of its chunks.
    pub fn study_file(&self) -> Result<StudyFile, MarkerError> {
        let malformed = |why: &str| MarkerError::Malformed(why.to_owned());
        let study = parse(&self.study, &mut from_files(&self.files))
            .map_err(|error| malformed(&format!("the study in it is invalid: {error}")))?;
        let plan = &study.plan;
        let invalid = |error| malformed(&format!("the study in it is invalid: {error}"));
        let (samples, chunks) = (plan.samples().map_err(invalid)?, plan.chunks().map_err(invalid)?);
        if self.chunks > chunks {
            return Err(malformed("it counts more chunks than the study has"));
        }
        // At most the samples: a last chunk may be shorter.
        let done = self.chunks.saturating_mul(plan.portions().chunk).min(samples);
        if !are_totals_of(&self.totals, &Totals::for_study(&**plan), done) {
            return Err(malformed("its totals are not those of its chunks"));
        }
        Ok(study)
    }
}
