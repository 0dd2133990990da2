//! The description of a folder of parts.

use jointplay_format::study::{StudyFile, from_files, parse};
use serde::{Deserialize, Serialize};

use super::digest::{VERSION, digest, other_version};
use super::error::PartsError;
use crate::instructions::instructions;
use crate::study_files::StudyFiles;
use crate::study_table::TableKind;

/// Name of the file that describes a folder of parts.
pub const MANIFEST: &str = "study.json";

/// Description of a folder of parts: the study and the format of the tables.
#[derive(Clone)]
pub struct Manifest {
    /// The study.
    pub study: StudyFile,
    /// Format of the tables.
    pub kind: TableKind,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    jointplay: String,
    /// Of the study.
    digest: String,
    samples: u64,
    parts: u64,
    rows_of_a_part: u64,
    format: String,
    /// Instruction set of the processor, where numbers depend on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    instructions: Option<String>,
    /// The file of the study (TOML).
    study: String,
    /// The files that it names.
    files: StudyFiles,
}

impl Manifest {
    /// The description as a JSON file.
    ///
    /// # Errors
    /// [`PartsError::Study`].
    pub fn to_json(&self) -> Result<String, PartsError> {
        let Self { study, kind } = self;
        let document = Document {
            jointplay: VERSION.to_owned(),
            digest: digest(study),
            samples: study.plan.samples()?,
            parts: study.plan.chunks()?,
            rows_of_a_part: study.plan.portions().chunk,
            format: kind.ending().to_owned(),
            instructions: instructions(study).map(str::to_owned),
            study: study.text.clone(),
            files: StudyFiles::new(&study.files),
        };
        let json = serde_json::to_string_pretty(&document);
        Ok(json.expect("a document of texts and whole numbers") + "\n")
    }

    /// Reads a file written by [`Self::to_json`].
    ///
    /// # Errors
    /// [`PartsError::Malformed`], [`PartsError::Version`], [`PartsError::Processor`].
    pub fn parse(text: &str) -> Result<Self, PartsError> {
        let malformed = |why: &str| PartsError::malformed(MANIFEST, why);
        let value: serde_json::Value =
            serde_json::from_str(text).map_err(|error| PartsError::json(MANIFEST, &error))?;
        if let Some(found) = other_version(&value) {
            return Err(PartsError::Version { found: found.to_owned(), here: VERSION });
        }
        let document: Document =
            serde_json::from_value(value).map_err(|error| PartsError::json(MANIFEST, &error))?;
        let kind = TableKind::of_ending(&document.format)
            .ok_or_else(|| malformed("its format is neither csv nor parquet"))?;
        let files = document.files.read().map_err(malformed)?;
        let study = parse(&document.study, &mut from_files(&files))
            .map_err(|error| malformed(&format!("the study in it is invalid: {error}")))?;
        if let (Some(found), Some(here)) = (&document.instructions, instructions(&study))
            && found != here
        {
            return Err(PartsError::Processor { found: found.clone(), here });
        }
        if digest(&study) != document.digest {
            return Err(malformed("its digest is not that of the study in it"));
        }
        Ok(Self { study, kind })
    }

    /// Checks that a study has the parts of this folder.
    ///
    /// # Errors
    /// [`PartsError::OtherStudy`].
    pub fn check(&self, study: &StudyFile) -> Result<(), PartsError> {
        if digest(&self.study) == digest(study) {
            return Ok(());
        }
        Err(PartsError::OtherStudy { differences: self.study.differences(study) })
    }
}
